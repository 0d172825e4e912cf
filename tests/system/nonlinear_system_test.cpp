// SPDX-License-Identifier: BSD-3-Clause
// Steps of nonlinear problems fulfil their equations: those of the step and the constraints, hidden ones too.
#include "array/nonlinear_system.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "integrate/radau_method.h"
#include "linalg/dense.h"
#include "matrix_checks.h"
#include "nonlinear_examples.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::rounding;
using sfdae_test::size;
using Vector = std::vector<double>;

constexpr double g = sfdae_test::Pendulum::gravity;

Vector pendulum_at(double angle, double speed) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {s, -c, speed * c, speed * s, speed * speed + g * c};
}

// Index-reduced pendulum, z = (angle, speed): the step equations of W = I in x = x(z), 2 equations of Z1^T F. With
// w = D_h x, p' - q and q' + lambda p + g e_y; their part tangential to the constraint p + ... is F1:
//   t^T (p' - v) = 0, t^T (v' + g e_y) = 0        t = (-y, x) (the force is normal to it)
Vector tangential(const Vector& x, const Vector& xdot) {
  const double tx = -x[1], ty = x[0];
  return {tx * (xdot[0] - x[2]) + ty * (xdot[1] - x[3]), tx * xdot[2] + ty * (xdot[3] + g)};
}

// All hidden constraints of the pendulum.
double constraint_error(const Vector& x) {
  return std::max({std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), std::fabs(x[0] * x[2] + x[1] * x[3]),
                   0.1 * std::fabs(x[2] * x[2] + x[3] * x[3] - x[4] - g * x[1])});
}

// The Taylor coefficients that a guess consists of: constant.
struct ConstantGuess {
  Vector taylor, before, inverse_weights;
  ConstantGuess(const NonlinearSystem& system, const Vector& x, double tolerance)
      : taylor(system.jet().x.size(), 0.0), before(taylor), inverse_weights(x.size(), 1.0 / tolerance) {
    std::copy(x.begin(), x.end(), taylor.begin());
    std::copy_n(system.jet().x.begin(), x.size(), before.begin());
  }
  Guess guess() const { return {taylor.data(), before.data(), inverse_weights.data()}; }
};

struct Step {
  PointStatus status;
  Vector x;
};

// Implicit Euler from x0 at system.t() to t.
Step euler(NonlinearSystem& system, const Vector& x0, double t, double tolerance) {
  const double c = 1.0 / (t - system.t());
  Vector rest(x0);
  for (double& value : rest) value *= -c;
  const ConstantGuess guess(system, x0, tolerance);
  if (system.move_to(t) != PointStatus::ok) return {PointStatus::callback_error, x0};
  Vector x(x0);
  const PointStatus status = system.solve({c, rest.data(), rest.data(), guess.guess()}, x.data());
  return {status, x};
}

Vector values_of(const NonlinearSystem& system) {
  return {system.jet().x.data(), system.jet().x.data() + system.jet().n};
}

}  // namespace

// x1' = -x1 x2, x2 = x1: (z - z0) / h = -z^2 has the solution z = 2 z0 / (1 + sqrt(1 + 4 h z0)).
TEST(NonlinearSystem, SolvesTheEquationsOfAStep) {
  for (double h : {1e-3, 0.1, 1.0, -0.1})
    for (double tolerance : {1e-4, 1e-12}) {
      if (h == 1.0 && tolerance < 1e-4) continue;  // contracts by 0.25 only
      NonlinearExample e(sfdae_test::record_of_hyperbola());
      e.analyze(0.0, 1.0, {1.0, 1.0});
      const Step step = euler(*e.system, {1.0, 1.0}, h, tolerance);
      ASSERT_EQ(step.status, PointStatus::ok) << h;
      const double z = 2.0 / (1.0 + std::sqrt(1.0 + 4.0 * h));
      EXPECT_NEAR(step.x[0], z, 0.02 * tolerance + rounding(2)) << h;
      EXPECT_NEAR(step.x[1], z, 0.02 * tolerance + rounding(2)) << h;
    }
}

