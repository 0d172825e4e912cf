// SPDX-License-Identifier: BSD-3-Clause
// What integrators ask of a linear problem, against the equations that define the answers and exact solutions.
#include "linear/linear_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "analyzed_problem.h"
#include "matrix_checks.h"
#include "problem/failure.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::AnalyzedProblem;
using sfdae_test::Callback;
using sfdae_test::column;
using sfdae_test::distance;
using sfdae_test::FamilyProblem;
using sfdae_test::largest;
using sfdae_test::random_vector;
using sfdae_test::rounding;
using sfdae_test::size;
using sfdae_test::sum;
using sfdae_test::times;
using sfdae_test::transposed;
using Family = std::shared_ptr<const sfdae_test::LinearFamily>;
using Numbers = std::vector<double>;

struct Case {
  Family family;
  double t;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (sfdae_test::LinearTestProblem& p : sfdae_test::linear_testset()) {
    const double t = p.t0 + 0.3 * (p.tf - p.t0);
    all.push_back({std::move(p.family), t});
  }
  for (int mu = 0; mu <= 3; ++mu) all.push_back({Family(sfdae_test::kron(8, mu)), 0.4});
  all.push_back({Family(sfdae_test::kron(9, 2, 1.0, 2)), 0.4});
  all.push_back({Family(sfdae_test::chain(4, 1)), 0.4});
  all.push_back({Family(sfdae_test::spin(-5.0, 1.0)), 0.4});
  all.push_back({Family(sfdae_test::rotated_ode(sfdae_test::RowOperation::rotation, 3.0)), 0.4});
  return all;
}

constexpr LeadingTerm leading_terms[] = {LeadingTerm::projector, LeadingTerm::matrix, LeadingTerm::identity};

std::string trace(const Case& c, LeadingTerm leading) {
  return c.family->name() + ", leading term " + std::to_string(static_cast<int>(leading));
}

Matrix derivative_of_E(const AnalyzedProblem& p, double t, int k) {
  Matrix E(p.family().m(), p.family().n());
  p.family().E(t, k, E.data());
  return E;
}
Matrix A_at(const AnalyzedProblem& p, double t) {
  Matrix A(p.family().m(), p.family().n());
  p.family().A(t, 0, A.data());
  return A;
}
Matrix f_at(const AnalyzedProblem& p, double t) {
  Matrix f(p.family().m(), 1);
  p.family().f(t, 0, f.data());
  return f;
}

// D Z1, so that (D Z1)^T acts on the unscaled equations.
Matrix scaled_Z1(const LinearSystem& system) {
  Matrix Z1 = to_matrix(system.point().form.Z1());
  for (int j = 0; j < Z1.cols(); ++j)
    for (int i = 0; i < Z1.rows(); ++i) Z1(i, j) *= system.point().data.row_scale[size(i)];
  return Z1;
}

// Z1^T D [ E w' - C x - f ] in the user's units, with w' = E' part already multiplied by E where W = E.
Matrix F1(const AnalyzedProblem& p, double t, const Matrix& x, const Matrix& wdot) {
  const LinearSystem& system = p.system;
  const Matrix E = derivative_of_E(p, t, 0), E1 = derivative_of_E(p, t, 1);
  Matrix right = sum(1.0, times(A_at(p, t), x), 1.0, f_at(p, t));
  const bool is_matrix = system.leading_term() == LeadingTerm::matrix;
  if (is_matrix) right = sum(1.0, right, 1.0, times(E1, x));
  if (system.leading_term() == LeadingTerm::projector) {
    const ConstView K = system.point().form.kernel();
    right = sum(1.0, right, 1.0, times(E1, times(K, times(transposed(K), x))));
  }
  const Matrix left = is_matrix ? wdot : times(E, wdot);
  return times(transposed(scaled_Z1(system)), sum(1.0, left, -1.0, right));
}

// (I - T2 T2^T) v: what of v the constraints see.
Matrix seen_by_constraints(const LinearSystem& system, const Matrix& v) {
  const ConstView T2 = system.point().form.T2();
  return sum(1.0, v, -1.0, times(T2, times(transposed(T2), v)));
}

// U = T2 Uz
Matrix free_directions(const LinearSystem& system) {
  return times(system.point().form.T2(), system.point().form.Uz());
}

