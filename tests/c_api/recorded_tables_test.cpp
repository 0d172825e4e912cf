// Tables in recorded equations: splines through data.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "recorded_formulas.h"

namespace sfdae::test {
namespace {

const std::vector<double> uneven = {-1.0, -0.4, 0.0, 0.3, 1.0, 1.2, 2.0, 2.5, 3.1, 4.0};

std::vector<double> sampled(const std::vector<double>& x, const std::function<double(double)>& f) {
  std::vector<double> y;
  for (double at : x) y.push_back(f(at));
  return y;
}

// Polynomials of the degree are reproduced, with their derivatives: here d/dt at x0 = a, x0' = 1.
TEST(Tables, ReproducePolynomialsOfTheirDegree) {
  for (int degree : {1, 3, 5, 7}) {
    const auto f = [&](double x) { return std::pow(0.5 * x - 1.0, degree) + x; };
    const auto slope = [&](double x) { return 0.5 * degree * std::pow(0.5 * x - 1.0, degree - 1) + 1.0; };
    const Formulas formulas = [&](const Expression&, ConstExpressions x, ConstExpressions) {
      return std::vector<Expression>{table(x[0], degree, uneven, sampled(uneven, f))};
    };
    for (double a : {-1.0, -0.7, 0.0, 0.2999, 1.1, 3.3, 4.0}) {
      const Point point = consistent(formulas, 1, {a, 0.0}, 0.0, 1.0);
      // Divided differences of the degree amplify rounding errors of the data.
      const double rounding = eps * std::pow(30.0, degree) * 10.0;
      EXPECT_NEAR(point.x[2], f(a), std::min(rounding, 1e-8)) << degree << " at " << a;
      if (a > -1.0 && a < 4.0) {
        EXPECT_NEAR(point.xdot[2], slope(a), std::min(30.0 * rounding, 1e-6)) << degree << " at " << a;
      }
    }
  }
}

// Of order degree + 1: the error of sin falls by about 2^(degree + 1) where points are twice as dense.
TEST(Tables, ConvergeWithTheirOrder) {
  for (int degree : {1, 3, 5, 7}) {
    double errors[2];
    for (int refined : {0, 1}) {
      std::vector<double> x;
      for (int i = 0; i <= 24 * (1 + refined); ++i) x.push_back(0.25 * i / (1 + refined));
      const std::vector<double> y = sampled(x, [](double at) { return std::sin(at); });
      double& error = errors[refined] = 0.0;
      for (double at = 2.0; at < 4.0; at += 0.01)
        error = std::max(error, std::fabs(number(table(at, degree, x, y).c()) - std::sin(at)));
    }
    EXPECT_GT(errors[0] / errors[1], 0.6 * std::pow(2.0, degree + 1)) << degree;
  }
}

TEST(Tables, PassThroughTheirData) {
  std::vector<double> y;
  for (std::size_t i = 0; i < uneven.size(); ++i) y.push_back(i % 2 == 0 ? 1.0 : -2.0);
  for (int degree : {1, 3, 5, 7})
    for (std::size_t i = 0; i < y.size(); ++i)
      EXPECT_NEAR(number(table(uneven[i], degree, uneven, y).c()), y[i], 1e-9) << degree;
}

TEST(Tables, RefuseBadData) {
  const auto refuses = [](int degree, const std::vector<double>& x, const std::vector<double>& y, const char* words) {
    const std::string text = complaint([&](const Expression&, ConstExpressions unknown, ConstExpressions) {
      return std::vector<Expression>{table(unknown[0], degree, x, y)};
    });
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_TRUE(std::isnan(table(1.0, degree, x, y).c().value)) << words;
  };
  refuses(2, {0, 1, 2, 3}, {0, 1, 2, 3}, "degree 2: it has to be 1, 3, 5 or 7");
  refuses(9, uneven, uneven, "degree 9");
  refuses(3, {0, 1, 2}, {0, 1, 2}, "3 points are too few: degree 3 needs at least 4");
  refuses(1, {}, {}, "0 points are too few");
  refuses(1, {0, 2, 1}, {0, 1, 2}, "x[2] = 1 does not lie after x[1] = 2");
  refuses(1, {0, 1, 1}, {0, 1, 2}, "x[2] = 1 does not lie after x[1] = 1");
  refuses(1, {0, 1}, {0, nan_value}, "point 1 is (1, nan), which is not finite");
  refuses(1, {0, INFINITY}, {0, 1}, "not finite");
  refuses(1, {0, 1}, {0, 1, 2}, "x or y is NULL");
  refuses(7, {0, 1e-200, 1, 2, 3, 4, 5, 6}, {0, 1, 0, 1, 0, 1, 0, 1}, "too unevenly");
}

TEST(Tables, HaveNoValueOutsideOfTheirData) {
  const Formulas formulas = [](const Expression&, ConstExpressions x, ConstExpressions) {
    return std::vector<Expression>{table(x[0], 1, {0, 1, 2}, {0, 1, 0})};
  };
  try {
    values(formulas, 1, {2.5, 0.0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NOT_FINITE);
    EXPECT_NE(std::string(error.what()).find("table at 2.5, outside of its data from 0 to 2"), std::string::npos)
        << error.what();
  }
  const Formulas held = [](const Expression&, ConstExpressions x, ConstExpressions) {
    return std::vector<Expression>{table(min(max(x[0], 0.0), 2.0), 1, {0, 1, 2}, {0.5, 1, 0.25})};
  };
  EXPECT_EQ(values(held, 1, {2.5, 0.0})[0], 0.25);
  EXPECT_EQ(values(held, 1, {-1.0, 0.0})[0], 0.5);
}

// x' = table(argument(t)), a polygon with kinks and a narrow pulse: the integral is known, piece by piece.
struct Pulse {
  std::vector<double> x = {0.0, 3.0, 3.05, 3.1, 7.0, 10.0}, y = {0.0, 0.0, 20.0, 0.0, 0.0, 6.0};
  double integral(double t) const {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      if (t <= x[i]) break;
      const double end = std::min(t, x[i + 1]), slope = (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
      sum += (end - x[i]) * (y[i] + 0.5 * slope * (end - x[i]));
    }
    return sum;
  }
};

// A pulse of width 0.1 is not stepped over, however long the steps before are; and steps go on to the end of the data.
TEST(Tables, OfTimeEndStepsAtTheirKinks) {
  const Pulse pulse;
  const std::function<Expression(const Expression&)> arguments[] = {
      [](const Expression& t) { return t; },
      [](const Expression& t) { return 5.0 - 0.5 * (10.0 - 2.0 * t); },
      [](const Expression& t) { return min(max(t, 0.0), 10.0); },
      [](const Expression& t) { return modulo(t, 20.0); },
      [](const Expression& t) { return t * parameter(t, "one", 1.0); },
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const auto& argument : arguments) {
      NonlinearProblem problem(2, 2);
      problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - table(argument(t), 1, pulse.x, pulse.y);
        F[1] = xdot[1] + x[1] * x[1] * x[1];
      };
      Options options;
      options.method = method;
      options.rtol = options.atol = 1e-6;
      Solver solver(problem, options);
      Point point{0.0, {0.0, 0.1}, {}};
      solver.start(point, 10.0);
      for (double t : {2.0, 3.07, 6.0, 10.0}) {
        ASSERT_EQ(solver.advance(t, point), SFDAE_OK);
        EXPECT_NEAR(point.x[0], pulse.integral(t), 2e-5 * (1.0 + pulse.integral(t))) << t;
      }
    }
}

// Backward, too, and through many periods.
TEST(Tables, OfPeriodicInputsKeepTheirAccuracy) {
  NonlinearProblem problem(1, 1);
  problem.equations = [&](const Expression& t, ConstExpressions, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - table(modulo(t, 2.0), 1, {0.0, 0.9, 1.0, 1.1, 2.0}, {0.0, 0.0, 10.0, 0.0, 0.0});
  };
  for (double end : {20.0, -20.0}) {
    Options options;
    options.method = SFDAE_METHOD_RADAU;
    Solver solver(problem, options);
    Point point{0.0, {0.0}, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[0], std::copysign(10.0, end), 1e-4);
  }
}

}  // namespace
}  // namespace sfdae::test