// Newton's method with differences on the tangential equations in the two degrees of freedom, Z1 spanning any basis
// of them.
TEST(NonlinearSystem, StepsOfThePendulumFulfilTheTangentialEquationsAndAllConstraints) {
  for (double h : {1e-3, 0.02, 0.1}) {
    NonlinearExample e(sfdae_test::record_of_pendulum());
    const Vector x0 = pendulum_at(0.6, 0.7);
    e.analyze(0.0, 1.0, x0);
    const Vector start = values_of(*e.system);
    const Step step = euler(*e.system, start, h, 1e-13);
    ASSERT_EQ(step.status, PointStatus::ok) << h;
    EXPECT_LE(constraint_error(step.x), 10.0 * rounding(5)) << h;
    // Z1 belongs to the linearization, a point within the step: what is solved differs from the tangential equations at
    // the end by constraints and O(h) of their discretization error O(h).
    Vector xdot(5);
    for (std::size_t i = 0; i < 5; ++i) xdot[i] = (step.x[i] - start[i]) / h;
    const Vector F1 = tangential(step.x, xdot);
    for (double value : F1) EXPECT_LE(std::fabs(value), 40.0 * h * h + 10.0 * rounding(5) / h) << h;
  }
}

// Errors of implicit Euler over [0, 0.5] are proportional to h.
TEST(NonlinearSystem, StepsConvergeWithTheirOrder) {
  double errors[2];
  for (int halved = 0; halved < 2; ++halved) {
    NonlinearExample e(sfdae_test::record_of_hyperbola());
    e.analyze(0.0, 1.0, {1.0, 1.0});
    const int steps = 50 << halved;
    Vector x = {1.0, 1.0};
    for (int k = 1; k <= steps; ++k) {
      const Step step = euler(*e.system, x, 0.5 * k / steps, 1e-10);
      ASSERT_EQ(step.status, PointStatus::ok);
      x = step.x;
      e.system->accept();
    }
    errors[halved] = std::fabs(x[0] - 1.0 / 1.5);
  }
  EXPECT_NEAR(errors[0] / errors[1], 2.0, 0.05);
}

// The stages of Radau IIA satisfy F1 at every stage: collocation of z' = -z^2.
TEST(NonlinearSystem, SolvesTheStagesOfRadau) {
  for (int s : {1, 3, 5, 7})
    for (double h : {0.01, 0.5}) {
      NonlinearExample e(sfdae_test::record_of_hyperbola());
      e.analyze(0.0, 1.0, {1.0, 1.0});
      const StageMethod& method = radau_method(s).stages;
      const std::size_t block = e.system->jet().x.size();
      Vector taylor(block * size(s), 0.0), before(block, 0.0), weights(2, 1e13), x(size(2 * s)), w(x);
      const Vector start = {1.0, 1.0};
      for (int i = 0; i < s; ++i)
        std::copy(start.begin(), start.end(), taylor.begin() + static_cast<std::ptrdiff_t>(block) * i);
      std::copy(start.begin(), start.end(), before.begin());
      double reached = 0.0;
      ASSERT_EQ(e.system->move_to(h), PointStatus::ok);
      const StageEquations equations{method,       0.0,          h,
                                     start.data(), start.data(), {taylor.data(), before.data(), weights.data()}};
      ASSERT_EQ(e.system->solve_stages(equations, x.data(), w.data(), reached), PointStatus::ok) << s;
      EXPECT_EQ(reached, h);
      EXPECT_EQ(x, w);
      for (int i = 0; i < s; ++i) {
        double slope = 0.0, terms = 1.0;
        for (int j = 0; j < s; ++j) {
          slope += method.D_at(i, j) / h * (x[size(2 * j)] - 1.0);
          terms += std::fabs(method.D_at(i, j) / h);
        }
        const double z = x[size(2 * i)];
        EXPECT_NEAR(slope, -z * z, 10.0 * rounding(s) * terms) << s << ' ' << h;
        EXPECT_NEAR(x[size(2 * i + 1)], z, rounding(4));
      }
      // A truncation error of order 2 s, z^(2s) / (2s)! = 1, at most.
      EXPECT_NEAR(x[size(2 * s - 2)], 1.0 / (1.0 + h), std::pow(h, 2 * s) + 10.0 * rounding(s));
    }
}

