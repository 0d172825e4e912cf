// SPDX-License-Identifier: BSD-3-Clause
// Units of unknowns and of time are a matter of choice: they bring entries to order one, and change no characteristic
// value.
#include "reduction/balanced_units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "matrix_checks.h"
#include "nonlinear_examples.h"
#include "problem/failure.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::Recording;
using sfdae_test::size;
using sfdae_test::Term;
using Vector = std::vector<double>;

// r_i and c_j that rows and unknowns are multiplied by, time unit: every other row, every third unknown.
struct Choice {
  double rows, unknowns, time;
  double row(int i) const { return i % 2 == 0 ? rows : 1.0; }
  double unknown(int j) const { return j % 3 == 1 ? unknowns : 1.0; }
  std::string name() const {
    return "rows " + std::to_string(std::log10(rows)) + ", unknowns " + std::to_string(std::log10(unknowns)) +
           ", time " + std::to_string(std::log10(time));
  }
};

std::vector<Choice> all_units() {
  std::vector<Choice> all = {{1.0, 1.0, 1.0}};
  for (double decades : {-9.0, -4.0, 3.0, 9.0}) {
    const double factor = std::pow(10.0, decades);
    all.push_back({factor, 1.0, 1.0});
    all.push_back({1.0, factor, 1.0});
    all.push_back({1.0, 1.0, factor});
    all.push_back({factor, 1.0 / factor, factor});
  }
  return all;
}

// A family with x_j = c_j z_j and t = T s: E -> R E C / T, A -> R A C, f -> R f, and T^k for derivatives.
class Rescaled {
 public:
  Rescaled(std::shared_ptr<const sfdae_test::LinearFamily> family, Choice units)
      : inner_(std::move(family)), units_(units) {
    problem = inner_.problem;
    problem.user = this;
    problem.E = [](double s, int k, double* E, void* self) {
      return static_cast<Rescaled*>(self)->matrix(s, k, E, true);
    };
    problem.A = [](double s, int k, double* A, void* self) {
      return static_cast<Rescaled*>(self)->matrix(s, k, A, false);
    };
    problem.f = [](double s, int k, double* f, void* user) {
      Rescaled& self = *static_cast<Rescaled*>(user);
      const int status = self.inner_.problem.f(s * self.units_.time, k, f, self.inner_.problem.user);
      for (int i = 0; i < self.inner_.m(); ++i) f[i] *= self.units_.row(i) * std::pow(self.units_.time, k);
      return status;
    };
  }
  sfdae_linear_problem problem;

 private:
  int matrix(double s, int k, double* M, bool is_E) {
    const auto function = is_E ? inner_.problem.E : inner_.problem.A;
    const int status = function(s * units_.time, k, M, inner_.problem.user);
    for (int j = 0; j < inner_.n(); ++j)
      for (int i = 0; i < inner_.m(); ++i)
        M[i + j * inner_.m()] *= units_.row(i) * units_.unknown(j) * std::pow(units_.time, is_E ? k - 1 : k);
    return status;
  }
  sfdae_test::FamilyProblem inner_;
  Choice units_;
};

// q' = v, v' = w, M w + K q = sin t, lambda = K q, with the differential equations in any units too.
struct FastStructure {
  static constexpr double K = 1e12;
  static int E(double, int k, double* E, void*) {
    std::fill_n(E, 16, 0.0);
    if (k == 0) E[0] = E[5] = 1.0;
    return 0;
  }
  static int A(double, int k, double* A, void*) {
    std::fill_n(A, 16, 0.0);
    if (k > 0) return 0;
    A[0 + 4 * 1] = A[1 + 4 * 2] = 1.0;
    A[2 + 4 * 2] = -1.0;
    A[2 + 4 * 0] = -K;
    A[3 + 4 * 0] = K;
    A[3 + 4 * 3] = -1.0;
    return 0;
  }
  static int f(double t, int k, double* f, void*) {
    std::fill_n(f, 4, 0.0);
    f[2] = std::sin(t + k * 1.57079632679489662);
    return 0;
  }
  sfdae_linear_problem problem{};
  FastStructure() {
    problem.size = sizeof problem;
    problem.num_equations = problem.num_unknowns = 4;
    problem.E = E;
    problem.A = A;
    problem.f = f;
  }
};

