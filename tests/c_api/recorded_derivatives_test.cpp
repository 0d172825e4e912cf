// Derivatives of formulas in recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "recorded_formulas.h"

namespace sfdae::test {
namespace {

// G^T lambda without G: the pendulum q'' = -G^T lambda - g e_2, written with the derivative of lambda g(q).
TEST(RecordedDerivatives, ReplaceTheJacobianOfConstraints) {
  const auto pendulum = [](bool by_hand) {
    NonlinearProblem problem(5, 5);
    problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      const Expression length = parameter(t, "L", 1.0);
      const Expression g = x[0] * x[0] + x[1] * x[1] - length * length, potential = x[4] * g;
      for (int j = 0; j < 2; ++j) {
        const Expression force = by_hand ? 2.0 * x[4] * x[j] : derivative(potential, x[j]);
        F[j] = xdot[j] - x[j + 2];
        F[j + 2] = xdot[j + 2] + force + (j == 1 ? 9.81 : 0.0);
      }
      F[4] = g;
    };
    Options options;
    options.rtol = options.atol = 1e-9;
    Solver solver(problem, options);
    Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
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
    const Expression p = parameter(t, "p", 1.7);
    const Expression a = pow(x[0], p) * sin(t * x[1]) + xdot[0] * x[1];
    // Asked for in turn with another formula, and by what appears nowhere.
    const Expression other = derivative(x[0] * x[1], x[0]);
    return std::vector<Expression>{
        derivative(a, x[0]), derivative(a, x[1]), derivative(a, t),      derivative(a, p), other,
        derivative(a, x[2]), derivative(2.0, t),  derivative(a, xdot[0])};
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
    return std::vector<Expression>{time_derivative(a), time_derivative(3.0), derivative(time_derivative(a), x[1])};
  };
  const Point point = consistent(formulas, 3, {2.0, 0.5}, 0.7, 1.5);
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
  MultibodyProblem body(1);
  body.equations = [](const auto&, auto q, auto, auto to) { to.f[0] = time_derivative(q[0]); };
  EXPECT_NE(Solver::check(body).find("mechanical systems"), std::string::npos);
}

// Forces of a potential in a mechanical system: f = -V_q.
TEST(RecordedDerivatives, ServeMechanicalSystems) {
  MultibodyProblem problem(2);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    const Expression V = 0.5 * (4.0 * q[0] * q[0] + 9.0 * q[1] * q[1]);
    for (int i = 0; i < 2; ++i) to.M(i, i) = 1.0, to.f[i] = -derivative(V, q[i]);
  };
  Options options;
  options.rtol = options.atol = 1e-9;
  Solver solver(problem, options);
  Point point{0.0, {1.0, 1.0, 0.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_NEAR(point.x[0], std::cos(2.0), 1e-6);
  EXPECT_NEAR(point.x[1], std::cos(3.0), 1e-6);
}

}  // namespace
}  // namespace sfdae::test
