// Functions with jumps and comparisons in recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "recorded_formulas.h"

namespace sfdae::test {
namespace {

TEST(RecordedFunctions, OfNumbersAreNumbers) {
  const auto n = [](double value) { return sfdae_number(value); };
  EXPECT_NEAR(number(sfdae_log10(n(1000.0))), 3.0, 4 * eps);
  EXPECT_EQ(number(sfdae_floor(n(-0.5))), -1.0);
  EXPECT_EQ(number(sfdae_sign(n(-3.0))), -1.0);
  EXPECT_EQ(number(sfdae_sign(n(0.0))), 0.0);
  EXPECT_EQ(number(sfdae_sign(n(1e-300))), 1.0);
  EXPECT_EQ(number(sfdae_modulo(n(7.5), n(2.0))), 1.5);
  EXPECT_EQ(number(sfdae_modulo(n(-0.5), n(2.0))), 1.5);
  EXPECT_EQ(number(sfdae_modulo(n(0.5), n(-2.0))), -1.5);
  EXPECT_EQ(number(sfdae_modulo(n(6.0), n(2.0))), 0.0);
  EXPECT_LT(number(sfdae_modulo(n(-1e-30), n(2.0))), 2.0);
  EXPECT_TRUE(std::isnan(sfdae_modulo(n(1.0), n(0.0)).value));
  EXPECT_TRUE(std::isnan(sfdae_log10(n(-1.0)).value));
  const double pairs[][2] = {{1.0, 2.0}, {2.0, 1.0}, {2.0, 2.0}};
  for (const auto& [a, b] : pairs) {
    EXPECT_EQ(number(sfdae_less(n(a), n(b))), a < b ? 1.0 : 0.0);
    EXPECT_EQ(number(sfdae_less_equal(n(a), n(b))), a <= b ? 1.0 : 0.0);
    EXPECT_EQ(number(sfdae_greater(n(a), n(b))), a > b ? 1.0 : 0.0);
    EXPECT_EQ(number(sfdae_greater_equal(n(a), n(b))), a >= b ? 1.0 : 0.0);
  }
  for (double a : {-1.0, 0.0, 0.5})
    for (double b : {-1.0, 0.0, 2.0}) {
      EXPECT_EQ(number(sfdae_and(n(a), n(b))), a > 0.0 && b > 0.0 ? 1.0 : 0.0);
      EXPECT_EQ(number(sfdae_or(n(a), n(b))), a > 0.0 || b > 0.0 ? 1.0 : 0.0);
      EXPECT_EQ(number(sfdae_not(n(a))), a > 0.0 ? 0.0 : 1.0);
    }
  EXPECT_TRUE(std::isnan(sfdae_less(n(nan_value), n(1.0)).value));
}

TEST(RecordedFunctions, AreThoseOfNumbers) {
  const Formulas formulas = [](const Expression&, ConstExpressions x, ConstExpressions) {
    const Expression &a = x[0], &b = x[1];
    return std::vector<Expression>{std::log10(abs(a) + 1.0),
                                   sign(a - b),
                                   floor(a),
                                   modulo(a, b),
                                   a<b, a <= b, a> 2,
                                   0.5 >= a,
                                   a && b,
                                   a || b,
                                   !(a > b)};
  };
  const double points[][2] = {{3.7, 1.5}, {-0.3, 0.8}, {0.2, -0.7}, {2.0, 2.0}};
  for (const auto& [a, b] : points) {
    const std::vector<double> found = values(formulas, 11, {a, b});
    const std::vector<double> expected = {std::log10(std::fabs(a) + 1.0),
                                          a > b   ? 1.0
                                          : a < b ? -1.0
                                                  : 0.0,
                                          std::floor(a),
                                          a - b * std::floor(a / b),
                                          a < b ? 1.0 : 0.0,
                                          a <= b ? 1.0 : 0.0,
                                          a > 2.0 ? 1.0 : 0.0,
                                          0.5 >= a ? 1.0 : 0.0,
                                          a > 0.0 && b > 0.0 ? 1.0 : 0.0,
                                          a > 0.0 || b > 0.0 ? 1.0 : 0.0,
                                          a > b ? 0.0 : 1.0};
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i << " at " << a;
  }
}

// The saw-tooth x' = 1 - 2 floor(2 t) ..., in the form of its period: x = t modulo 1 is x0 - floor, with x0' = 1.
TEST(RecordedFunctions, HaveTheDerivativesOfTheBranch) {
  const Formulas formulas = [](const Expression& t, ConstExpressions x, ConstExpressions) {
    return std::vector<Expression>{modulo(x[0], 2.0), floor(x[0]), sign(x[0]) * x[0], std::log10(x[0]),
                                   modulo(-3.0 * t, 1.0)};
  };
  const Point point = consistent(formulas, 5, {7.5, 0.0}, 0.1, 1.5);
  const double expected[] = {1.5, 0.0, 1.5, 1.5 / (7.5 * std::log(10.0)), -3.0};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(point.xdot[i + 2], expected[i], 1e-12) << i;
}

TEST(StdFunctions, OfExpressionsAreRecorded) {
  const Formulas formulas = [](const Expression&, ConstExpressions x, ConstExpressions) {
    return std::vector<Expression>{std::sin(x[0]) + std::pow(x[0], 2) + std::pow(2, x[1]) + std::atan2(x[0], 2.0) +
                                   std::abs(x[1]) + std::sqrt(x[0]) + std::floor(x[0])};
  };
  const double x = 1.25, y = -0.5;
  EXPECT_NEAR(values(formulas, 1, {x, y})[0],
              std::sin(x) + x * x + std::pow(2, y) + std::atan2(x, 2.0) + 0.5 + std::sqrt(x) + 1.0, 1e-12);
}

}  // namespace
}  // namespace sfdae::test