double tolerance(const LinearSystem& system) {
  const double scale = std::max({1.0, system.point().data.norm(12), system.point().data.norm_f(12)});
  return rounding(10 * system.unknowns()) * scale /
         (system.quality().smallest_pivot * system.quality().kept_constraints * system.quality().kept_differential *
          std::min(1.0, system.point().data.time_scale));
}

}  // namespace

TEST(LinearSystem, LeadingIsWTimesX) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(trace(c, leading));
      AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      const Numbers x = random_vector(p.problem.n(), 1);
      Numbers w(size(p.system.leading_size()));
      p.system.leading(x.data(), w.data());
      const Matrix E = derivative_of_E(p, c.t, 0);
      if (p.system.leading_term() == LeadingTerm::matrix) {
        EXPECT_LE(distance(column(w), times(E, column(x))), rounding(p.problem.n()) * std::max(1.0, largest(E)));
      } else if (p.system.leading_term() == LeadingTerm::projector) {
        // P = E^+ E: E P x = E x, and P x is orthogonal to the kernel.
        EXPECT_LE(distance(times(E, column(w)), times(E, column(x))), tolerance(p.system) * largest(E));
        EXPECT_LE(largest(times(transposed(p.system.point().form.kernel()), column(w))), tolerance(p.system));
      } else {
        EXPECT_EQ(w, x);
      }
    }
}

// F1(t, x, c W x + w_rest) = 0, F2(t, x) = 0, U^T (c x + x_rest) = 0.
TEST(LinearSystem, SolveFulfilsTheThreeSetsOfEquations) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms)
      for (double rate : {3.0, 1e4, -20.0}) {
        SCOPED_TRACE(trace(c, leading));
        AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
        ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
        const Numbers w_rest = random_vector(p.system.leading_size(), 2), x_rest = random_vector(p.problem.n(), 3);
        Matrix x(p.problem.n(), 1), w(p.system.leading_size(), 1);
        ASSERT_EQ(p.system.solve({rate, w_rest.data(), x_rest.data(), {}}, x.data()), PointStatus::ok);
        p.system.leading(x.data(), w.data());
        const double scale = tolerance(p.system) * std::max(1.0, largest(x)) * std::max(1.0, std::fabs(rate));
        EXPECT_LE(largest(F1(p, c.t, x, sum(rate, w, 1.0, column(w_rest)))), scale);
        const Numbers xp(p.system.point().form.xp(), p.system.point().form.xp() + p.problem.n());
        EXPECT_LE(largest(seen_by_constraints(p.system, sum(1.0, x, -1.0, column(xp)))), scale);
        EXPECT_LE(largest(times(transposed(free_directions(p.system)), sum(rate, x, 1.0, column(x_rest)))), scale);
      }
}

// Implicit Euler with w' exact: c W x + w_rest = (W x)' for the exact x leaves x as the only solution.
TEST(LinearSystem, SolveReproducesTheExactSolution) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(trace(c, leading));
      AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      const Numbers exact = p.exact(c.t), xdot = p.exact_derivative(c.t);
      Numbers w(size(p.system.leading_size())), wdot(w), x_rest(exact);
      p.system.leading(exact.data(), w.data());
      p.system.leading_derivative(exact.data(), xdot.data(), wdot.data());
      const double rate = 50.0;
      for (std::size_t i = 0; i < w.size(); ++i) w[i] = wdot[i] - rate * w[i];
      for (double& value : x_rest) value *= -rate;
      Numbers x(exact.size());
      ASSERT_EQ(p.system.solve({rate, w.data(), x_rest.data(), {}}, x.data()), PointStatus::ok);
      EXPECT_LE(distance(x, exact), 100.0 * tolerance(p.system) * std::max(1.0, largest(exact) + largest(xdot)));
    }
}