// "" for the characteristic values expected, else what was found or failed.
std::string analysis_of(CoefficientSource& source, double t, double toward,
                        const sfdae_test::CharacteristicValues& expected, int& status) {
  Arena arena;
  std::vector<RankDecision> decisions;
  status = SFDAE_OK;
  try {
    const CharacteristicValues found = analyze_index(source, t, toward, {}, arena, decisions).values;
    if (found.mu == expected.mu && found.d == expected.d && found.a == expected.a && found.u == expected.u &&
        found.v == expected.v)
      return "";
    return describe(found);
  } catch (const Failure& failure) {
    status = failure.status();
    return failure.what();
  }
}

}  // namespace

// In the unit 1e-6 of time v counts in 1e6 and w in 1e12 of the units of q, lambda as much as K q.
TEST(BalancedUnits, BringTheFastStructureToOrderOne) {
  FastStructure structure;
  LinearProblem problem(functions_of(structure.problem));
  const BalancedUnits balanced = balanced_units(data_in_units(problem, 0.0, {}), {});
  EXPECT_FALSE(balanced.has_suspects);
  const double tau = balanced.time;
  EXPECT_NEAR(std::log2(tau), -20.0, 1.0);  // 1 / sqrt(K)
  const Vector units = balanced.unknowns.values();
  ASSERT_EQ(units.size(), 4u);
  for (double unit : units) EXPECT_EQ(unit, std::ldexp(1.0, std::ilogb(unit)));
  problem.set_units(units);
  TaylorData data;
  ASSERT_EQ(problem.evaluate(0.0, {0, 0, -1}, tau, data, RowScaling::timed).status, SFDAE_OK);
  int entries = 0;
  for (ConstView matrix : {ConstView(data.E(0)), ConstView(data.A(0))})
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        if (matrix(i, j) == 0.0) continue;
        ++entries;
        EXPECT_GE(std::fabs(matrix(i, j)), 0.2) << i << ' ' << j;
        EXPECT_LE(std::fabs(matrix(i, j)), 2.0) << i << ' ' << j;
      }
  EXPECT_EQ(entries, 8);
  int status = SFDAE_OK;
  EXPECT_EQ(analysis_of(problem, 0.0, 1.0, {0, 2, 2, 0, 0}, status), "");
}

TEST(BalancedUnits, ReportTroubleWithTheEquations) {
  FastStructure structure;
  structure.problem.A = [](double, int, double*, void*) { return 1; };
  LinearProblem problem(functions_of(structure.problem));
  try {
    balanced_units(data_in_units(problem, 0.0, {}), {});
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_CALLBACK_FAILED);
  }
}

// A zero row, a zero column, and nothing differential at all: units stay finite and positive.
TEST(BalancedUnits, AreFiniteWhereNothingIsThereToBalance) {
  struct Matrices {
    Vector E, A;
  };
  for (Matrices matrices : {Matrices{{0, 0, 0, 0}, {0, 0, 0, 0}},
                            {{1, 0, 0, 0}, {0, 0, 0, 0}},
                            {{0, 0, 0, 0}, {1e-9, 0, 1e9, 1}},
                            {{1e-300, 0, 0, 0}, {1, 1, 1e300, 0}}}) {
    sfdae_linear_problem callbacks{};
    callbacks.size = sizeof callbacks;
    callbacks.num_equations = callbacks.num_unknowns = 2;
    callbacks.user = &matrices;
    callbacks.E = [](double, int k, double* E, void* user) {
      for (std::size_t i = 0; i < 4; ++i) E[i] = k == 0 ? static_cast<Matrices*>(user)->E[i] : 0.0;
      return 0;
    };
    callbacks.A = [](double, int k, double* A, void* user) {
      for (std::size_t i = 0; i < 4; ++i) A[i] = k == 0 ? static_cast<Matrices*>(user)->A[i] : 0.0;
      return 0;
    };
    callbacks.f = [](double, int, double* f, void*) { return f[0] = f[1] = 0.0, 0; };
    LinearProblem problem(functions_of(callbacks));
    try {
      const BalancedUnits balanced = balanced_units(data_in_units(problem, 0.0, {}), {});
      EXPECT_TRUE(std::isfinite(balanced.time) && balanced.time > 0.0);
      for (double unit : balanced.unknowns.values()) EXPECT_TRUE(std::isfinite(unit) && unit > 0.0);
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.status(), SFDAE_NOT_FINITE);
    }
  }
}

