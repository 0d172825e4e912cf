// SPDX-License-Identifier: BSD-3-Clause
// The test problems themselves: solutions solve, derivatives are derivatives, callbacks deliver.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "family_problem.h"
#include "linear_family.h"
#include "random_family.h"
#include "testset_linear.h"
#include "transformed_pencil.h"

namespace sfdae_test {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

std::size_t as_size(int i) { return static_cast<std::size_t>(i); }

double largest_entry(const std::vector<double>& x) {
  double largest = 0.0;
  for (double value : x) largest = std::max(largest, std::isnan(value) ? INFINITY : std::abs(value));
  return largest;
}

// Families of every kind, with t0, tf; x0 stays empty where it is not of interest.
std::vector<LinearTestProblem> every_kind() {
  std::vector<LinearTestProblem> all = linear_testset();
  const auto add = [&](std::unique_ptr<LinearFamily> family) { all.push_back({std::move(family), 0.0, 1.0, {}}); };
  for (int mu = 0; mu <= 4; ++mu) add(kron(9, mu));
  add(kron(12, 2, 1.0, 2, 3, 10.0, 1e4));
  add(kron(8, 1, 0.0));
  add(chain(6, 2));
  add(chain(7, 3, 2.0, 100.0));
  add(spin(-50.0, 1.0));
  add(spin(3.0, -1.0));
  for (RowOperation rows : {RowOperation::none, RowOperation::scaling, RowOperation::rotation})
    add(rotated_ode(rows));
  for (std::uint64_t seed = 1; seed <= 40; ++seed) add(random_family(seed));
  return all;
}

std::vector<double> inner_points(const LinearTestProblem& p) {
  std::vector<double> t;
  for (double part : {0.04, 0.37, 0.83}) t.push_back(p.t0 + part * (p.tf - p.t0));
  return t;
}

std::vector<double> matrix(const LinearFamily& p, void (LinearFamily::*which)(double, int, double*) const, double t,
                           int k, int columns) {
  std::vector<double> values(as_size(p.m() * columns), NAN);
  (p.*which)(t, k, values.data());
  return values;
}

// Rounding errors of a sum of n products whose factors carry a few roundings each: 2n rotations and Taylor sums.
double rounding(int n) { return 100.0 * n * eps; }

}  // namespace

// Series around 0 that are known from textbooks.
TEST(Jet, FunctionsHaveTheirTaylorSeries) {
  const Jet t = Jet::variable(0.0, 9);
  const Jet gauss = exp(t * t), s = sin(t * t), c = cos(t * t), geometric = 1 / (1 - t);
  const Jet slope = derivative(geometric);
  for (int k = 0; k <= 9; ++k) {
    EXPECT_DOUBLE_EQ(gauss[k], k % 2 == 0 ? 1 / factorial(k / 2) : 0.0);
    EXPECT_DOUBLE_EQ(s[k], k % 4 == 2 ? (k == 2 ? 1.0 : -1.0 / 6.0) : 0.0);
    EXPECT_DOUBLE_EQ(c[k], k % 4 == 0 ? (k == 4 ? -0.5 : 1.0 / (k == 0 ? 1.0 : 24.0)) : 0.0);
    EXPECT_DOUBLE_EQ(geometric[k], 1.0);
    EXPECT_DOUBLE_EQ(slope[k], k < 9 ? k + 1.0 : 0.0);
  }
}

TEST(Jet, SineAndCosineOfALinearArgumentAgreeWithTheGeneralRule) {
  const SineCosine direct = sine_cosine(0.3, -1.7, 0.4, 9);
  const SineCosine general = sine_cosine(0.3 - 1.7 * Jet::variable(0.4, 9));
  for (int k = 0; k <= 9; ++k) {
    EXPECT_NEAR(direct.sine[k], general.sine[k], rounding(1));
    EXPECT_NEAR(direct.cosine[k], general.cosine[k], rounding(1));
  }
}

