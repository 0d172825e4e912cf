// SPDX-License-Identifier: BSD-3-Clause
//
// Functions with jumps, comparisons, derivatives, tables and functions of the user's in recorded equations; mistakes.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace {

using sfdae::ConstExpressions;
using sfdae::ConstVectorRef;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae::VectorRef;

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// Formulas in x0, x1 are the unknowns x2, ... of  x0' = 0, x1' = 0, x_(2+i) = formula_i(t, x0, x1), so that consistent
// values are values of formulas, and x' their total derivatives along time.
using Formulas =
    std::function<std::vector<Expression>(const Expression& t, ConstExpressions x, ConstExpressions xdot)>;

sfdae::NonlinearProblem problem_of(const Formulas& formulas, int count, double rate0 = 0.0) {
  sfdae::NonlinearProblem problem(count + 2, count + 2);
  problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - rate0;
    F[1] = xdot[1];
    const std::vector<Expression> values = formulas(t, x, xdot);
    for (int i = 0; i < count; ++i) F[i + 2] = x[i + 2] - values[static_cast<std::size_t>(i)];
  };
  return problem;
}

sfdae::Point consistent(const Formulas& formulas, int count, std::array<double, 2> x, double t = 0.0,
                        double rate0 = 0.0) {
  sfdae::Options options;
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed.assign(static_cast<std::size_t>(count + 2), 0);
  options.fixed[0] = options.fixed[1] = 1;
  sfdae::Solver solver(problem_of(formulas, count, rate0), options);
  sfdae::Point point{t, std::vector<double>(static_cast<std::size_t>(count + 2), 0.0), {}};
  point.x[0] = x[0], point.x[1] = x[1];
  solver.start(point, t + 1.0);
  return point;
}

std::vector<double> values(const Formulas& formulas, int count, std::array<double, 2> x, double t = 0.0) {
  const sfdae::Point point = consistent(formulas, count, x, t);
  return {point.x.begin() + 2, point.x.end()};
}

std::string complaint(const Formulas& formulas) { return sfdae::Solver::check(problem_of(formulas, 1)); }

double number(const sfdae_expression& e) {
  EXPECT_EQ(e.record, nullptr);
  return e.value;
}

// ---- Functions ---------------------------------------------------------------------------------------------------

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
  const sfdae::Point point = consistent(formulas, 5, {7.5, 0.0}, 0.1, 1.5);
  const double expected[] = {1.5, 0.0, 1.5, 1.5 / (7.5 * std::log(10.0)), -3.0};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(point.xdot[i + 2], expected[i], 1e-12) << i;
}

// ---- Derivatives -------------------------------------------------------------------------------------------------

// G^T lambda without G: the pendulum q'' = -G^T lambda - g e_2, written with the derivative of lambda g(q).
TEST(RecordedDerivatives, ReplaceTheJacobianOfConstraints) {
  const auto pendulum = [](bool by_hand) {
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression length = sfdae::parameter(t, "L", 1.0);
      const Expression g = x[0] * x[0] + x[1] * x[1] - length * length, potential = x[4] * g;
      for (int j = 0; j < 2; ++j) {
        const Expression force = by_hand ? 2.0 * x[4] * x[j] : derivative(potential, x[j]);
        F[j] = xdot[j] - x[j + 2];
        F[j + 2] = xdot[j + 2] + force + (j == 1 ? 9.81 : 0.0);
      }
      F[4] = g;
    };
    sfdae::Options options;
    options.rtol = options.atol = 1e-9;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
    solver.start(point, 2.0);
    solver.advance(2.0, point);
    EXPECT_EQ(solver.characteristics().strangeness_index, 2);
    return point.x;
  };
  const std::vector<double> derived = pendulum(false), written = pendulum(true);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(derived[i], written[i], 1e-7 * (1.0 + std::fabs(written[i])));
}