// dx = T2 G^+ Z1^T E dw: the constraints see nothing, Z1^T E dx = Z1^T E dw, free directions do not move.
TEST(LinearSystem, ErrorInXIsTheChangeThatBelongsToW) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(trace(c, leading));
      AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      const Matrix dw = column(random_vector(p.system.leading_size(), 4));
      Matrix dx(p.problem.n(), 1);
      p.system.error_in_x(dw.data(), dx.data());
      const double scale = tolerance(p.system) * std::max(1.0, largest(dx));
      EXPECT_LE(largest(seen_by_constraints(p.system, dx)), scale);
      const Matrix E = derivative_of_E(p, c.t, 0), Z1t = transposed(scaled_Z1(p.system));
      const Matrix wanted = p.system.leading_term() == LeadingTerm::matrix ? to_matrix(dw) : times(E, dw);
      EXPECT_LE(distance(times(Z1t, times(E, dx)), times(Z1t, wanted)), scale * std::max(1.0, largest(Z1t)));
      EXPECT_LE(largest(times(transposed(free_directions(p.system)), dx)), scale);
    }
}

TEST(LinearSystem, RestoreFindsXFromItsWAndItsFreePart) {
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(trace(c, leading));
      AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      const Numbers exact = p.exact(c.t);
      Numbers w(size(p.system.leading_size())), x(exact.size());
      p.system.leading(exact.data(), w.data());
      p.system.restore(w.data(), exact.data(), x.data());
      EXPECT_LE(distance(x, exact), tolerance(p.system) * std::max(1.0, largest(exact)));
    }
}

TEST(LinearSystem, CorrectedDerivativesFulfilTheDifferentialEquations) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    AnalyzedProblem p(c.family, c.t, c.t + 1.0, LeadingTerm::identity);
    ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
    const Numbers x = p.exact(c.t), before = random_vector(p.problem.n(), 6);
    Numbers xdot = before;
    p.system.correct_derivative(std::numeric_limits<double>::infinity(), x.data(), xdot.data());
    const double scale = tolerance(p.system) * std::max({1.0, largest(x), largest(xdot)});
    EXPECT_LE(largest(F1(p, c.t, column(x), column(xdot))), scale);
    const Matrix change = sum(1.0, column(xdot), -1.0, column(before));
    EXPECT_LE(largest(seen_by_constraints(p.system, change)), scale);
    EXPECT_LE(largest(times(transposed(free_directions(p.system)), change)), scale);
  }
}

// ---- Derivatives ----

// u = 0: x' is that of the exact solution. u > 0: x' without free part, which the constraints see as that of the
// exact one and which fulfils the differential equations.
void expect_derivative(const AnalyzedProblem& p, double t, const Numbers& xdot, double error) {
  const Numbers exact = p.exact_derivative(t);
  if (p.family().values().u == 0) {
    EXPECT_LE(distance(xdot, exact), error);
    return;
  }
  const Matrix difference = sum(1.0, column(xdot), -1.0, column(exact));
  EXPECT_LE(largest(seen_by_constraints(p.system, difference)), error);
  EXPECT_LE(largest(times(transposed(free_directions(p.system)), column(xdot))), error);
  EXPECT_LE(largest(times(transposed(scaled_Z1(p.system)), times(derivative_of_E(p, t, 0), difference))), error);
}

TEST(LinearSystem, ConsistentDerivativeComesFromTheArrayOfTheNextLevel) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.family->name());
    AnalysisSettings settings;
    settings.max_index = c.family->values().mu + 1;
    AnalyzedProblem p(c.family, c.t, c.t + 1.0, LeadingTerm::automatic, settings);
    ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
    const Numbers x = p.exact(c.t);
    Numbers xdot(x.size(), 777.0);
    const double error = tolerance(p.system) * std::max({1.0, largest(x), largest(p.exact_derivative(c.t))});
    EXPECT_TRUE(p.system.consistent_derivative(x.data(), 1.0, xdot.data()));
    expect_derivative(p, c.t, xdot, 100.0 * error / p.system.quality().smallest_pivot);
    EXPECT_EQ(p.system.t(), c.t);
  }
}