TEST(Families, ExactSolutionsSatisfyTheEquations) {
  for (const LinearTestProblem& p : every_kind()) {
    const LinearFamily& family = *p.family;
    SCOPED_TRACE(family.name());
    ASSERT_TRUE(family.has_exact());
    const int m = family.m(), n = family.n();
    for (double t : inner_points(p)) {
      const auto E = matrix(family, &LinearFamily::E, t, 0, n), A = matrix(family, &LinearFamily::A, t, 0, n);
      const auto f = matrix(family, &LinearFamily::f, t, 0, 1);
      std::vector<double> x(as_size(n)), xdot(as_size(n));
      family.exact(t, x.data(), xdot.data());
      for (int i = 0; i < m; ++i) {
        double residual = -f[as_size(i)], terms = std::abs(f[as_size(i)]);
        for (int j = 0; j < n; ++j) {
          const double Ex = E[as_size(i + j * m)] * xdot[as_size(j)], Ax = A[as_size(i + j * m)] * x[as_size(j)];
          residual += Ex - Ax;
          terms += std::abs(Ex) + std::abs(Ax);
        }
        // Cancelled terms: at least a row of E or A times the solution.
        double row = 0.0;
        for (int j = 0; j < n; ++j)
          row = std::max({row, std::abs(E[as_size(i + j * m)]), std::abs(A[as_size(i + j * m)])});
        EXPECT_LE(std::abs(residual), rounding(n) * (terms + row * largest_entry(x))) << "t = " << t << ", row " << i;
      }
    }
  }
}

TEST(Families, XdotIsTheDerivativeOfX) {
  for (const LinearTestProblem& p : every_kind()) {
    SCOPED_TRACE(p.family->name());
    const std::size_t n = as_size(p.family->n());
    for (double t : inner_points(p)) {
      const double h = 1e-4;
      std::vector<double> x_left(n), x_right(n), left(n), right(n), middle(n), x(n);
      p.family->exact(t - h, x_left.data(), left.data());
      p.family->exact(t + h, x_right.data(), right.data());
      p.family->exact(t, x.data(), middle.data());
      // Simpson's rule x(t+h) - x(t-h) = h/3 (x'(t-h) + 4 x'(t) + x'(t+h)) errs by h^5 x^(5)/90; x^(5) is at most
      // 100^4 times as large as x' here (spin(-50, 1): 51^4).
      for (std::size_t j = 0; j < n; ++j) {
        const double slope = std::abs(left[j]) + std::abs(middle[j]) + std::abs(right[j]) + largest_entry(middle);
        EXPECT_NEAR(x_right[j] - x_left[j], h / 3.0 * (left[j] + 4.0 * middle[j] + right[j]),
                    std::pow(h, 5) / 90.0 * 1e8 * slope + rounding(static_cast<int>(n)) * largest_entry(x))
            << "t = " << t << ", component " << j;
      }
    }
  }
}

// The central difference (D(t-2h) - 8 D(t-h) + 8 D(t+h) - D(t+2h)) / 12h errs by h^4 D^(5) / 30.
TEST(Families, DerivativesAreThoseOfTheOrderBelow) {
  using Member = void (LinearFamily::*)(double, int, double*) const;
  const Member members[] = {&LinearFamily::E, &LinearFamily::A, &LinearFamily::f};
  for (const LinearTestProblem& p : every_kind()) {
    const LinearFamily& family = *p.family;
    SCOPED_TRACE(family.name());
    const double t = inner_points(p)[1], h = 1e-3;
    for (std::size_t which = 0; which < 3; ++which) {
      const Member D = members[which];
      const int columns = which == 2 ? 1 : family.n();
      for (int k = 1; k <= 8; ++k) {
        const auto supplied = matrix(family, D, t, k, columns);
        const auto far_left = matrix(family, D, t - 2 * h, k - 1, columns);
        const auto left = matrix(family, D, t - h, k - 1, columns);
        const auto right = matrix(family, D, t + h, k - 1, columns);
        const auto far_right = matrix(family, D, t + 2 * h, k - 1, columns);
        double error = 0.0;
        for (std::size_t i = 0; i < supplied.size(); ++i) {
          const double difference = (far_left[i] - 8 * left[i] + 8 * right[i] - far_right[i]) / (12 * h);
          error = std::max(error, std::abs(supplied[i] - difference));
        }
        const double truncation = std::pow(h, 4) / 30 * largest_entry(matrix(family, D, t, k + 4, columns));
        const double noise = rounding(family.n()) * (largest_entry(left) + largest_entry(right)) / h;
        EXPECT_LE(error, 2 * truncation + noise) << "EAf"[which] << ", order " << k;
        EXPECT_LT(truncation, 1e-3 * (largest_entry(supplied) + largest_entry(left) + 1))
            << "no test at all: smaller h";
      }
    }
  }
}

