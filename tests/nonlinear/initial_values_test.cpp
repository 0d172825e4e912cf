// SPDX-License-Identifier: BSD-3-Clause
// Consistent initial values of nonlinear problems.
#include <gtest/gtest.h>

#include <cmath>

#include "matrix_checks.h"
#include "nonlinear_run.h"
#include "test_set/pendulum.h"

namespace {

using namespace sfdae_test;

NonlinearEquations pendulum_equations() {
  return equations_of(
      5, 5, [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); });
}

// All constraints of x = (x, y, u, v, lambda), hidden ones included: |p|^2 = 1, p v = 0, |v|^2 - lambda |p|^2 - g y =
// 0.
double violation(const std::vector<double>& x) {
  return largest({x[0] * x[0] + x[1] * x[1] - 1.0, x[0] * x[2] + x[1] * x[3],
                  (x[2] * x[2] + x[3] * x[3] - x[4] * (x[0] * x[0] + x[1] * x[1]) - Pendulum::gravity * x[1]) /
                      (1.0 + std::abs(x[4]))});
}

// The consistent point of angle phi (from the x axis) and speed s.
std::vector<double> consistent_point(double phi, double s) {
  const double x = std::cos(phi), y = std::sin(phi);
  return {x, y, -s * y, s * x, s * s - Pendulum::gravity * y};
}

double squared_distance(const std::vector<double>& a, const std::vector<double>& b,
                        const std::vector<double>& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow((a[i] - b[i]) / weights[i], 2);
  return sum;
}

// The least squared distance of a consistent point, by search on a grid that becomes finer around its best point.
double least_squared_distance(const std::vector<double>& guess, const std::vector<double>& weights) {
  constexpr int half = 40;
  double phi = 0.0, s = 0.0, width_phi = 3.2, width_s = 20.0, best = INFINITY;
  for (int round = 0; round < 24; ++round) {
    const double phi0 = phi, s0 = s;
    for (int i = -half; i <= half; ++i)
      for (int j = -half; j <= half; ++j) {
        const double p = phi0 + width_phi * i / half, q = s0 + width_s * j / half;
        const double distance = squared_distance(consistent_point(p, q), guess, weights);
        if (distance < best) best = distance, phi = p, s = q;
      }
    width_phi *= 0.4, width_s *= 0.4;
  }
  return best;
}

void expect_nearest(const std::vector<double>& guess, const std::vector<double>& weights) {
  sfdae_options options = default_options();
  options.initial_weights = weights.data();
  NonlinearRun run(pendulum_equations(), options);
  const int status = run.start(0.0, 1.0, guess);
  ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
  EXPECT_LE(violation(run.x), 1e-12);
  const double least = least_squared_distance(guess, weights);
  EXPECT_LE(squared_distance(run.x, guess, weights), least * (1.0 + 1e-6) + 1e-12);
}

TEST(NearestValues, AreAsNearAsASearchFinds) {
  const std::vector<double> equal(5, 1.0);
  for (const double phi : {-0.2, -1.0, -1.5, -2.5})
    for (const double s : {0.0, 0.5, 2.0}) {
      SCOPED_TRACE(testing::Message() << "phi " << phi << ", s " << s);
      std::vector<double> guess = consistent_point(phi, s);
      for (std::size_t i = 0; i < 5; ++i) guess[i] += 0.05 * std::sin(3.0 + 2.0 * static_cast<double>(i) + phi);
      expect_nearest(guess, equal);
    }
}

TEST(NearestValues, AreNearestInTheWeightedNorm) {
  for (const double phi : {-0.4, -1.2}) {
    std::vector<double> guess = consistent_point(phi, 1.0);
    guess[0] += 0.1, guess[3] -= 0.2, guess[4] += 1.0;
    expect_nearest(guess, {1.0, 1.0, 1.0, 1.0, 1e3});
    if (phi < -1.0) expect_nearest(guess, {1e-2, 1.0, 1.0, 1.0, 10.0});
  }
}

TEST(Guesses, MayLackTheForce) {
  for (double phi = -3.1; phi < 3.15; phi += 0.1) {
    SCOPED_TRACE(phi);
    const std::vector<double> exact = consistent_point(phi, 0.7);
    std::vector<double> guess = exact;
    guess[4] = 0.0;
    NonlinearRun run(pendulum_equations(), default_options());
    const int status = run.start(0.0, 1.0, guess);
    ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
    EXPECT_EQ(run.values(), (CharacteristicValues{2, 2, 3, 0, 0}));
    EXPECT_LE(distance(run.x, exact), 1e-13);
  }
}

