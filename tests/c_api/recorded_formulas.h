// Formulas recorded, and their values and derivatives along time, by consistent values.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace sfdae::test {

inline constexpr double eps = std::numeric_limits<double>::epsilon();
inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// Formulas in x0, x1 are the unknowns x2, ... of  x0' = 0, x1' = 0, x_(2+i) = formula_i(t, x0, x1), so that consistent
// values are values of formulas, and x' their total derivatives along time.
using Formulas =
    std::function<std::vector<Expression>(const Expression& t, ConstExpressions x, ConstExpressions xdot)>;

inline NonlinearProblem problem_of(const Formulas& formulas, int count, double rate0 = 0.0) {
  NonlinearProblem problem(count + 2, count + 2);
  problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - rate0;
    F[1] = xdot[1];
    const std::vector<Expression> values = formulas(t, x, xdot);
    for (int i = 0; i < count; ++i) F[i + 2] = x[i + 2] - values[static_cast<std::size_t>(i)];
  };
  return problem;
}

inline Point consistent(const Formulas& formulas, int count, std::array<double, 2> x, double t = 0.0,
                        double rate0 = 0.0) {
  Options options;
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed.assign(static_cast<std::size_t>(count + 2), 0);
  options.fixed[0] = options.fixed[1] = 1;
  Solver solver(problem_of(formulas, count, rate0), options);
  Point point{t, std::vector<double>(static_cast<std::size_t>(count + 2), 0.0), {}};
  point.x[0] = x[0], point.x[1] = x[1];
  solver.start(point, t + 1.0);
  return point;
}

inline std::vector<double> values(const Formulas& formulas, int count, std::array<double, 2> x, double t = 0.0) {
  const Point point = consistent(formulas, count, x, t);
  return {point.x.begin() + 2, point.x.end()};
}

inline std::string complaint(const Formulas& formulas) { return Solver::check(problem_of(formulas, 1)); }

inline double number(const sfdae_expression& e) {
  EXPECT_EQ(e.record, nullptr);
  return e.value;
}

}  // namespace sfdae::test
