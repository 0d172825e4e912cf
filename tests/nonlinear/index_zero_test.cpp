// SPDX-License-Identifier: BSD-3-Clause
// Problems of strangeness index 0, whose factorizations are kept over steps: what is accepted with an old matrix is
// right, and changes of the ranks are seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;

// x = cos t, z^3 + z = x, with a rate that swings between 1 and 2000 within a time of 0.06, and depends on x and z, and
// with a mass that does: every old Jacobian is wrong by factors.
template <class V>
void swinging(const V& t, const V* x, const V* xdot, V* F) {
  using std::cos, std::exp, std::sin;
  const V rate = exp(3.8 + 3.8 * sin(100.0 * t)), error = x[0] - cos(t);
  F[0] = (2.0 + sin(20.0 * x[0] * x[1])) * (xdot[0] + sin(t)) + rate * error * (1.0 + 1e4 * error * error);
  F[1] = x[1] * x[1] * x[1] + x[1] - x[0];
}

double root_of_cubic(double x) {
  double z = x;
  for (int k = 0; k < 60; ++k) z -= (z * z * z + z - x) / (3.0 * z * z + 1.0);
  return z;
}

class Swinging : public testing::TestWithParam<int> {};

// The first of these solutions errs by what is left of every iteration, damped by the rate: within ten tolerances at
// all outputs.
TEST_P(Swinging, IsSolvedWithinTheTolerance) {
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
    NonlinearRun run(equations_of(2, 2, [](const auto& t, auto... a) { swinging(t, a...); }),
                     options_with(tolerance, GetParam()));
    ASSERT_EQ(run.start(0.0, 3.0, {1.0, root_of_cubic(1.0)}), SFDAE_OK) << run.message();
    double worst = 0.0;
    for (int k = 1; k <= 60; ++k) {
      const double t = 0.05 * k;
      ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
      const double x = std::cos(t), z = root_of_cubic(x);
      worst = std::max(
          {worst, std::fabs(run.x[0] - x) / (1.0 + std::fabs(x)), std::fabs(run.x[1] - z) / (1.0 + std::fabs(z))});
      // The constraint holds whatever the error of x.
      EXPECT_NEAR(run.x[1], root_of_cubic(run.x[0]), 1e-13) << t;
    }
    EXPECT_LE(worst, 10.0 * tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(IndexZero, Swinging, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// Van der Pol's oscillator, eps x'' = (1 - x^2) x' - x: relaxations jump within a time of eps, where no old Jacobian
// is of use. Compared with itself at a much smaller tolerance.
TEST(IndexZero, RelaxationsOfVanDerPolsOscillatorAreInTime) {
  const auto oscillator = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[1];
    F[1] = 1e-3 * xdot[1] - (1.0 - x[0] * x[0]) * x[1] + x[0];
  });
  std::vector<double> reference;
  for (const double tolerance : {1e-10, 1e-4, 1e-6}) {
    NonlinearRun run(oscillator, options_with(tolerance));
    ASSERT_EQ(run.start(0.0, 2.5, {2.0, -2.0 / 3.0}), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(2.5), SFDAE_OK) << run.message();
    if (reference.empty()) reference = run.x;
    // After three relaxations errors of a jump have become errors of time.
    EXPECT_NEAR(run.x[0], reference[0], 100.0 * tolerance) << tolerance;
  }
}

// Ten masses that change a lot, and two constraints: with rows of its own that do not depend on x' every one of them is
// taken by the kernel of E. x_i = cos(t + i), z_1 = x_0 x_1, z_2 = z_1 + x_9.
TEST(IndexZero, FewConstraintsAreWithinTheTolerance) {
  constexpr int d = 10;
  const auto equations = equations_of(d + 2, d + 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    for (int i = 0; i < d; ++i) {
      const double number = i;
      F[i] = (1.5 + sin(3.0 * t + number)) * (xdot[i] + sin(t + number)) + 10.0 * number * (x[i] - cos(t + number)) +
             x[d] - cos(t) * cos(t + 1.0);
    }
    F[d] = x[d] - x[0] * x[1];
    F[d + 1] = x[d + 1] - x[d] - x[d - 1];
  });
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    std::vector<double> start;
    for (int i = 0; i < d; ++i) start.push_back(std::cos(i));
    start.push_back(start[0] * start[1]);
    start.push_back(start[d] + start[d - 1]);
    NonlinearRun run(equations, options_with(tolerance));
    ASSERT_EQ(run.start(0.0, 10.0, start), SFDAE_OK) << run.message();
    for (int k = 1; k <= 20; ++k) {
      const double t = 0.5 * k;
      ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
      for (std::size_t i = 0; i < d; ++i) {
        const double exact = std::cos(t + static_cast<double>(i));
        EXPECT_NEAR(run.x[i], exact, 10.0 * tolerance * (1.0 + std::fabs(exact))) << i << " at " << t;
      }
      EXPECT_NEAR(run.x[d], run.x[0] * run.x[1], 1e-14);
      EXPECT_NEAR(run.x[d + 1], run.x[d] + run.x[d - 1], 1e-14);
    }
  }
}

