// SPDX-License-Identifier: BSD-3-Clause
//
// Nonlinear problems through the C++ interface.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

namespace {

using sfdae::ConstExpressions;
using sfdae::ConstMatrixRef;
using sfdae::Expression;
using sfdae::ExpressionMatrix;
using sfdae::Expressions;
using sfdae::MatrixRef;
using sfdae::TotalDerivatives;
using sfdae::VectorRef;

static_assert(std::is_copy_constructible_v<sfdae::NonlinearProblem>);
static_assert(!std::is_constructible_v<sfdae::EquationsFunction, void (*)(double)>);

// x2' = x1,  0 = x1^2 + x2^2 - r^2        mu = 0, d = 1, a = 1;  x = r (cos t, sin t)
template <class Number, class View, class Result>
void circle(const Number& r, View x, View xdot, Result F) {
  F[0] = xdot[1] - x[0];
  F[1] = pow(x[0], 2) + x[1] * x[1] - r * r;
}

sfdae::NonlinearProblem circle_problem() {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    circle(sfdae::parameter(t, "r", 1.0), x, xdot, F);
  };
  return problem;
}

// Within 10 times the default tolerances.
void expect_on_circle(const sfdae::Point& point, double r) {
  ASSERT_EQ(point.x.size(), 2u);
  EXPECT_NEAR(point.x[0], r * std::cos(point.t), 2e-5 * r);
  EXPECT_NEAR(point.x[1], r * std::sin(point.t), 2e-5 * r);
  EXPECT_NEAR(std::hypot(point.x[0], point.x[1]), r, 1e-12 * r);
}

template <class Call>
int status_of(Call call) {
  try {
    return call();
  } catch (const sfdae::Error& error) {
    EXPECT_STRNE(error.what(), "");
    return error.status();
  }
}

struct Mishap : std::runtime_error {
  using std::runtime_error::runtime_error;
};

TEST(NonlinearProblem, IsSolvedFromRecordedEquations) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC}) {
    sfdae::Options options;
    options.method = method;
    sfdae::Solver solver(circle_problem(), options);
    sfdae::Point point{0.0, {1.1, 0.0}, {}};
    EXPECT_EQ(solver.analyze_at(point, 1.0), SFDAE_OK);
    EXPECT_EQ(solver.characteristics().differential, 1);
    EXPECT_EQ(solver.characteristics().algebraic, 1);
    point.x = {1.0, 0.0};
    EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
    EXPECT_NEAR(point.xdot[1], 1.0, 1e-12);
    for (double t : {0.2, 0.7, 1.0}) {
      EXPECT_EQ(solver.advance(t, point), SFDAE_OK);
      expect_on_circle(point, 1.0);
    }
    EXPECT_GT(solver.statistics().linearizations, 0);
  }
}

// x'^2 = 1 follows the slope guessed.
TEST(NonlinearProblem, FollowsAGuessOfTheSlope) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const Expression&, ConstExpressions, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] * xdot[0] - 1.0;
  };
  sfdae::Options options;
  options.xdot_is_guess = 1;
  for (const double slope : {1.0, -1.0}) {
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {2.0}, {0.5 * slope}};
    EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
    EXPECT_NEAR(point.xdot[0], slope, 1e-14);
    EXPECT_EQ(solver.advance(1.0, point), SFDAE_OK);
    EXPECT_NEAR(point.x[0], 2.0 + slope, 1e-5);
  }
}