// max_index = mu: the array of level mu + 1 is out of reach. Differences of order 4 on points of distance
// h = 2e-3 min(1, tau): error below h^4 times the fifth derivative (speeds up to 3: 3^5) and rounding over h.
TEST(LinearSystem, ConsistentDerivativeByDifferencesWhereTheArrayMayNotBeUsed) {
  for (const Case& c : cases()) {
    if (c.family->constant_E() && c.family->constant_A()) continue;  // the array costs no further callbacks there
    SCOPED_TRACE(c.family->name());
    AnalysisSettings settings;
    settings.max_index = c.family->values().mu;
    for (double direction : {1.0, -1.0}) {
      AnalyzedProblem p(c.family, c.t, c.t + direction, LeadingTerm::automatic, settings);
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      if (direction > 0.0) p.problem.set_limits(c.t, c.t + 1.0);
      else p.problem.set_limits(c.t - 1.0, c.t);
      const Numbers x = p.exact(c.t);
      Numbers xdot(x.size(), 777.0);
      const double h = 2e-3 * std::min(1.0, p.system.point().data.time_scale);
      const double scale = std::max({1.0, largest(x), largest(p.exact_derivative(c.t))});
      const double error = scale * (std::pow(2e-3, 4) * 243.0 * 100.0 + tolerance(p.system) / h);
      EXPECT_FALSE(p.system.consistent_derivative(x.data(), direction, xdot.data()));
      EXPECT_EQ(p.system.t(), c.t);
      expect_derivative(p, c.t, xdot, error);
    }
  }
}

// (W x)' against central differences of order 4 of W(t) x(t) along the exact solution.
TEST(LinearSystem, LeadingDerivativeIsTheDerivativeOfW) {
  const double h = 1e-3;
  for (const Case& c : cases())
    for (LeadingTerm leading : leading_terms) {
      SCOPED_TRACE(trace(c, leading));
      AnalyzedProblem p(c.family, c.t, c.t + 1.0, leading);
      const std::size_t length = size(p.system.leading_size());
      Numbers difference(length, 0.0), w(length), wdot(length);
      const double weights[] = {1.0, -8.0, 0.0, 8.0, -1.0};
      for (int k = -2; k <= 2; ++k) {
        const double t = c.t + k * h;
        ASSERT_EQ(p.system.move_to(t), PointStatus::ok);
        p.system.leading(p.exact(t).data(), w.data());
        for (std::size_t i = 0; i < length; ++i) difference[i] += weights[k + 2] / (12.0 * h) * w[i];
      }
      ASSERT_EQ(p.system.move_to(c.t), PointStatus::ok);
      const Numbers x = p.exact(c.t), xdot = p.exact_derivative(c.t);
      p.system.leading_derivative(x.data(), xdot.data(), wdot.data());
      const double scale =
          std::max({1.0, largest(x), largest(xdot)}) * std::max(1.0, largest(derivative_of_E(p, c.t, 0)));
      // h^4 / 30 times fifth derivatives, speeds up to 5 in products of several factors, and rounding over h.
      EXPECT_LE(distance(wdot, difference), scale * (std::pow(h, 4) * 1e5 + tolerance(p.system) / h));
    }
}

// ---- Leading terms ----

TEST(LinearSystem, LeadingTermIsTheProjectorWhereTheRankOfEIsConstantElseE) {
  EXPECT_EQ(AnalyzedProblem(Family(sfdae_test::kron(6, 1)), 0.2, 1.0).system.leading_term(), LeadingTerm::projector);
  // E = [0 t; 0 0] at t = 0
  for (LeadingTerm asked : {LeadingTerm::automatic, LeadingTerm::projector})
    EXPECT_EQ(AnalyzedProblem(Family(sfdae_test::rankdrop_t().family), 0.0, 1.0, asked).system.leading_term(),
              LeadingTerm::matrix);
  AnalyzedProblem given_up(Family(sfdae_test::rankdrop_t().family), 0.5, 1.0);
  EXPECT_EQ(given_up.system.leading_term(), LeadingTerm::projector);
  given_up.system.give_up_projector();
  EXPECT_EQ(given_up.system.leading_term(), LeadingTerm::matrix);
  EXPECT_EQ(given_up.system.leading_size(), 2);
}

// mu = 0 and no E': W = I. An E of full rank needs none in the first place.
TEST(LinearSystem, WithoutTheDerivativeOfETheLeadingTermIsTheIdentity) {
  const auto order_zero = [](FamilyProblem& callbacks) { callbacks.hooks.highest_order = 0; };
  for (LeadingTerm asked : {LeadingTerm::automatic, LeadingTerm::projector, LeadingTerm::matrix})
    EXPECT_EQ(AnalyzedProblem(Family(sfdae_test::kron(6, 0)), 0.2, 1.0, asked, {}, order_zero).system.leading_term(),
              LeadingTerm::identity);
  AnalyzedProblem ode(Family(sfdae_test::rotated_ode(sfdae_test::RowOperation::rotation, 2.0)), 0.2, 1.0,
                      LeadingTerm::projector, {}, order_zero);
  EXPECT_EQ(ode.system.leading_term(), LeadingTerm::projector);
  EXPECT_EQ(ode.system.move_to(0.3), PointStatus::ok);
}