template <class Problem>
void expect_stop_at_1(const Problem& problem, const std::vector<double>& x0) {
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      NonlinearRun run(problem, options_with(tolerance, method));
      ASSERT_EQ(run.start(0.0, 2.0, x0), SFDAE_OK) << run.message();
      EXPECT_EQ(run.advance(2.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
      EXPECT_NEAR(run.t, 1.0, 1e-2);
      EXPECT_LE(run.t, 1.0 + 1e-12);
    }
  }
}

// (1 - t) (x' + sin t) + x - cos t = 0: E vanishes at t = 1, slowly, with nothing to be seen in the solution x = cos t.
TEST(IndexZero, MassesThatVanishAreNoticed) {
  const auto vanishing = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = (1.0 - t) * (xdot[0] + sin(t)) + x[0] - cos(t);
    F[1] = xdot[1] + x[1] - x[0];
  });
  expect_stop_at_1(vanishing, {1.0, 0.0});
}

// Constraints as well: (1 - t) (z - x) = 0.
TEST(IndexZero, ConstraintsThatVanishAreNoticed) {
  const auto vanishing = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[1];
    F[1] = (1.0 - t) * (x[1] - x[0]);
  });
  expect_stop_at_1(vanishing, {1.0, 1.0});
}

// (1 - t) x' + a x = f(t), linear: all of E vanishes at t = 1, where bounded solutions are a x = f, and none of them
// goes on in one way only.
TEST(IndexZero, LeadingCoefficientsThatVanishAreNoticed) {
  for (const double a : {0.5, 1.0, 2.0}) {
    const auto vanishing = equations_of(1, 1, [a](const auto& t, const auto* x, const auto* xdot, auto* F) {
      F[0] = (1.0 - t) * xdot[0] + a * x[0] - sin(t);
    });
    expect_stop_at_1(vanishing, {0.0});
  }
}

// The same twice: no sign changes.
TEST(IndexZero, LeadingCoefficientsThatVanishTwiceAreNoticed) {
  const auto pair = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = (1.0 - t) * xdot[0] + x[0] - sin(t);
    F[1] = (1.0 - t) * xdot[1] + 2.0 * x[1] - x[0];
  });
  expect_stop_at_1(pair, {0.0, 0.5});
}

// E that jumps from 1 to -1 does not vanish: x = exp(-|t - 1|).
TEST(IndexZero, LeadingCoefficientsThatJumpAreNoChange) {
  const auto jumping = equations_of(1, 1, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = choose(t - 1.0, sfdae::Expression(-1.0), sfdae::Expression(1.0)) * xdot[0] - x[0];
  });
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(jumping, options_with(1e-6, method));
    ASSERT_EQ(run.start(0.0, 2.0, {std::exp(-1.0)}), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.x[0], std::exp(-1.0), 1e-4);
  }
}

// u_i' = diffusion + reaction with 60 unknowns: far fewer factorizations than steps.
TEST(IndexZero, FactorizationsAreKept) {
  constexpr int n = 60;
  const auto diffusion = equations_of(n, n, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    for (int i = 0; i < n; ++i) {
      const auto& left = x[i == 0 ? 1 : i - 1];
      const auto& right = x[i == n - 1 ? n - 2 : i + 1];
      F[i] = (1.0 + 0.1 * x[i] * x[i]) * xdot[i] - 100.0 * (left - 2.0 * x[i] + right) - x[i] * (1.0 - x[i]);
    }
  });
  std::vector<double> start(n);
  for (int i = 0; i < n; ++i) start[static_cast<std::size_t>(i)] = 0.5 + 0.4 * std::cos(3.14159265 * i / (n - 1));
  NonlinearRun run(diffusion, options_with(1e-6));
  ASSERT_EQ(run.start(0.0, 10.0, start), SFDAE_OK) << run.message();
  ASSERT_EQ(run.advance(10.0), SFDAE_OK) << run.message();
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  ASSERT_EQ(sfdae_get_statistics(run.solver(), &statistics), SFDAE_OK);
  EXPECT_LE(3 * statistics.factorizations, statistics.steps);
  EXPECT_LE(statistics.evaluations_F, 3 * statistics.steps + 100);
}

}  // namespace