// At rest exactly below the support: the constraint is horizontal, and the force 9.81 is missing.
TEST(Guesses, MayBeThePendulumThatHangs) {
  NonlinearRun run(pendulum_equations(), default_options());
  const int status = run.start(0.0, 1.0, {0.0, -1.0, 0.0, 0.0, 0.0});
  ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
  EXPECT_LE(distance(run.x, {0.0, -1.0, 0.0, 0.0, Pendulum::gravity}), 1e-12);
}

TEST(Guesses, MayBeFarOff) {
  RandomNumbers numbers(11);
  int failures = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<double> guess = consistent_point(numbers.uniform(-3.2, 3.2), numbers.uniform(-4.0, 4.0));
    guess[0] *= 1.3, guess[1] *= 1.3;
    guess[2] *= 0.5, guess[3] *= 0.5;
    guess[4] = numbers.uniform(-10.0, 30.0);
    NonlinearRun run(pendulum_equations(), default_options());
    const int status = run.start(0.0, 1.0, guess);
    if (status < 0) {
      ++failures;
      continue;
    }
    EXPECT_EQ(status, SFDAE_VALUES_CHANGED) << trial;
    EXPECT_LE(violation(run.x), 1e-11) << trial;
  }
  EXPECT_LE(failures, 1);
}

TEST(FixedValues, StayInEveryBit) {
  const int fixed[] = {1, 0, 0, 1, 0};
  sfdae_options options = default_options();
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  for (const double x : {0.3, 0.6, -0.8}) {
    NonlinearRun run(pendulum_equations(), options);
    const std::vector<double> guess = {x, -0.9, 0.2, 0.1 + x / 7.0, 5.0};
    const int status = run.start(0.0, 1.0, guess);
    ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
    EXPECT_EQ(run.x[0], guess[0]);
    EXPECT_EQ(run.x[3], guess[3]);
    EXPECT_LE(violation(run.x), 1e-11);
  }
}

TEST(FixedValues, ThatAreImpossibleAreRefused) {
  const int fixed[] = {1, 1, 0, 0, 0};
  sfdae_options options = default_options();
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  NonlinearRun run(pendulum_equations(), options);
  const std::vector<double> guess = {0.6, -0.9, 0.0, 0.0, 5.0};
  const int status = run.start(0.0, 1.0, guess);
  EXPECT_TRUE(status == SFDAE_FIXED_VALUES || status == SFDAE_NO_CONSISTENT_VALUES) << status_text(run, status);
  EXPECT_NE(run.message(), "");
  EXPECT_EQ(run.x, guess);
}

TEST(AcceptedValues, AreCheckedAndKept) {
  sfdae_options options = default_options();
  options.initial_values = SFDAE_INITIAL_ACCEPT;
  const std::vector<double> exact = consistent_point(-0.7, 1.5);
  NonlinearRun run(pendulum_equations(), options);
  ASSERT_EQ(run.start(0.0, 1.0, exact), SFDAE_OK) << run.message();
  EXPECT_LE(distance(run.x, exact), 1e-12);
  for (std::size_t i = 0; i < 5; ++i) {
    std::vector<double> wrong = exact;
    wrong[i] += 0.1;
    const int status = run.start(0.0, 1.0, wrong);
    EXPECT_EQ(status, SFDAE_INCONSISTENT_VALUES) << i << ": " << status_text(run, status);
  }
}

// 0 = y^2 + 1 + x^2 has no solution; equation 1 is to blame.
TEST(ImpossibleConstraints, AreNamedByEquation) {
  NonlinearRun run(equations_of(2, 2,
                                [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                  F[0] = xdot[0] + x[0];
                                  F[1] = x[1] * x[1] + 1.0 + x[0] * x[0];
                                }),
                   default_options());
  const int status = run.start(0.0, 1.0, {1.0, 1.0});
  EXPECT_EQ(status, SFDAE_NO_CONSISTENT_VALUES) << status_text(run, status);
  EXPECT_NE(run.message().find("equation 1 by"), std::string::npos) << run.message();
}

}  // namespace