// Reference values of the test set (from exact formulas), x = (x1, x2, v1, v2, F). v1 and F contain the third and
// fourth derivatives of the path; their terms alternate in sign and reach 1e5 and 2e6 at t = 2.3, those of x2 1e3.
TEST(Families, CraneAgreesWithReferenceValues) {
  const LinearTestProblem p = crane_mass_spring();
  std::array<double, 5> x;
  p.family->exact(2.3, x.data(), nullptr);
  EXPECT_NEAR(x[1], 2.241063547437501269531, rounding(1) * 1e3);
  EXPECT_NEAR(x[2], 1.424018197675315429687, rounding(1) * 1e5);
  EXPECT_NEAR(x[4], 300.0573199244323828125, rounding(1) * 2e6);
}

TEST(SmoothTransformation, RotationsAreOrthogonalInAllTaylorCoefficients) {
  const auto family = random_family(7, {.max_size = 12, .w = 1.0, .scalings = false});
  const auto& pencil = dynamic_cast<const TransformedPencil&>(*family);
  const int n = pencil.n(), order = 8;
  JetColumns Q(n, n, order);
  for (int i = 0; i < n; ++i) Q.at(i, 0)[i] = 1.0;
  multiply(Q, pencil.Q(), Factor::direct, 0.3);
  for (int k = 0; k <= order; ++k)  // coefficient k of Q^T Q
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double sum = 0.0, terms = 0.0;
        for (int l = 0; l <= k; ++l)
          for (int r = 0; r < n; ++r) {
            sum += Q.at(i, l)[r] * Q.at(j, k - l)[r];
            terms += std::abs(Q.at(i, l)[r] * Q.at(j, k - l)[r]);
          }
        EXPECT_NEAR(sum, i == j && k == 0 ? 1.0 : 0.0, rounding(n) * (1.0 + terms));
      }
}

TEST(SmoothTransformation, InverseTransposedTimesTransposedIsTheIdentity) {
  const auto family = random_family(11, {.max_size = 9, .w = 1.0});
  const auto& pencil = dynamic_cast<const TransformedPencil&>(*family);
  const int n = pencil.n(), order = 6;
  JetColumns W(n, n, order);
  for (int i = 0; i < n; ++i) W.at(i, 0)[i] = 1.0;
  multiply(W, pencil.Q(), Factor::inverse_transposed, 0.3);
  multiply(W, pencil.Q(), Factor::transposed, 0.3);
  for (int k = 0; k <= order; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        // The coefficients of both grow like (sum of speeds)^k / k! <= (2 n)^k / k!.
        EXPECT_NEAR(W.at(j, k)[i], i == j && k == 0 ? 1.0 : 0.0, rounding(n) * std::pow(2.0 * n, k) / factorial(k));
}

TEST(Random, NumbersAreThoseOfSplitmix64) {
  // First outputs for the seed 1234567, as published with the reference implementation.
  RandomNumbers random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317u);
  EXPECT_EQ(random.next(), 3203168211198807973u);
  EXPECT_EQ(random.next(), 9817491932198370423u);
}