// ---- Points ----

TEST(LinearSystem, ConstantProblemsAreReducedOnceAndFactoredOnceForEveryStep) {
  AnalyzedProblem p(Family(sfdae_test::kron(8, 2, 0.0)), 0.2, 1.0, LeadingTerm::automatic, {},
                    [](FamilyProblem& callbacks) { callbacks.declare_constants(); });
  const Numbers zero(8, 0.0);
  Numbers x(8);
  for (double t : {0.2, 0.3, 0.7, 0.5}) {
    ASSERT_EQ(p.system.move_to(t), PointStatus::ok);
    EXPECT_EQ(p.system.t(), t);
    ASSERT_EQ(p.system.solve({10.0, zero.data(), zero.data(), {}}, x.data()), PointStatus::ok);
    const Numbers exact = p.exact(t);
    Numbers w(8), restored(8);
    p.system.leading(exact.data(), w.data());
    p.system.restore(w.data(), exact.data(), restored.data());
    EXPECT_LE(distance(restored, exact), tolerance(p.system)) << t;
    p.system.accept();
  }
  EXPECT_EQ(p.system.counts().reductions, 1);
  EXPECT_EQ(p.system.counts().factorizations, 1);
  EXPECT_EQ(p.callbacks.calls(Callback::E), 1);
  ASSERT_EQ(p.system.solve({20.0, zero.data(), zero.data(), {}}, x.data()), PointStatus::ok);
  EXPECT_EQ(p.system.counts().factorizations, 2);
  const Matrix w = times(
      sum(1.0, identity(8), -1.0, times(p.system.point().form.kernel(), transposed(p.system.point().form.kernel()))),
      column(x));
  EXPECT_LE(largest(F1(p, 0.5, column(x), sum(20.0, w, 0.0, w))),
            20.0 * tolerance(p.system) * std::max(1.0, largest(x)));
}

TEST(LinearSystem, TellsFailingCallbacksFromChangedValuesAndFromAChangedRankOfE) {
  AnalyzedProblem failing(Family(sfdae_test::kron(6, 1)), 0.2, 1.0);
  failing.callbacks.hooks.status = sfdae_test::return_behind(0.5, 3);
  EXPECT_EQ(failing.system.move_to(0.4), PointStatus::ok);
  EXPECT_EQ(failing.system.move_to(0.6), PointStatus::callback_error);
  EXPECT_EQ(failing.system.callback_error().status, SFDAE_CALLBACK_FAILED);
  EXPECT_EQ(failing.system.move_to(0.45), PointStatus::ok);

  AnalyzedProblem changing(Family(sfdae_test::changing_structure(0.4).family), 0.2, 0.3);
  EXPECT_EQ(changing.system.move_to(0.39), PointStatus::ok);
  EXPECT_EQ(changing.system.move_to(0.41), PointStatus::changed);

  AnalyzedProblem rank_drop(Family(sfdae_test::rankdrop_t().family), -0.5, 1.0, LeadingTerm::projector);
  EXPECT_EQ(rank_drop.system.move_to(-0.1), PointStatus::ok);
  EXPECT_EQ(rank_drop.system.move_to(0.0), PointStatus::leading_changed);
  rank_drop.system.give_up_projector();
  EXPECT_EQ(rank_drop.system.move_to(0.0), PointStatus::ok);
}

// E = diag(1, t - 1/2): det [E1; A2] changes its sign at t = 1/2.
TEST(LinearSystem, OrientationTurnsWhereASingularPointLiesBetween) {
  AnalyzedProblem p(Family(sfdae_test::vanishing_E().family), 0.2, 0.4);
  ASSERT_EQ(p.system.move_to(0.4), PointStatus::ok);
  p.system.accept();
  ASSERT_EQ(p.system.move_to(0.45), PointStatus::ok);
  EXPECT_TRUE(p.system.orientation_kept());
  ASSERT_EQ(p.system.move_to(0.6), PointStatus::ok);
  EXPECT_FALSE(p.system.orientation_kept());
  ASSERT_EQ(p.system.move_to(0.49), PointStatus::ok);  // still measured from the point accepted
  EXPECT_TRUE(p.system.orientation_kept());
  ASSERT_EQ(p.system.move_to(0.6), PointStatus::ok);
  p.system.accept();
  ASSERT_EQ(p.system.move_to(0.7), PointStatus::ok);
  EXPECT_TRUE(p.system.orientation_kept());
}

