// SPDX-License-Identifier: BSD-3-Clause
//
// Weights of start values by their definition: sum (change_i / w_i)^2 is least among consistent values.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "random.h"

namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;

using sfdae_test::Random;

Vector weights_between(Random& random, double least, double most, int count) {
  Vector weights = random.reals(count, std::log(least), std::log(most));
  for (double& weight : weights) weight = std::exp(weight);
  return weights;
}

Vector consistent(const sfdae::NonlinearProblem& problem, const Vector& weights, const Vector& x,
                  int structure = SFDAE_STRUCTURE_AUTOMATIC) {
  sfdae::Options options;
  options.structure = structure;
  options.initial_weights = weights;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, x, {}};
  EXPECT_GE(solver.make_consistent(point), SFDAE_OK);
  return point.x;
}

// c^T x = 1 and four differential equations: W^-2 dx = s c.
TEST(WeightedStartValues, FulfilTheConditionsOfAMinimum) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const Vector c = random.reals(5, 0.5, 2.0), x = random.reals(5, -1.0, 1.0);
    const Vector weights = weights_between(random, 1e-3, 1e3, 5);
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [&](const Expression&, ConstExpressions unknowns, ConstExpressions xdot, Expressions F) {
      Expression sum = -1.0;
      for (int i = 0; i < 5; ++i) sum = sum + c[static_cast<std::size_t>(i)] * unknowns[i];
      F[4] = sum;
      for (int i = 0; i < 4; ++i) F[i] = xdot[i] - xdot[4] + unknowns[i];
    };
    const Vector found = consistent(problem, weights, x);
    double residual = 1.0, size = 0.0;
    for (std::size_t i = 0; i < 5; ++i) {
      residual -= c[i] * x[i];
      size += c[i] * c[i] * weights[i] * weights[i];
    }
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_NEAR((found[i] - x[i]) / weights[i], residual / size * c[i] * weights[i],
                  1e-7 * std::fabs(residual) / std::sqrt(size))
          << "seed " << seed;
  }
}

// The pendulum in a plane, index 3: its consistent values are a surface of angle a and angular velocity b.
std::array<double, 5> on_surface(double a, double b) {
  return {std::cos(a), std::sin(a), -b * std::sin(a), b * std::cos(a), b * b - 9.81 * std::sin(a)};
}

struct Sum {
  Vector weights, given;
  double operator()(double a, double b) const {
    const auto x = on_surface(a, b);
    double sum = 0.0;
    for (std::size_t i = 0; i < 5; ++i) sum += std::pow((x[i] - given[i]) / weights[i], 2);
    return sum;
  }
};

TEST(WeightedStartValues, AreALocalMinimumOnBentConstraints) {
  sfdae::NonlinearProblem pendulum(5, 5);
  pendulum.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] * x[4];
    F[3] = xdot[3] + x[1] * x[4] + 9.81;
    F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  int found_by_structure = 0;
  for (unsigned trial = 0; trial < 120; ++trial) {
    const unsigned seed = trial / 2;
    const int structure = trial % 2 == 0 ? SFDAE_STRUCTURE_OFF : SFDAE_STRUCTURE_REQUIRED;
    Random random(seed);
    const auto exact = on_surface(random.real(0.0, 6.28), random.real(-1.0, 1.0));
    Sum sum{seed % 3 == 0 ? Vector{1.0, 0.01, 1.0, 0.01, 1.0} : weights_between(random, 0.01, 1.0, 5), {}};
    for (double entry : exact) sum.given.push_back(entry + 0.3 * random.real(-1.0, 1.0));
    Vector found;
    try {
      found = consistent(pendulum, sum.weights, sum.given, structure);
    } catch (const sfdae::Error& error) {
      // The search of the extension may not come to an end, and says so.
      ASSERT_EQ(error.status(), SFDAE_NO_CONSISTENT_VALUES) << error.what();
      ASSERT_EQ(structure, SFDAE_STRUCTURE_REQUIRED);
      continue;
    }
    if (structure == SFDAE_STRUCTURE_REQUIRED) ++found_by_structure;
    const double a = std::atan2(found[1], found[0]), b = found[3] * std::cos(a) - found[2] * std::sin(a);
    const auto on = on_surface(a, b);
    for (std::size_t i = 0; i < 5; ++i) ASSERT_NEAR(found[i], on[i], 1e-8);
    // Nowhere within 1e-3 ... 0.03 about it is the sum less, but for what the end of the iteration leaves.
    const double least = sum(a, b);
    for (double radius : {1e-3, 1e-2, 3e-2})
      for (int k = 0; k < 16; ++k) {
        const double angle = k * std::acos(-1.0) / 8.0;
        EXPECT_GE(sum(a + radius * std::cos(angle), b + radius * std::sin(angle)), least * (1.0 - 1e-4))
            << "seed " << seed << ", structure " << structure << ", radius " << radius;
      }
  }
  EXPECT_GE(found_by_structure, 20);
}

// Only their ratios count, and whose squares overflow are weights, too: what must hardly move does not.
TEST(WeightedStartValues, MayHaveSquaresThatOverflow) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] + x[1];
    F[1] = x[1] * x[1] - x[0] - 1.5;
  };
  const Vector x = consistent(problem, {0.5, 2.0}, {1.0, 1.3});
  for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED}) {
    for (double unit : {1e-200, 1e200}) {
      const Vector same = consistent(problem, {0.5 * unit, 2.0 * unit}, {1.0, 1.3}, structure);
      for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(same[i], x[i], 1e-8);
    }
    EXPECT_NEAR(consistent(problem, {1e-200, 1e100}, {1.0, 1.3}, structure)[0], 1.0, 1e-12);
    EXPECT_NEAR(consistent(problem, {1e100, 1e-200}, {1.0, 1.3}, structure)[1], 1.3, 1e-12);
  }
}

}  // namespace