TEST(RecordedDerivatives, AreByEachKindOfVariable) {
  const Formulas formulas = [](const Expression& t, ConstExpressions x, ConstExpressions xdot) {
    const Expression p = sfdae::parameter(t, "p", 1.7);
    const Expression a = pow(x[0], p) * sin(t * x[1]) + xdot[0] * x[1];
    // Asked for in turn with another formula, and by what appears nowhere.
    const Expression other = derivative(x[0] * x[1], x[0]);
    return std::vector<Expression>{
        derivative(a, x[0]), derivative(a, x[1]),       derivative(a, t),      derivative(a, p), other,
        derivative(a, x[2]), sfdae::derivative(2.0, t), derivative(a, xdot[0])};
  };
  const double x = 1.3, y = 0.4, t = 0.6, p = 1.7;
  const std::vector<double> found = values(formulas, 8, {x, y}, t);
  const double expected[] = {p * std::pow(x, p - 1) * std::sin(t * y),
                             std::pow(x, p) * t * std::cos(t * y),
                             std::pow(x, p) * y * std::cos(t * y),
                             std::log(x) * std::pow(x, p) * std::sin(t * y),
                             y,
                             0.0,
                             0.0,
                             y};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
}

// d/dt (t x0 sin x1) along x0' = 1.5, x1' = 0, and twice.
TEST(RecordedDerivatives, AlongTimeContainXdot) {
  const Formulas formulas = [](const Expression& t, ConstExpressions x, ConstExpressions) {
    const Expression a = t * x[0] * sin(x[1]);
    return std::vector<Expression>{time_derivative(a), sfdae::time_derivative(3.0),
                                   derivative(time_derivative(a), x[1])};
  };
  const sfdae::Point point = consistent(formulas, 3, {2.0, 0.5}, 0.7, 1.5);
  EXPECT_NEAR(point.x[2], (2.0 + 0.7 * 1.5) * std::sin(0.5), 1e-12);
  EXPECT_NEAR(point.x[3], 0.0, 1e-12);
  EXPECT_NEAR(point.x[4], (2.0 + 0.7 * 1.5) * std::cos(0.5), 1e-12);
}

TEST(RecordedDerivatives, RefuseWhatIsNoVariable) {
  const auto refuses = [](const std::function<Expression(const Expression&, ConstExpressions, ConstExpressions)>& f,
                          const char* words) {
    const std::string text = complaint([&](const Expression& t, ConstExpressions x, ConstExpressions xdot) {
      return std::vector<Expression>{f(t, x, xdot)};
    });
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  refuses([](auto, auto x, auto) { return derivative(x[0], x[0] * x[1]); }, "the variable is a formula");
  refuses([](auto, auto x, auto) { return derivative(x[0], 2.0); }, "the variable is a plain number");
  refuses([](auto, auto x, auto xdot) { return time_derivative(x[0] * xdot[0]); }, "x'' would be needed");
  EXPECT_TRUE(std::isnan(sfdae_derivative(sfdae_number(1.0), sfdae_number(1.0)).value));
  sfdae::MultibodyProblem body(1);
  body.equations = [](const auto&, auto q, auto, auto to) { to.f[0] = time_derivative(q[0]); };
  EXPECT_NE(sfdae::Solver::check(body).find("mechanical systems"), std::string::npos);
}

// Forces of a potential in a mechanical system: f = -V_q.
TEST(RecordedDerivatives, ServeMechanicalSystems) {
  sfdae::MultibodyProblem problem(2);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    const Expression V = 0.5 * (4.0 * q[0] * q[0] + 9.0 * q[1] * q[1]);
    for (int i = 0; i < 2; ++i) to.M(i, i) = 1.0, to.f[i] = -derivative(V, q[i]);
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, {1.0, 1.0, 0.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_NEAR(point.x[0], std::cos(2.0), 1e-6);
  EXPECT_NEAR(point.x[1], std::cos(3.0), 1e-6);
}

// ---- Tables ------------------------------------------------------------------------------------------------------

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
      return std::vector<Expression>{sfdae::table(x[0], degree, uneven, sampled(uneven, f))};
    };
    for (double a : {-1.0, -0.7, 0.0, 0.2999, 1.1, 3.3, 4.0}) {
      const sfdae::Point point = consistent(formulas, 1, {a, 0.0}, 0.0, 1.0);
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
        error = std::max(error, std::fabs(number(sfdae::table(at, degree, x, y).c()) - std::sin(at)));
    }
    EXPECT_GT(errors[0] / errors[1], 0.6 * std::pow(2.0, degree + 1)) << degree;
  }
}

TEST(Tables, PassThroughTheirData) {
  std::vector<double> y;
  for (std::size_t i = 0; i < uneven.size(); ++i) y.push_back(i % 2 == 0 ? 1.0 : -2.0);
  for (int degree : {1, 3, 5, 7})
    for (std::size_t i = 0; i < y.size(); ++i)
      EXPECT_NEAR(number(sfdae::table(uneven[i], degree, uneven, y).c()), y[i], 1e-9) << degree;
}