TEST(NonlinearProblem, HasParametersWithNames) {
  sfdae::Solver solver(circle_problem());
  EXPECT_EQ(solver.parameter("r"), 1.0);
  EXPECT_EQ(solver.set_parameter("r", 3.0), SFDAE_OK);
  EXPECT_EQ(solver.parameter("r"), 3.0);
  sfdae::Point point{0.0, {3.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  expect_on_circle(point, 3.0);
  EXPECT_EQ(status_of([&] { return solver.set_parameter("q", 1.0); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of([&] { return static_cast<int>(solver.parameter("q")); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(solver.message().find("\"q\""), std::string::npos);
  EXPECT_EQ(status_of([&] { return solver.set_parameter("r", std::nan("")); }), SFDAE_ILLEGAL_ARGUMENT);
}

// The circle with derivatives written by hand: F2^(k) = sum C(k, i) (x1^(i) x1^(k-i) + x2^(i) x2^(k-i)) - [k = 0].
void circle_derivatives(double, int k, ConstMatrixRef x, TotalDerivatives out) {
  out.F[0] = x(1, k + 1) - x(0, k);
  out.F[1] = k == 0 ? -1 : 0;
  double binomial = 1;
  for (int i = 0; i <= k; ++i) {
    out.F[1] += binomial * (x(0, i) * x(0, k - i) + x(1, i) * x(1, k - i));
    binomial *= static_cast<double>(k - i) / (i + 1);
  }
  if (out.F_x) {
    out.F_x(0, 0) = k == 0 ? -1 : 0;
    out.F_x(1, 0) = 2 * x(0, k), out.F_x(1, 1) = 2 * x(1, k);
  }
  if (out.F_xdot) out.F_xdot(0, 1) = k == 0;
}

TEST(NonlinearProblem, TakesTotalDerivativesOfTheUser) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.total_derivative = circle_derivatives;
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  expect_on_circle(point, 1.0);
  sfdae::Matrix jet(2, 4);
  for (int k = 0; k < 4; ++k) jet(0, k) = 0.3 + k, jet(1, k) = 0.7 - 0.2 * k;
  EXPECT_EQ(solver.check_total_derivatives(0.5, jet).suspicious, 0);
  EXPECT_EQ(status_of([&] { return solver.check_total_derivatives(0.5, sfdae::Matrix(3, 4)).suspicious; }),
            SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of([&] { return solver.check_total_derivatives(0.5, sfdae::Matrix(2, 1)).suspicious; }),
            SFDAE_ILLEGAL_ARGUMENT);

  problem.total_derivative = [](double t, int k, ConstMatrixRef x, TotalDerivatives out) {
    circle_derivatives(t, k, x, out);
    if (k == 1) out.F[1] *= 1.001;
  };
  sfdae::Solver wrong(problem);
  const sfdae::DerivativeCheck found = wrong.check_total_derivatives(0.5, jet);
  EXPECT_EQ(found.suspicious, 1);
  EXPECT_EQ(found.function, 'F');
  EXPECT_EQ(found.row, 1);
  EXPECT_NE(wrong.message(), "");
}

// The array of the circle: partial derivatives of the terms of F2^(k).
void circle_array(double, int order, ConstMatrixRef x, sfdae::ArrayValues out) {
  out.F[1] = -1;
  for (int k = 0; k <= order; ++k) {
    out.F[2 * k] = x(1, k + 1) - x(0, k);
    if (out.jacobian) out.jacobian(2 * k, 2 * k + 3) = 1, out.jacobian(2 * k, 2 * k) = -1;
    double binomial = 1;
    for (int i = 0; i <= k; ++i) {
      out.F[2 * k + 1] += binomial * (x(0, i) * x(0, k - i) + x(1, i) * x(1, k - i));
      for (int j = 0; out.jacobian && j < 2; ++j) out.jacobian(2 * k + 1, 2 * i + j) = 2 * binomial * x(j, k - i);
      binomial *= static_cast<double>(k - i) / (i + 1);
    }
  }
}

TEST(NonlinearProblem, TakesTheDerivativeArrayOfTheUser) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.derivative_array = circle_array;
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  expect_on_circle(point, 1.0);

  problem.derivative_array = [](double t, int order, ConstMatrixRef x, sfdae::ArrayValues out) {
    circle_array(t, order, x, out);
    EXPECT_EQ(out.jacobian.columns(), 2 * order + 4);
    EXPECT_EQ(out.jacobian.rows(), out.jacobian ? 2 * order + 2 : 0);
    if (out.jacobian && order == 1) out.jacobian(0, 4) = 0.25;
  };
  sfdae::Solver wrong(problem);
  EXPECT_EQ(status_of([&] { return wrong.start(point, 2.0); }), SFDAE_WRONG_DERIVATIVES);
  EXPECT_NE(wrong.message().find("row 0, column 4"), std::string::npos) << wrong.message();

  problem.derivative_array = [](double, int, ConstMatrixRef, sfdae::ArrayValues) { throw Mishap("no value"); };
  sfdae::Solver failing(problem);
  EXPECT_THROW(failing.start(point, 2.0), Mishap);
  problem.total_derivative = circle_derivatives;
  EXPECT_EQ(status_of([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_ILLEGAL_ARGUMENT);
}

// The force that moves a unit mass along sin t.
TEST(NonlinearProblem, LinearEquationsAreSolvedAsSuch) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.linear_equations = [](const Expression& t, ExpressionMatrix E, ExpressionMatrix A, Expressions f) {
    E(0, 0) = E(1, 1) = 1;
    A(0, 1) = A(1, 2) = A(2, 0) = 1;
    f[2] = -sin(t);
  };
  sfdae::Solver solver(problem);
  EXPECT_EQ(solver.analyze(0.0, 1.0), SFDAE_OK);
  EXPECT_EQ(solver.characteristics().strangeness_index, 2);
  sfdae::Point point{0.0, {0, 0, 0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_NEAR(point.x[2], -std::sin(1.0), 1e-13);
  EXPECT_EQ(solver.check_derivatives(0.5, 2).suspicious, 0);
  EXPECT_EQ(solver.projectors(0.5).T2.columns(), 0);
}

// x1' = x2 x1 with x2 = cos t prescribed: x1 = exp(sin t).
TEST(NonlinearProblem, PrescribesComponents) {
  sfdae::NonlinearProblem problem(1, 2);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[0] * x[1];
  };
  problem.prescribed = {1};
  problem.prescribed_values = [](double t, int, VectorRef values) { values[0] = std::cos(t); };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 1.0}, {}};
  solver.start(point, 2.0);
  EXPECT_EQ(solver.advance(2.0, point), SFDAE_OK);
  EXPECT_NEAR(point.x[0], std::exp(std::sin(2.0)), 10 * 4e-6);
  EXPECT_NEAR(point.x[1], std::cos(2.0), 1e-13);
}

TEST(NonlinearProblem, ExceptionsWhileRecordingAreThrownOnce) {
  sfdae::NonlinearProblem problem(2, 2);
  auto calls = std::make_shared<int>(0);
  problem.equations = [calls](const Expression&, ConstExpressions, ConstExpressions, Expressions) {
    ++*calls;
    throw Mishap("no formula");
  };
  EXPECT_THROW(sfdae::Solver{problem}, Mishap);
  EXPECT_EQ(*calls, 1);
  EXPECT_THROW(sfdae::Solver::check(problem), Mishap);
  problem.equations = nullptr;
  problem.linear_equations = [](const Expression&, ExpressionMatrix, ExpressionMatrix, Expressions) { throw 42; };
  EXPECT_THROW(sfdae::Solver{problem}, int);
}

TEST(NonlinearProblem, ExceptionsOfTotalDerivativesArePassedOnFromEveryCall) {
  for (int call = 0;; ++call) {
    auto countdown = std::make_shared<int>(call);
    sfdae::NonlinearProblem problem(2, 2);
    problem.total_derivative = [countdown](double t, int k, ConstMatrixRef x, TotalDerivatives out) {
      if ((*countdown)-- == 0) throw Mishap("no value");
      circle_derivatives(t, k, x, out);
    };
    sfdae::Solver solver(problem);
    bool thrown = false;
    try {
      sfdae::Point point{0.0, {1.0, 0.0}, {}};
      solver.start(point, 0.1);
      solver.advance(0.1, point);
    } catch (const Mishap&) {
      thrown = true;
    }
    *countdown = -1;
    sfdae::Point point{0.0, {1.0, 0.0}, {}};
    ASSERT_EQ(solver.start(point, 0.1), SFDAE_OK);
    ASSERT_EQ(solver.advance(0.1, point), SFDAE_OK);
    expect_on_circle(point, 1.0);
    if (!thrown) {
      EXPECT_GT(call, 3);
      break;
    }
  }
}

TEST(NonlinearProblem, MistakesAreNamed) {
  sfdae::NonlinearProblem problem(2, 2);
  EXPECT_EQ(status_of([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_ILLEGAL_ARGUMENT);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions, Expressions F) { F[0] = x[0]; };
  EXPECT_EQ(status_of([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(sfdae::Solver::check(problem).find("residual[1]"), std::string::npos);
  problem.equations = [](const Expression&, ConstExpressions, ConstExpressions, Expressions) { return 5; };
  EXPECT_EQ(status_of([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_CALLBACK_FAILED);
  EXPECT_EQ(sfdae::Solver::check(circle_problem()), "");

  sfdae::Solver solver(circle_problem());
  EXPECT_EQ(status_of([&] { return solver.analyze(0.0, 1.0); }), SFDAE_ILLEGAL_ARGUMENT);
  sfdae::Point point{0.0, {1.0}, {}};
  EXPECT_EQ(status_of([&] { return solver.analyze_at(point, 1.0); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of([&] { return solver.check_total_derivatives(0.0, sfdae::Matrix(2, 3)).order; }),
            SFDAE_ILLEGAL_ARGUMENT);
}

TEST(NonlinearProblem, SolversMoveAndKeepTheirFunctions) {
  auto kept = std::make_shared<int>(0);
  sfdae::NonlinearProblem problem(2, 2);
  problem.total_derivative = [kept](double t, int k, ConstMatrixRef x, TotalDerivatives out) {
    ++*kept;
    circle_derivatives(t, k, x, out);
  };
  std::vector<sfdae::Solver> solvers;
  solvers.emplace_back(std::move(problem));
  problem = sfdae::NonlinearProblem(1, 1);
  solvers.emplace_back(circle_problem());
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  solvers[0].start(point, 1.0);
  solvers[1] = std::move(solvers[0]);
  solvers[1].advance(1.0, point);
  expect_on_circle(point, 1.0);
  solvers.clear();
  EXPECT_EQ(kept.use_count(), 1);
}

// 0 = x1 - sin t, x2 = x1': the second equation need not be differentiated, but the first one must.
TEST(NonlinearProblem, DifferentiatesAsOftenAsItIsTold) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = x[0] - sin(t);
    F[1] = x[1] - xdot[0];
  };
  for (const bool enough : {true, false}) {
    problem.differentiations = {enough ? 1 : 0, 0};
    sfdae::Solver solver(problem);
    sfdae::Point point{0.5, {0.0, 0.0}, {}};
    if (!enough) {
      EXPECT_EQ(status_of([&] { return solver.start(point, 1.0), 0; }), SFDAE_INDEX_TOO_HIGH);
      continue;
    }
    solver.start(point, 1.0);
    solver.advance(1.0, point);
    EXPECT_NEAR(point.x[0], std::sin(1.0), 1e-14);
    EXPECT_NEAR(point.x[1], std::cos(1.0), 1e-13);
  }
  problem.differentiations = {1};
  EXPECT_EQ(status_of([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_ILLEGAL_ARGUMENT);
}

}  // namespace
