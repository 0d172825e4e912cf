// SPDX-License-Identifier: BSD-3-Clause
//
// Inputs with kinks that make unknowns jump, by impulses if their derivatives are in the equations.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;

Vector values_at(double t, sfdae::Solver solver, Vector x) {
  sfdae::Point point{0.0, std::move(x), {}};
  solver.start(point, 2.0);
  EXPECT_EQ(solver.advance(t, point), SFDAE_OK);
  return point.x;
}

void expect_near(const Vector& x, const Vector& expected) {
  ASSERT_EQ(x.size(), expected.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], expected[i], 1e-5) << i;
}

// A position is prescribed by a polygon: its velocity jumps, the force is an impulse, which is none of the values that
// functions have. Masses hand it on: v2 jumps by -m12 times that. No step finds that, impulses do.
TEST(Kinks, ThatAskForImpulsesGetThem) {
  const Vector places = {0.0, 1.0, 2.0}, values = {0.0, 0.5, -0.3};
  const double m12 = 0.4;
  sfdae::NonlinearProblem nonlinear(5, 5);
  nonlinear.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + m12 * xdot[3] - x[4];
    F[3] = m12 * xdot[2] + xdot[3];
    F[4] = x[0] - sfdae::table(t, 1, places, values);
  };
  sfdae::MultibodyProblem mechanical(2, 1);
  mechanical.equations = [=](const auto& t, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.M(0, 1) = to.M(1, 0) = m12;
    to.g[0] = q[0] - sfdae::table(t, 1, places, values);
  };
  // An unknown whose derivative is in the equations jumps.
  sfdae::NonlinearProblem saw_tooth(3, 3);
  saw_tooth.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] - sfdae::table(modulo(t, 1.0), 1, {0.0, 1.0}, {0.0, 0.7});
    F[2] = xdot[2] - x[1];
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options;
    options.method = method;
    const double v2 = m12 * 1.3;
    const Vector after = {0.1, 0.5 * v2, -0.8, v2};
    const Vector all = values_at(1.5, sfdae::Solver(nonlinear, options), {0.0, 0.0, 0.5, 0.0, 0.0});
    expect_near(Vector(all.begin(), all.begin() + 4), after);
    const Vector moving = values_at(1.5, sfdae::Solver(mechanical, options), {0.0, 0.0, 0.5, 0.0, 0.0});
    expect_near(Vector(moving.begin(), moving.begin() + 4), after);
    expect_near(values_at(1.5, sfdae::Solver(saw_tooth, options), {0.0, 0.7, 0.0}), {0.35, 0.7, 0.35});
  }
}

// As the velocities of a polygon do, derivatives of order p of splines jump at knots: mu = 4 differentiates those of
// p = 3.
TEST(Kinks, ThatAskForImpulsesGetThemForSplines) {
  const Vector places = {0.0, 0.5, 1.0, 1.5, 2.0, 2.5}, values = {0.0, 0.3, -0.2, 0.5, 0.1, 0.4};
  for (int mu : {3, 4}) {
    sfdae::NonlinearProblem problem(mu + 2, mu + 2);
    problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      for (int i = 0; i < mu; ++i) F[i] = xdot[i] - x[i + 1];
      F[mu] = x[0] - sfdae::table(t, 3, places, values);
      F[mu + 1] = xdot[mu + 1] - x[mu];  // T^(mu - 1), which has jumps for mu = 4
    };
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae::Options options;
      options.method = method;
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, Vector(static_cast<std::size_t>(mu + 2), 0.0), {}};
      solver.start(point, 2.0);
      EXPECT_EQ(solver.characteristics().strangeness_index, mu);
      const Vector start = point.x;
      ASSERT_EQ(solver.advance(1.8, point), SFDAE_OK);
      const auto last = static_cast<std::size_t>(mu + 1);
      EXPECT_NEAR(point.x[last] - start[last], point.x[last - 2] - start[last - 2], 1e-4);
    }
  }
}