// dw -> dx is a projection onto the directions that the constraints linearized leave open: with n = (x, y), t = (-y,
// x) and
// v the speed  dp = alpha t, dv = beta t - alpha v n, dlambda = 2 (u, v)^T dv - g dy.
TEST(NonlinearSystem, ErrorsOfComponentsKeepTheConstraints) {
  const double speed = 0.7, alpha = 0.3, beta = -0.4;
  NonlinearExample e(sfdae_test::record_of_pendulum());
  const Vector x = pendulum_at(0.6, speed), any = {0.3, -0.2, 0.5, 0.1, 99.0};
  e.analyze(0.0, 1.0, x);
  Vector open = {-alpha * x[1], alpha * x[0], -beta * x[1] - alpha * speed * x[0], beta * x[0] - alpha * speed * x[1],
                 0.0};
  open[4] = 2.0 * (x[2] * open[2] + x[3] * open[3]) - g * open[1];
  Vector same(5), dx(5), two(10);
  e.system->error_in_x(open.data(), 1, same.data());
  EXPECT_LE(sfdae_test::distance(same, open), 100.0 * rounding(5));
  e.system->error_in_x(any.data(), 1, dx.data());
  EXPECT_NEAR(x[0] * dx[0] + x[1] * dx[1], 0.0, 10.0 * rounding(5));
  EXPECT_NEAR(x[2] * dx[0] + x[3] * dx[1] + x[0] * dx[2] + x[1] * dx[3], 0.0, 10.0 * rounding(5));
  EXPECT_NEAR(2.0 * (x[2] * dx[2] + x[3] * dx[3]) - dx[4] - g * dx[1], 0.0, 100.0 * rounding(5));
  EXPECT_GT(sfdae_test::largest(dx), 0.1);
  Vector both(open);
  for (double value : any) both.push_back(-2.0 * value);
  e.system->error_in_x(both.data(), 2, two.data());
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(two[i], open[i], 100.0 * rounding(5));
    EXPECT_NEAR(two[i + 5], -2.0 * dx[i], 100.0 * rounding(5));
  }
}

// x2 = x1 where the step has no solution, too.
TEST(NonlinearSystem, ErrorsOfComponentsKeepTheConstraintsAfterAStepWithoutASolution) {
  NonlinearExample e(sfdae_test::record_of_hyperbola());
  e.analyze(0.0, 1.0, {1.0, 1.0});
  ASSERT_EQ(euler(*e.system, {1.0, 1.0}, -1.0, 1e-6).status, PointStatus::not_converged);  // z + 1 = z^2 + 2
  const Vector dw = {0.25, -7.0};
  Vector dx(2);
  e.system->error_in_x(dw.data(), 1, dx.data());
  EXPECT_NEAR(dx[0], 0.25, 10.0 * rounding(2));
  EXPECT_NEAR(dx[1], 0.25, 10.0 * rounding(2));
}

// x2 has no derivative in the equations.
TEST(NonlinearSystem, KnowsWhichPartOfAChangeIsDifferentiated) {
  NonlinearExample e(sfdae_test::record_of_hyperbola());
  e.analyze(0.0, 1.0, {1.0, 1.0});
  ASSERT_EQ(euler(*e.system, {1.0, 1.0}, 0.1, 1e-6).status, PointStatus::ok);
  const Vector tolerances = {0.1, 0.1}, of_x1 = {0.5, 7.0}, of_x2 = {0.0, 7.0};
  EXPECT_DOUBLE_EQ(e.system->change_of_differentiated(of_x1.data(), tolerances.data()), 5.0);
  EXPECT_DOUBLE_EQ(e.system->change_of_differentiated(of_x2.data(), tolerances.data()), 0.0);
}