TEST(Tables, RefuseBadData) {
  const auto refuses = [](int degree, const std::vector<double>& x, const std::vector<double>& y, const char* words) {
    const std::string text = complaint([&](const Expression&, ConstExpressions unknown, ConstExpressions) {
      return std::vector<Expression>{sfdae::table(unknown[0], degree, x, y)};
    });
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_TRUE(std::isnan(sfdae::table(1.0, degree, x, y).c().value)) << words;
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
    return std::vector<Expression>{sfdae::table(x[0], 1, {0, 1, 2}, {0, 1, 0})};
  };
  try {
    values(formulas, 1, {2.5, 0.0});
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NOT_FINITE);
    EXPECT_NE(std::string(error.what()).find("table at 2.5, outside of its data from 0 to 2"), std::string::npos)
        << error.what();
  }
  const Formulas held = [](const Expression&, ConstExpressions x, ConstExpressions) {
    return std::vector<Expression>{sfdae::table(min(max(x[0], 0.0), 2.0), 1, {0, 1, 2}, {0.5, 1, 0.25})};
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
      [](const Expression& t) { return t * sfdae::parameter(t, "one", 1.0); },
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const auto& argument : arguments) {
      sfdae::NonlinearProblem problem(2, 2);
      problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - sfdae::table(argument(t), 1, pulse.x, pulse.y);
        F[1] = xdot[1] + x[1] * x[1] * x[1];
      };
      sfdae::Options options;
      options.method = method;
      options.rtol = options.atol = 1e-6;
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, {0.0, 0.1}, {}};
      solver.start(point, 10.0);
      for (double t : {2.0, 3.07, 6.0, 10.0}) {
        ASSERT_EQ(solver.advance(t, point), SFDAE_OK);
        EXPECT_NEAR(point.x[0], pulse.integral(t), 2e-5 * (1.0 + pulse.integral(t))) << t;
      }
    }
}

// Backward, too, and through many periods.
TEST(Tables, OfPeriodicInputsKeepTheirAccuracy) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [&](const Expression& t, ConstExpressions, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - sfdae::table(modulo(t, 2.0), 1, {0.0, 0.9, 1.0, 1.1, 2.0}, {0.0, 0.0, 10.0, 0.0, 0.0});
  };
  for (double end : {20.0, -20.0}) {
    sfdae::Options options;
    options.method = SFDAE_METHOD_RADAU;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {0.0}, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[0], std::copysign(10.0, end), 1e-4);
  }
}

// ---- Functions of the user's ----------------------------------------------------------------------------------------

// f(a, b) = exp(a) sin(b): derivatives of every order by hand.
int exp_sin(int order, ConstVectorRef a, VectorRef derivatives) {
  for (int place = 0; place < derivatives.size(); ++place) {
    int by_b = 0;
    for (int k = 0, rest = place; k < order; ++k, rest /= 2) by_b += rest % 2;
    const double turned[] = {std::sin(a[1]), std::cos(a[1]), -std::sin(a[1]), -std::cos(a[1])};
    derivatives[place] = std::exp(a[0]) * turned[by_b % 4];
  }
  return 0;
}

// Index 3: the constraint is differentiated twice, through the function.
TEST(ExternalFunctions, AreWhatTheFormulasAre) {
  const sfdae::ExternalFunction f("exp_sin", 2, exp_sin);
  const auto solve = [&](bool is_external, int method) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression a = 0.3 * x[0] + 0.1 * t, b = 0.5 * x[0] + 0.2;
      const Expression value = is_external ? f(a, b) : exp(a) * sin(b);
      const Expression slope = derivative(value, x[0]);
      F[0] = xdot[0] - x[1] - 0.01 * slope;
      F[1] = xdot[1] - x[2];
      F[2] = x[0] + 0.2 * value - sin(t) - 1.0;
    };
    sfdae::Options options;
    options.method = method;
    options.rtol = options.atol = 1e-8;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {0.8, 0.9, 0.0}, {}};
    solver.start(point, 1.0);
    solver.advance(1.0, point);
    point.x.push_back(solver.characteristics().strangeness_index);
    return point.x;
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const std::vector<double> external = solve(true, method), written = solve(false, method);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(external[i], written[i], 1e-6) << i;
  }
}