TEST(Random, RowScalingMultipliesEAndAAndFAlike) {
  const auto plain = random_family(5, {.row_decades = 0}), scaled = random_family(5, {.row_decades = 10});
  const int m = plain->m(), n = plain->n();
  const auto E = matrix(*plain, &LinearFamily::E, 0.2, 1, n);
  const auto E_scaled = matrix(*scaled, &LinearFamily::E, 0.2, 1, n);
  const auto f = matrix(*plain, &LinearFamily::f, 0.2, 0, 1);
  const auto f_scaled = matrix(*scaled, &LinearFamily::f, 0.2, 0, 1);
  for (int i = 0; i < m; ++i) {
    const double factor = f_scaled[as_size(i)] / f[as_size(i)];
    EXPECT_NEAR(std::log10(factor), std::round(std::log10(factor)), rounding(1));
    for (int j = 0; j < n; ++j)
      EXPECT_NEAR(E_scaled[as_size(i + j * m)], factor * E[as_size(i + j * m)],
                  rounding(1) * std::abs(E_scaled[as_size(i + j * m)]));
  }
}

TEST(Random, ContradictionsLeaveNoSolutionOnlyWithZeroRows) {
  int contradictory = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const auto family = random_family(seed, {.singular_blocks = false, .rho = 1e-3});
    EXPECT_EQ(family->has_exact(), family->values().v == 0);
    if (!family->has_exact()) ++contradictory;
  }
  EXPECT_GT(contradictory, 10);
}

// All kinds of structure occur, otherwise the tests above say nothing about them.
TEST(Random, FamiliesCoverTheStructures) {
  int with_mu[5] = {}, wide = 0, tall = 0, both = 0, dynamic = 0, algebraic_only = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const auto family = random_family(seed, {.max_size = 10});
    const CharacteristicValues c = family->values();
    ++with_mu[c.mu];
    if (c.u > 0) ++wide;
    if (c.v > 0) ++tall;
    if (c.u > 0 && c.v > 0) ++both;
    if (c.d > 0) ++dynamic;
    if (c.d == 0) ++algebraic_only;
    EXPECT_LE(family->m(), 10);
    EXPECT_LE(family->n(), 10);
  }
  for (int count : with_mu) EXPECT_GE(count, 30);
  for (int count : {wide, tall, both, dynamic, algebraic_only}) EXPECT_GE(count, 30);
}

// ---- Callbacks ------------------------------------------------------------------------------------------------

TEST(FamilyProblem, CallbacksGiveTheDerivativesOfTheFamilyInWhateverOrderTheyAreAskedFor) {
  const std::shared_ptr<const LinearFamily> families[] = {kron(6, 2), kron(6, 2, 0.0), chain(5, 2), random_family(3),
                                                          rotated_ode(RowOperation::scaling)};
  for (const auto& family : families) {
    SCOPED_TRACE(family->name());
    FamilyProblem p(family);
    ASSERT_EQ(p.problem.num_equations, family->m());
    ASSERT_EQ(p.problem.num_unknowns, family->n());
    const int n = family->n();
    std::vector<double> values(as_size(family->m() * n)), f(as_size(family->m()));
    RandomNumbers random(1);
    for (int i = 0; i < 60; ++i) {
      const double t = 0.1 * random.integer(0, 6);
      const int k = random.integer(0, 5);
      ASSERT_EQ(p.problem.E(t, k, values.data(), p.problem.user), 0);
      EXPECT_EQ(values, matrix(*family, &LinearFamily::E, t, k, n));
      ASSERT_EQ(p.problem.A(t, k, values.data(), p.problem.user), 0);
      EXPECT_EQ(values, matrix(*family, &LinearFamily::A, t, k, n));
      ASSERT_EQ(p.problem.f(t, k, f.data(), p.problem.user), 0);
      EXPECT_EQ(f, matrix(*family, &LinearFamily::f, t, k, 1));
    }
    EXPECT_EQ(p.calls(), 180);
    EXPECT_EQ(p.calls(Callback::A), 60);
  }
}