// Linear: the values of the family, or a named error where rounding of the rescaled data makes ranks unclear; never
// others.
TEST(Units, ChangeNoCharacteristicValuesOfLinearProblems) {
  int unclear = 0, all = 0;
  for (int mu = 0; mu <= 3; ++mu)
    for (const Choice& units : all_units()) {
      const std::shared_ptr<const sfdae_test::LinearFamily> family(sfdae_test::kron(8, mu));
      SCOPED_TRACE(family->name() + ": " + units.name());
      Rescaled rescaled(family, units);
      LinearProblem problem(functions_of(rescaled.problem));
      int status = SFDAE_OK;
      const std::string difference =
          analysis_of(problem, 0.3 / units.time, 1.0 / units.time, family->values(), status);
      ++all;
      if (status == SFDAE_RANK_UNCLEAR) ++unclear;
      else EXPECT_EQ(difference, "");
    }
  EXPECT_LE(unclear, all / 10);
}

// Stiffness 1e6 is a unit of time as well: right, or named.
TEST(Units, OfStiffProblemsAreFoundOrNamed) {
  for (double sigma : {1e4, 1e6, 1e8})
    for (int mu = 0; mu <= 2; ++mu)
      for (int seed = 0; seed < 3; ++seed) {
        const std::shared_ptr<const sfdae_test::LinearFamily> family(sfdae_test::kron(16, mu, 0.5, 0, seed, sigma));
        sfdae_test::FamilyProblem callbacks(family);
        LinearProblem problem(functions_of(callbacks.problem));
        int status = SFDAE_OK;
        const std::string difference = analysis_of(problem, 0.2, 1.0, family->values(), status);
        if (status == SFDAE_RANK_UNCLEAR) continue;
        EXPECT_EQ(difference, "") << sigma << ' ' << mu << ' ' << seed;
      }
}

// The pendulum in other units of its equations, unknowns and time: mu = 2, d = 2, a = 3. Accelerations range over 27
// decades where unknowns and time are in units of 1e9 at once; that is too much for jets to converge.
TEST(Units, ChangeNoCharacteristicValuesOfThePendulum) {
  const double c = std::cos(0.6), s = std::sin(0.6);
  const Vector consistent = {s, -c, 0.7 * c, 0.7 * s, 0.49 + sfdae_test::Pendulum::gravity * c};
  int unclear = 0;
  const std::vector<Choice> choices = all_units();
  for (const Choice& units : choices) {
    if (units.unknowns != 1.0 && std::fabs(std::log10(units.time)) > 5.0) continue;
    SCOPED_TRACE(units.name());
    Recording r(5);
    std::vector<Term> x, xdot, F(5);
    Vector guess;
    for (int j = 0; j < 5; ++j) {
      x.push_back(units.unknown(j) * r.x[size(j)]);
      xdot.push_back(units.unknown(j) / units.time * r.xdot[size(j)]);
      guess.push_back(consistent[size(j)] / units.unknown(j));
    }
    sfdae_test::pendulum_residual(units.time * r.t, x.data(), xdot.data(), F.data());
    for (int i = 0; i < 5; ++i) F[size(i)] = units.row(i) * F[size(i)];
    NonlinearExample example(r.finish(F));
    int status = SFDAE_OK;
    ConsistentJets jets(*example.problem, 0.0, guess.data(), {});
    const std::string difference = analysis_of(jets, 0.0, 1.0 / units.time, {2, 2, 3, 0, 0}, status);
    if (status == SFDAE_RANK_UNCLEAR) ++unclear;
    else EXPECT_EQ(difference, "");
  }
  EXPECT_LE(unclear, static_cast<int>(choices.size()) / 10);
}

}  // namespace sfdae::core
