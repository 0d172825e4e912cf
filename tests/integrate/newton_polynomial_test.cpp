// SPDX-License-Identifier: BSD-3-Clause
// Taylor coefficients of Newton's polynomial are those of the polynomial interpolated.
#include "integrate/newton_polynomial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"

namespace sfdae::core {

namespace {

using sfdae_test::Jet;
using sfdae_test::rounding;
using sfdae_test::size;

// sum_k coefficients[k] t^k, along a jet.
Jet polynomial(const std::vector<double>& coefficients, const Jet& t) {
  Jet sum = Jet::zero(t.order());
  for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * t + Jet(coefficients[k]);
  return sum;
}

// Divided differences of a function given by its values at the times, one vector of values for each.
std::vector<std::vector<double>> differences_of(std::vector<std::vector<double>> values,
                                                const std::vector<double>& times) {
  for (std::size_t level = 1; level < times.size(); ++level)
    for (std::size_t i = times.size() - 1; i >= level; --i)
      for (std::size_t r = 0; r < values[i].size(); ++r)
        values[i][r] = (values[i][r] - values[i - 1][r]) / (times[i] - times[i - level]);
  return values;
}

}  // namespace

// Three polynomials of the degree at once, from their values at unevenly spaced times, of either direction.
TEST(NewtonPolynomial, HasTheTaylorCoefficientsOfThePolynomial) {
  for (double direction : {1.0, -1.0})
    for (int degree = 0; degree <= 6; ++degree)
      for (int order = 0; order <= 9; ++order)
        for (double t : {-0.4, 0.0, 0.31, 1.7}) {
          std::vector<double> times;
          std::vector<std::vector<double>> coefficients, values;
          for (int r = 0; r < 3; ++r)
            coefficients.push_back(sfdae_test::random_vector(degree + 1, 11 + static_cast<unsigned>(r)));
          for (int i = 0; i <= degree; ++i) {
            times.push_back(direction * (0.3 - 0.2 * i - 0.05 * i * i));
            values.emplace_back();
            for (const auto& c : coefficients) values.back().push_back(polynomial(c, Jet(times.back()))[0]);
          }
          std::vector<double> taylor(3 * size(order + 1), 9.0);
          const auto table = differences_of(values, times);
          NewtonPolynomial(table, times, degree, 3).taylor(t, order, taylor.data());
          for (std::size_t r = 0; r < 3; ++r) {
            const Jet expected = polynomial(coefficients[r], Jet::variable(t, order));
            // Divided differences amplify rounding of values by the inverse distances, at least 0.2, once for each.
            const double tolerance = rounding(degree + 1) * std::pow(10.0, degree) * 10.0;
            for (int k = 0; k <= order; ++k)
              EXPECT_NEAR(taylor[r + 3 * size(k)], expected[k], k > degree ? 0.0 : tolerance)
                  << "degree " << degree << ", t = " << t << ", k = " << k;
          }
        }
}

// x^3 - x through two nodes with slopes, and through four values: value and slope anywhere are those of the polynomial.
TEST(NewtonPolynomial, IsThatOfItsDividedDifferences) {
  const auto value = [](double t) { return t * t * t - t; };
  const auto slope = [](double t) { return 3.0 * t * t - 1.0; };
  const auto expect_cubic = [&](const std::vector<std::vector<double>>& table, const std::vector<double>& times) {
    for (double t : {-1.0, 0.2, 3.0}) {
      double p = 9.0, pdot = 9.0;
      NewtonPolynomial(table, times, 3, 1).evaluate(t, &p, &pdot);
      EXPECT_NEAR(p, value(t), rounding(4) * 100.0);
      EXPECT_NEAR(pdot, slope(t), rounding(4) * 100.0);
    }
  };
  std::vector<double> times = {0.5, 0.5, -0.75, -0.75};
  std::vector<std::vector<double>> table = {{value(0.5)}, {slope(0.5)}, {value(-0.75)}, {slope(-0.75)}};
  const auto column = [&table](int i) { return table[size(i)].data(); };
  hermite_differences(times, 4, 1, column);
  expect_cubic(table, times);

  times = {0.5, 1.5, 2.0, -0.75};
  table = {{value(0.5)}, {value(1.5)}, {value(2.0)}, {value(-0.75)}};
  std::vector<std::vector<double>> of_history = table;
  differences_of_history(times, table, 4, of_history);
  expect_cubic(of_history, times);
  divided_differences(times, 4, 1, column);
  expect_cubic(table, times);
}

// Columns of a table that has more of them than the degree needs are not looked at, times after them neither.
TEST(NewtonPolynomial, ReadsNoMoreOfTheTableThanItsDegree) {
  const std::vector<std::vector<double>> table = {{2.0}, {3.0}, {std::nan("")}};
  const std::vector<double> times = {1.0, std::nan("")};
  double taylor[3];
  NewtonPolynomial(table, times, 1, 1).taylor(5.0, 2, taylor);
  EXPECT_EQ(taylor[0], 2.0 + 3.0 * 4.0);
  EXPECT_EQ(taylor[1], 3.0);
  EXPECT_EQ(taylor[2], 0.0);
}

}  // namespace sfdae::core