TEST(FamilyProblem, CountsCallsByFunctionAndOrder) {
  FamilyProblem p(kron(4, 1));
  std::vector<double> values(16);
  EXPECT_EQ(p.highest_order_asked(), -1);
  for (int k = 0; k <= 2; ++k) p.problem.E(0.0, k, values.data(), p.problem.user);
  p.problem.E(0.5, 1, values.data(), p.problem.user);
  p.problem.f(0.5, 0, values.data(), p.problem.user);
  EXPECT_EQ(p.calls(Callback::E, 0), 1);
  EXPECT_EQ(p.calls(Callback::E, 1), 2);
  EXPECT_EQ(p.calls(Callback::E), 4);
  EXPECT_EQ(p.calls(Callback::A), 0);
  EXPECT_EQ(p.calls(), 5);
  EXPECT_EQ(p.highest_order_asked(), 2);
  p.reset_counts();
  EXPECT_EQ(p.calls(), 0);
}

TEST(FamilyProblem, OrdersAboveTheHighestAreNotAvailable) {
  FamilyProblem p(kron(4, 1), {.highest_order = 1});
  std::vector<double> values(16);
  EXPECT_EQ(p.problem.A(0.0, 1, values.data(), p.problem.user), 0);
  EXPECT_EQ(p.problem.A(0.0, 2, values.data(), p.problem.user), SFDAE_ORDER_NOT_AVAILABLE);
  p.hooks.highest_order = 1000;
  EXPECT_EQ(p.problem.A(0.0, max_family_order, values.data(), p.problem.user), 0);
  EXPECT_EQ(p.problem.A(0.0, max_family_order + 1, values.data(), p.problem.user), SFDAE_ORDER_NOT_AVAILABLE);
}

TEST(FamilyProblem, HooksInjectStatusesAndValues) {
  FamilyProblem p(kron(4, 1), {.status = return_at_call(2, -7), .tamper = poison_behind(0.5, NAN)});
  std::vector<double> values(16);
  EXPECT_EQ(p.problem.E(0.0, 0, values.data(), p.problem.user), 0);
  EXPECT_EQ(p.problem.E(0.0, 0, values.data(), p.problem.user), -7);
  EXPECT_EQ(p.problem.E(0.5, 0, values.data(), p.problem.user), 0);
  EXPECT_TRUE(std::isfinite(values[0]));
  EXPECT_EQ(p.problem.E(0.6, 0, values.data(), p.problem.user), 0);
  EXPECT_TRUE(std::isnan(values[0]));
  p.hooks = {.status = return_behind(0.7, 3), .measure_time = true};
  EXPECT_EQ(p.problem.E(0.6, 0, values.data(), p.problem.user), 0);
  EXPECT_TRUE(std::isfinite(values[0]));
  EXPECT_EQ(p.problem.E(0.8, 0, values.data(), p.problem.user), 3);
  EXPECT_GT(p.seconds(), 0.0);
}

// Counts how often coefficients are computed.
class Counting : public LinearFamily {
 public:
  Counting() : LinearFamily("counting", {2, 1, 0, 0, 0}) {}
  void matrix_coefficients(double, int order, double* E, double* A) const override {
    ++matrices;
    std::fill_n(E, order + 1, 1.0);
    std::fill_n(A, order + 1, 1.0);
  }
  void vector_coefficients(double, int order, double* f) const override {
    ++vectors;
    std::fill_n(f, order + 1, 1.0);
  }
  mutable int matrices = 0, vectors = 0;
};

TEST(FamilyProblem, OneComputationServesAllOrdersAtAPoint) {
  const auto family = std::make_shared<Counting>();
  FamilyProblem p(family);
  double value = 0.0;
  for (double t : {0.0, 0.1, 0.2, 0.3})
    for (int k = 0; k <= 3; ++k) {
      p.problem.E(t, k, &value, p.problem.user);
      p.problem.A(t, k, &value, p.problem.user);
      p.problem.f(t, k, &value, p.problem.user);
      EXPECT_EQ(value, factorial(k));
    }
  EXPECT_EQ(family->matrices, 4);  // mu + 1 = 3 is expected from the start
  EXPECT_EQ(family->vectors, 4);
  p.problem.E(0.1, 2, &value, p.problem.user);  // still known
  EXPECT_EQ(family->matrices, 4);
}

}  // namespace sfdae_test
