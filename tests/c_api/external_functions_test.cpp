// Functions of the user's in recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "exp_sin.h"
#include "recorded_formulas.h"

namespace sfdae::test {
namespace {

// Index 3: the constraint is differentiated twice, through the function.
TEST(ExternalFunctions, AreWhatTheFormulasAre) {
  const ExternalFunction f("exp_sin", 2, exp_sin);
  const auto solve = [&](bool is_external, int method) {
    NonlinearProblem problem(3, 3);
    problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression a = 0.3 * x[0] + 0.1 * t, b = 0.5 * x[0] + 0.2;
      const Expression value = is_external ? f(a, b) : exp(a) * sin(b);
      const Expression slope = derivative(value, x[0]);
      F[0] = xdot[0] - x[1] - 0.01 * slope;
      F[1] = xdot[1] - x[2];
      F[2] = x[0] + 0.2 * value - sin(t) - 1.0;
    };
    Options options;
    options.method = method;
    options.rtol = options.atol = 1e-8;
    Solver solver(problem, options);
    Point point{0.0, {0.8, 0.9, 0.0}, {}};
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

// An input that is a user-supplied function of t is judged by samples: it takes as many steps as the formula.
TEST(ExternalFunctions, OfTimeTakeAsManySteps) {
  const ExternalFunction f("exp_sin", 2, exp_sin);
  const auto count_steps = [&](bool is_external, int method) {
    NonlinearProblem problem(1, 1);
    problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression a = -0.1 * t, b = 3.0 * t;
      F[0] = xdot[0] + x[0] - (is_external ? f(a, b) : exp(a) * sin(b));
    };
    Options options;
    options.method = method;
    options.rtol = options.atol = 1e-6;
    options.max_steps = 20000;
    Solver solver(problem, options);
    Point point{0.0, {0.0}, {}};
    solver.start(point, 10.0);
    solver.advance(10.0, point);
    return solver.statistics().steps;
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    EXPECT_LE(count_steps(true, method), 1.5 * static_cast<double>(count_steps(false, method))) << method;
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
    const ExternalFunction cube("cube", 1, [&](int order, ConstVectorRef a, VectorRef derivatives) {
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
    } catch (const Error& error) {
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
  refuses(
      [&](const auto& x) {
        const std::vector<sfdae_expression> many(17, x);
        return sfdae_external("f", one, 17, many.data(), nullptr);
      },
      "f has 17 arguments, more than 16");
  const sfdae_expression two = sfdae_number(2.0);
  EXPECT_EQ(number(sfdae_external("f", one, 1, &two, nullptr)), 1.0);
  const ExternalFunction f("exp_sin", 2, exp_sin);
  EXPECT_THROW(f(Expression(1.0)), Error);
  EXPECT_EQ(number(f(1.0, 0.5).c()), std::exp(1.0) * std::sin(0.5));
}

}  // namespace
}  // namespace sfdae::test