TEST(ExternalFunctions, SayWhatTheyCannotDo) {
  struct Case {
    int order, code, status;
    const char* words;
  };
  // Values need orders 0 and 1 at a point, index 0; all are refused from `order` on.
  const Case cases[] = {{0, 3, SFDAE_CALLBACK_FAILED, "cube(2) returned 3"},
                        {0, -1, SFDAE_CALLBACK_STOPPED, "cube(2) returned -1"},
                        {1, SFDAE_ORDER_NOT_AVAILABLE, SFDAE_ORDER_MISSING, "cube has no derivatives of order 1"},
                        {1, -7, SFDAE_CALLBACK_STOPPED, "returned -7 for its derivatives of order 1"}};
  for (const Case& c : cases) {
    const sfdae::ExternalFunction cube("cube", 1, [&](int order, ConstVectorRef a, VectorRef derivatives) {
      if (order >= c.order) return c.code;
      derivatives[0] = a[0] * a[0] * a[0];
      return 0;
    });
    const Formulas formulas = [&](const Expression&, ConstExpressions x, ConstExpressions) {
      return std::vector<Expression>{cube(x[0])};
    };
    try {
      values(formulas, 1, {2.0, 0.0});
      ADD_FAILURE() << c.words;
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), c.status) << error.what();
      EXPECT_NE(std::string(error.what()).find(c.words), std::string::npos) << error.what();
    }
  }
}

TEST(ExternalFunctions, RefuseMistakes) {
  const auto refuses = [](const std::function<sfdae_expression(const sfdae_expression&)>& f, const char* words) {
    const std::string text = complaint([&](const Expression&, ConstExpressions x, ConstExpressions) {
      return std::vector<Expression>{f(x[0].c())};
    });
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  const sfdae_external_function one = [](int order, const double*, double* value, void*) {
    value[0] = order == 0 ? 1.0 : 0.0;
    return 0;
  };
  refuses([&](const auto& x) { return sfdae_external(nullptr, one, 1, &x, nullptr); }, "a function needs a name");
  refuses([&](const auto& x) { return sfdae_external("", one, 1, &x, nullptr); }, "a function needs a name");
  refuses([&](const auto& x) { return sfdae_external("f", nullptr, 1, &x, nullptr); }, "f is NULL");
  refuses([&](const auto& x) { return sfdae_external("f", one, 0, &x, nullptr); }, "not finite");
  refuses([&](const auto&) { return sfdae_external("f", one, 1, nullptr, nullptr); }, "not finite");
  const sfdae_expression two = sfdae_number(2.0);
  EXPECT_EQ(number(sfdae_external("f", one, 1, &two, nullptr)), 1.0);
  const sfdae::ExternalFunction f("exp_sin", 2, exp_sin);
  EXPECT_THROW(f(Expression(1.0)), sfdae::Error);
  EXPECT_EQ(number(f(1.0, 0.5).c()), std::exp(1.0) * std::sin(0.5));
}

// ---- Views -------------------------------------------------------------------------------------------------------

template <class Problem>
std::string error_of(const Problem& problem) {
  try {
    sfdae::Solver solver(problem);
    return "";
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_EQ(sfdae::Solver::check(problem), error.what());
    return error.what();
  }
}

TEST(Views, NameTheEntryThatDoesNotExist) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions, Expressions F) { F[5] = x[0]; };
  EXPECT_EQ(error_of(problem), "F[5] does not exist: F has 5 entries, counted from 0");
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions, Expressions F) { F[0] = x[-1]; };
  EXPECT_EQ(error_of(problem), "x[-1] does not exist: x has 5 entries, counted from 0");
  sfdae::NonlinearProblem linear(2, 3);
  linear.linear_equations = [](const Expression&, auto E, auto, auto) { E(2, 0) = 1.0; };
  EXPECT_EQ(error_of(linear), "E(2, 0) does not exist: E is 2 x 3, counted from 0");
  sfdae::MultibodyProblem body(2, 1);
  body.equations = [](const auto&, auto q, auto, auto to) { to.g[1] = q[0]; };
  EXPECT_EQ(error_of(body), "g[1] does not exist: g has 1 entries, counted from 0");
}

TEST(Views, OfCallbacksAreChecked) {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double, int, sfdae::MatrixRef E) { E(0, 2) = 1.0; };
  problem.A = [](double, int, sfdae::MatrixRef) {};
  sfdae::Solver solver(problem);
  try {
    solver.analyze(0.0, 1.0);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_STREQ(error.what(), "E(0, 2) does not exist: E is 2 x 2, counted from 0");
  }
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