// Bases jump, pivots change: the sign does not, as long as they turn by less than a right angle.
TEST(LinearSystem, OrientationIsKeptAlongRegularProblems) {
  for (const Family& family : {Family(sfdae_test::kron(8, 1, 1.0)), Family(sfdae_test::kron(7, 0, 1.0)),
                               Family(sfdae_test::chain(4, 2)), Family(sfdae_test::spin(-5.0, 1.0)),
                               Family(sfdae_test::rotated_ode(sfdae_test::RowOperation::rotation, 5.0))}) {
    AnalyzedProblem p(family, 0.0, 3.0);
    for (int k = 0; k <= 60; ++k) {
      ASSERT_EQ(p.system.move_to(0.05 * k), PointStatus::ok);
      EXPECT_TRUE(k == 0 || p.system.orientation_kept()) << family->name() << ", t = " << 0.05 * k;
      p.system.accept();
    }
  }
}

// ---- Prescribed components ----

TEST(LinearSystem, RefusesMorePrescribedComponentsThanAreFree) {
  static const int components[] = {0, 1};
  const auto prescribe = [](FamilyProblem& callbacks) {
    callbacks.problem.num_prescribed = 2;
    callbacks.problem.prescribed = components;
    callbacks.problem.prescribed_values = [](double, int, double*, void*) { return 0; };
  };
  try {
    AnalyzedProblem p(Family(sfdae_test::lin_underdet().family), 0.2, 1.0, LeadingTerm::automatic, {}, prescribe);
    FAIL() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_PRESCRIPTION_SINGULAR);
  }
}

// lin_underdet: x1' = x2 + x3, 0 = x1 - sin t, u = 1; x3 = t prescribed gives x2 = cos t - t.
TEST(LinearSystem, PrescribedComponentsMakeTheSolutionUnique) {
  static const int component = 2;
  const auto prescribe = [](FamilyProblem& callbacks) {
    callbacks.problem.num_prescribed = 1;
    callbacks.problem.prescribed = &component;
    callbacks.problem.prescribed_values = [](double t, int, double* values, void*) {
      values[0] = t;
      return 0;
    };
  };
  AnalyzedProblem p(Family(sfdae_test::lin_underdet().family), 0.2, 1.0, LeadingTerm::automatic, {}, prescribe);
  EXPECT_EQ(p.system.undetermined(), 0);
  for (double t : {0.2, 0.7}) {
    ASSERT_EQ(p.system.move_to(t), PointStatus::ok);
    const Numbers zero(3, 0.0);
    Numbers x(3);
    ASSERT_EQ(p.system.solve({1.0, zero.data(), zero.data(), {}}, x.data()), PointStatus::ok);
    EXPECT_LE(distance(x, {std::sin(t), std::cos(t) - t, t}), rounding(3));
    Numbers xdot(3);
    p.system.consistent_derivative(x.data(), 1.0, xdot.data());
    EXPECT_LE(distance(xdot, {std::cos(t), -std::sin(t) - 1.0, 1.0}), std::pow(2e-3, 4) + rounding(3) / 2e-3);
  }
}

// Where errors grow from stage to stage the ranks are those of the analysis all along.
TEST(LinearSystem, FollowsSlowProblemsOfHighIndex) {
  for (int seed : {55, 84, 95, 496}) {
    const std::shared_ptr<const sfdae_test::LinearFamily> family = sfdae_test::kron(5, 3, 0.0025, 0, seed);
    sfdae_test::AnalyzedProblem p(family, 0.0, 10.0);
    EXPECT_EQ(p.system.analysis().values.mu, 3);
    for (double t = 0.25; t < 10.0; t += 0.25) ASSERT_EQ(p.system.move_to(t), PointStatus::ok) << seed << ' ' << t;
  }
}

}  // namespace sfdae::core