// A jump of what is not differentiated is none of x': x = saw-tooth, y' = x has the integral of it.
TEST(Kinks, OfAlgebraicUnknownsMayBeJumps) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[1] - sfdae::table(modulo(t, 1.0), 1, {0.0, 1.0}, {0.0, 1.0});
  };
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double end : {4.5, -4.5}) {
      sfdae::Options options;
      options.method = method;
      options.rtol = options.atol = 1e-8;
      sfdae::Solver solver(problem, options);
      sfdae::Point point{0.0, {0.0, 0.0}, {}};
      solver.start(point, end);
      ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
      // 4 periods of 1/2 and an integral of t from 0 to 1/2, or of t from 1/2 to 1.
      EXPECT_NEAR(point.x[0], end > 0.0 ? 2.125 : -2.375, 1e-6);
      EXPECT_NEAR(point.x[1], 0.5, 1e-6);
    }
}

// Two capacitors divide a step that begins where the data end: a function that fails beyond the stop time does no harm.
TEST(Kinks, AtTheStopTimeAreCrossedUpToIt) {
  for (const double direction : {1.0, -1.0})
    for (const bool is_included : {true, false})
      for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
        const sfdae::ExternalFunction data("data", 1, [&](int order, auto arguments, auto to) {
          to[0] = order == 0 ? 1.0 : 0.0;
          return arguments[0] * direction > 1.0 ? 1 : 0;
        });
        sfdae::NonlinearProblem problem(3, 3);
        problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
          const Expression left = 1.0 - direction * t;
          F[0] = xdot[0] - 2.0 * xdot[1];
          F[1] = x[2] - (xdot[0] - xdot[1]);
          F[2] = x[0] - data(t) * (is_included ? choose(left, 0.0, 1.0) : choose(-left, 1.0, 0.0));
        };
        sfdae::Options options;
        options.method = method;
        options.use_stop_time = 1;
        options.stop_time = direction;
        sfdae::Solver solver(problem, options);
        sfdae::Point point{0.0, {0.0, 0.0, 0.0}, {}};
        solver.start(point, direction);
        ASSERT_EQ(solver.advance(direction, point), SFDAE_OK);
        // Values at a switching time are those on the side of larger t, as far as there are data.
        const bool is_after = is_included && direction > 0.0;
        EXPECT_NEAR(point.x[0], is_after ? 1.0 : 0.0, 1e-12);
        EXPECT_NEAR(point.x[1], is_after ? 0.5 : 0.0, 1e-12);
      }
}

// The knots of a drive of positions are where steps end, too: a pulse of width 0.02 within ten units of time, of
// degree 3.
TEST(Kinks, OfDrivesOfMechanicalSystemsAreNotSteppedOver) {
  const Vector places = {0.0, 2.0, 4.0, 5.99, 6.0, 6.01, 8.0, 10.0},
               values = {0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0};
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [&](const auto& t, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = q[0];  // v2' = q1: v2 is the integral of the drive
    to.g[0] = q[0] - sfdae::table(t, 3, places, values);
  };
  // Of the spline, by Gauss' formula with two points, exact for cubics.
  double integral = 0.0;
  for (std::size_t i = 0; i + 1 < places.size(); ++i)
    for (double place : {0.5 - 0.5 / std::sqrt(3.0), 0.5 + 0.5 / std::sqrt(3.0)}) {
      const double width = places[i + 1] - places[i], t = places[i] + place * width;
      const int count = static_cast<int>(places.size());
      integral += 0.5 * width * sfdae_table(sfdae_number(t), 3, count, places.data(), values.data()).value;
    }
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options;
    options.method = method;
    options.rtol = options.atol = 1e-6;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {0.0, 0.0, 0.0, 0.0, 0.0}, {}};
    solver.start(point, 10.0);
    ASSERT_EQ(solver.advance(10.0, point), SFDAE_OK);
    EXPECT_NEAR(point.x[3], integral, 1e-4);
  }
}

}  // namespace