TEST(NonlinearSystem, RestoresHiddenConstraints) {
  for (double amount : {1e-8, 1e-3, 0.1}) {
    NonlinearExample e(sfdae_test::record_of_pendulum());
    Vector x = pendulum_at(0.6, 0.7), restored(5);
    e.analyze(0.0, 1.0, x);
    const Vector error = sfdae_test::random_vector(5, 3);
    for (std::size_t i = 0; i < 5; ++i) x[i] += amount * error[i];
    e.system->restore(x.data(), x.data(), restored.data());
    EXPECT_LE(constraint_error(restored), 10.0 * rounding(5)) << amount;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(restored[i], x[i], 4.0 * amount) << amount;
    EXPECT_EQ(values_of(*e.system), restored);
  }
}

// Torus, robot arm, hyperbola: exact solutions.
TEST(NonlinearSystem, KnowsTheDerivativeOfTheSolution) {
  for (const char* name : {"torus", "robot_arm"})
    for (double t : {0.3, 0.9}) {
      const auto& p = sfdae_test::formula_problem(name);
      const auto exact = p.exact(t, 1);
      NonlinearExample e(sfdae_test::record_of_formulas(name));
      Vector x, xdot(exact.size());
      for (const auto& jet : exact) x.push_back(jet[0]);
      e.analyze(t, t + 1.0, x);
      ASSERT_TRUE(e.system->exact_derivative(values_of(*e.system).data(), xdot.data())) << name;
      double largest = 0.0;
      for (const auto& jet : exact) largest = std::max(largest, std::fabs(jet[1]));
      // mu + 1 derivatives of the arm: pivots of about 1e-4.
      for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_NEAR(xdot[i], exact[i][1], 1e5 * rounding(8) * largest) << name << i;
      Vector without_array(exact.size());
      EXPECT_TRUE(e.system->consistent_derivative(values_of(*e.system).data(), 1.0, without_array.data()));
      for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_NEAR(without_array[i], exact[i][1], 1e5 * rounding(8) * largest);
    }
}

// x3 is free: its derivative is held at 0 as far as the others allow, x1' = x1 x3 and x2' = 2 x1 x1'.
TEST(NonlinearSystem, HoldsFreeComponents) {
  NonlinearExample e(sfdae_test::record_with_free_component());
  e.analyze(0.0, 1.0, {2.0, 4.0, 0.3});
  EXPECT_EQ(e.system->undetermined(), 1);
  Vector xdot(3);
  ASSERT_TRUE(e.system->exact_derivative(values_of(*e.system).data(), xdot.data()));
  const Vector expected = {0.6, 2.4, 0.0};
  EXPECT_LE(sfdae_test::distance(xdot, expected), 10.0 * rounding(3));
  const Step step = euler(*e.system, {2.0, 4.0, 0.3}, 0.1, 1e-13);
  ASSERT_EQ(step.status, PointStatus::ok);
  EXPECT_NEAR(step.x[2], 0.3, 10.0 * rounding(3));
  EXPECT_NEAR(step.x[0], 2.0 / (1.0 - 0.03), 10.0 * rounding(3));
  EXPECT_NEAR(step.x[1], step.x[0] * step.x[0], 10.0 * rounding(3));
}

TEST(NonlinearSystem, ChecksRedundantEquations) {
  NonlinearExample e(sfdae_test::record_with_redundant_equation());
  e.analyze(0.0, 1.0, {1.0, 1.0});
  EXPECT_EQ(e.analysis.values.v, 1);
  const Step step = euler(*e.system, {1.0, 1.0}, 0.1, 1e-10);
  ASSERT_EQ(step.status, PointStatus::ok);
  EXPECT_EQ(e.system->quality().inconsistency, 0.0);
  EXPECT_NEAR(step.x[0], (-1.0 + std::sqrt(1.4)) / 0.2, 1e-11);
}

}  // namespace sfdae::core
