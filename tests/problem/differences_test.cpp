// SPDX-License-Identifier: BSD-3-Clause
// Difference formulas: exact for polynomials, honest about their errors.
#include "problem/differences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"

namespace sfdae::core {

namespace {

using sfdae_test::factorial;
using sfdae_test::size;
using sfdae_test::unit_roundoff;

constexpr int formula_points = DifferenceFormula::points;

// k-th derivative of x^p.
double derivative_of_power(double x, int p, int k) {
  return k > p ? 0.0 : factorial(p) / factorial(p - k) * std::pow(x, p - k);
}

std::vector<double> sine_samples(double t, double step, int shift, double speed) {
  std::vector<double> samples;
  for (int i = 0; i < formula_points; ++i) samples.push_back(std::sin(speed * (t + (i - shift) * step)));
  return samples;
}

}  // namespace

// The order conditions: weights on p + 1 nodes reproduce every derivative of every polynomial of degree p.
TEST(DifferenceWeights, AreExactForPolynomials) {
  for (const std::vector<double>& nodes : {std::vector<double>{0.0},
                                           {0.0, 1.0},
                                           {-1.0, 0.0, 1.0},
                                           {0.0, -1.0, 2.0, 3.5},
                                           {-4, -3, -2, -1, 0, 1, 2, 3, 4}})
    for (double at : {0.0, 0.3, -1.0}) {
      const int degree = static_cast<int>(nodes.size()) - 1;
      const std::vector<double> w = difference_weights(at, nodes, degree);
      ASSERT_EQ(w.size(), nodes.size() * nodes.size());
      for (int k = 0; k <= degree; ++k)
        for (int p = 0; p <= degree; ++p) {
          double value = 0.0, terms = 0.0;
          for (std::size_t i = 0; i < nodes.size(); ++i) {
            value += w[size(k) * nodes.size() + i] * std::pow(nodes[i], p);
            terms += std::fabs(w[size(k) * nodes.size() + i] * std::pow(nodes[i], p));
          }
          EXPECT_NEAR(value, derivative_of_power(at, p, k), 100.0 * unit_roundoff * (terms + factorial(degree)));
        }
    }
}

// Textbook weights.
TEST(DifferenceWeights, OfThreePointsAreTheCentralDifferences) {
  const std::vector<double> w = difference_weights(0.0, {-1.0, 0.0, 1.0}, 2);
  const std::vector<double> expected{0, 1, 0, -0.5, 0, 0.5, 1, -2, 1};
  EXPECT_LE(sfdae_test::distance(w, expected), 10.0 * unit_roundoff);
}

TEST(DifferenceWeights, OfOrdersWithTooFewNodesAreZero) {
  const std::vector<double> w = difference_weights(0.0, {0.0, 1.0}, 3);
  for (std::size_t i = 4; i < 8; ++i) EXPECT_EQ(w[i], 0.0);
}

TEST(DifferenceFormula, IsExactForPolynomialsFromEveryPositionOfThePoint) {
  for (int shift = 0; shift < formula_points; ++shift) {
    const DifferenceFormula formula(shift, 3);
    const double t = 0.4, step = 0.25;
    std::vector<double> samples;
    for (int i = 0; i < formula_points; ++i) {  // two rows: t^3 and 1
      samples.push_back(std::pow(t + (i - shift) * step, 3));
      samples.push_back(1.0);
    }
    for (int k = 0; k <= 3; ++k) {
      double derivative[2], error = -1.0;
      formula.apply(k, step, samples.data(), 2, derivative, &error);
      EXPECT_LE(std::fabs(derivative[0] - derivative_of_power(t, 3, k)), error);
      EXPECT_LE(std::fabs(derivative[1] - (k == 0 ? 1.0 : 0.0)), error);
      // Degree 3 leaves rounding errors alone: weights of 9 points at most 2^9 k!-fold, values at most 2.4^3.
      EXPECT_LE(error, 512.0 * factorial(k) * 14.0 * 100.0 * unit_roundoff / std::pow(step, k));
    }
  }
}

TEST(DifferenceFormula, ErrorIsAboveTheTrueErrorAndNotFarAbove) {
  for (int shift : {0, 2, 4, 8})
    for (double step : {0.2, 0.05, 0.01})
      for (int k = 1; k <= 4; ++k) {
        const std::vector<double> samples = sine_samples(0.7, step, shift, 1.3);
        const double exact = factorial(k) * sfdae_test::sine_cosine(0.0, 1.3, 0.7, k).sine[k];
        double derivative = 0.0, error = 0.0;
        DifferenceFormula(shift, k).apply(k, step, samples.data(), 1, &derivative, &error);
        EXPECT_LE(std::fabs(derivative - exact), 2.0 * error) << shift << ", " << step << ", " << k;
        // At most the error of 7 points (order 7 - k, one-sided constants below 10 k!) and rounding.
        const double truncation = 10.0 * factorial(k) * std::pow(8.0 * 1.3 * step, 7 - k) * std::pow(1.3, k);
        const double rounding = 512.0 * factorial(k + 1) * 10.0 * unit_roundoff / std::pow(step, k);
        EXPECT_LE(error, truncation + rounding) << shift << ", " << step << ", " << k;
      }
}

// Centred first derivative on 9 points: order 8. Halving the step divides the error by 2^8, up to higher terms.
TEST(DifferenceFormula, HasOrderEight) {
  double errors[2];
  const double steps[] = {0.4, 0.2};
  for (int q = 0; q < 2; ++q) {
    const std::vector<double> samples = sine_samples(0.7, steps[q], 4, 1.0);
    double derivative = 0.0, estimate = 0.0;
    DifferenceFormula(4, 1).apply(1, steps[q], samples.data(), 1, &derivative, &estimate);
    errors[q] = std::fabs(derivative - std::cos(0.7));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 8.0, 0.5);
}

}  // namespace sfdae::core
