// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities of recorded equations of any index against exact ones.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "family_run.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae::SensitivityValues;
using sfdae_test::largest_error;
using sfdae_test::rotation;
using sfdae_test::scaled_count;
using sfdae_test::solver_options;
using sfdae_test::TransformedSystem;

// ---- A pendulum in SI units, index raw -------------------------------------------------------------------------

constexpr double gravity_of_pendulum = 9.81, mass = 2.0;

// (px, py, vx, vy, force), a rod of length L.
sfdae::Solver pendulum(const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression g = sfdae::parameter(t, "g", gravity_of_pendulum), L = sfdae::parameter(t, "L", 1.0),
                     m = sfdae::parameter(t, "m", mass);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = m * xdot[2] + 2.0 * x[0] * x[4];
    F[3] = m * xdot[3] + 2.0 * x[1] * x[4] + m * g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  };
  return sfdae::Solver(problem, options);
}

// With time in units of 1 / sqrt(g): dq/dg = t q' / (2 g), dv/dg = (v + t v') / (2 g), dl/dg = l / g + t l' / (2 g).
std::vector<double> scaling_law(const Point& point) {
  const double own[] = {0.0, 0.0, 0.5, 0.5, 1.0};
  std::vector<double> S(5);
  for (std::size_t i = 0; i < 5; ++i)
    S[i] = (own[i] * point.x[i] + 0.5 * point.t * point.xdot[i]) / gravity_of_pendulum;
  return S;
}

// The constraint 0 = q q - L^2 and the hidden one 0 = q v, differentiated by a parameter; relative.
double violation(const Point& point, const Matrix& S, int j, double dL) {
  const std::vector<double>& x = point.x;
  const double position = x[0] * S(0, j) + x[1] * S(1, j) - dL,
               velocity = x[2] * S(0, j) + x[3] * S(1, j) + x[0] * S(2, j) + x[1] * S(3, j);
  double size = 1.0;
  for (int i = 0; i < 4; ++i) size = std::max(size, std::abs(S(i, j)));
  for (double value : x) size = std::max(size, std::abs(value));
  return std::max(std::abs(position), std::abs(velocity)) / (size * size);
}

// From rest, or fast enough to go round and round, where states change on the way.
struct Motion {
  int method;
  double speed;
};
class PendulumSensitivities : public testing::TestWithParam<Motion> {};
INSTANTIATE_TEST_SUITE_P(Motions, PendulumSensitivities,
                         testing::Values(Motion{SFDAE_METHOD_BDF, 0.0}, Motion{SFDAE_METHOD_RADAU, 0.0},
                                         Motion{SFDAE_METHOD_BDF, 8.0}, Motion{SFDAE_METHOD_RADAU, 8.0}));

TEST_P(PendulumSensitivities, ObeyTheScalingLawAndHiddenConstraints) {
  const double tol = 1e-9, speed = GetParam().speed;
  sfdae::Solver solver = pendulum(solver_options(tol, GetParam().method));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"g", "m", "L"};
  wanted.directions = Matrix(5, 3);
  // Speeds go with sqrt(g).
  wanted.directions(2, 0) = 0.8 * speed / (2 * gravity_of_pendulum);
  wanted.directions(3, 0) = 0.6 * speed / (2 * gravity_of_pendulum);
  solver.set_sensitivities(wanted);
  Point point{0.0, {0.6, -0.8, 0.8 * speed, 0.6 * speed, 0.0}, {}};
  solver.start(point, 10);
  for (int k = 0; k <= 40; ++k) {
    if (k > 0) solver.advance(0.25 * k, point);
    const SensitivityValues values = solver.sensitivities(point.t);
    const std::vector<double> exact = scaling_law(point);
    for (int i = 0; i < 5; ++i) {
      const double size = std::abs(exact[std::size_t(i)]) + (i < 2 ? 1.0 : i < 4 ? 3.0 : 10.0);
      // Errors of x grow with t, those of its derivatives by time once more: observed 3e3 tol where it goes round.
      EXPECT_LE(std::abs(values.S(i, 0) - exact[std::size_t(i)]), 1e4 * tol * size) << "t = " << point.t;
      // The mass is in the force alone.
      const double of_mass = i < 4 ? 0.0 : point.x[4] / mass;
      EXPECT_LE(std::abs(values.S(i, 1) - of_mass), 1e3 * tol * size) << "t = " << point.t;
    }
    for (int j = 0; j < 3; ++j) {
      EXPECT_LE(violation(point, values.S, j, j == 2 ? 1.0 : 0.0), 1e-13) << "t = " << point.t;
      for (int i = 0; i < 2; ++i)
        EXPECT_LE(std::abs(values.Sdot(i, j) - values.S(i + 2, j)), 1e-12 * (1.0 + std::abs(values.S(i + 2, j))));
    }
  }
}

// S between the ends of steps is as good as there, and does not disturb the integration.
TEST_P(PendulumSensitivities, HoldWithinSteps) {
  const double tol = 1e-8;
  sfdae::Solver solver = pendulum(solver_options(tol, GetParam().method)),
                alone = pendulum(solver_options(tol, GetParam().method));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"g"};
  solver.set_sensitivities(wanted);
  Point point{0.0, {0.6, -0.8, 0, 0, 0}, {}}, other = point;
  solver.start(point, 3);
  alone.start(other, 3);
  int looked = 0;
  for (int status = SFDAE_STEP_TAKEN; status == SFDAE_STEP_TAKEN;) {
    const double before = point.t;
    status = solver.step(3, point);
    alone.step(3, other);
    // The same but for what searches for x' leave in the jets they start from.
    ASSERT_NEAR(other.t, point.t, 1e-6);
    if (looked++ % 7 != 0 || status != SFDAE_STEP_TAKEN) continue;
    for (double part : {0.3, 0.8}) {
      Point within{before + part * (point.t - before), std::vector<double>(5), {}};
      solver.interpolate(within);
      const SensitivityValues values = solver.sensitivities(within.t);
      const std::vector<double> exact = scaling_law(within);
      EXPECT_LE(violation(within, values.S, 0, 0.0), 1e-7);  // x is that of the polynomial
      for (int i = 0; i < 4; ++i) EXPECT_NEAR(values.S(i, 0), exact[std::size_t(i)], 3e4 * tol);
    }
  }
  EXPECT_GT(looked, 7);
}

// ---- Random systems --------------------------------------------------------------------------------------------

class RandomSensitivities : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, RandomSensitivities, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(RandomSensitivities, AreExactForAnyIndex) {
  int solved[4] = {0, 0, 0, 0};
  for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(150, 20)); seed <= last; ++seed) {
    const TransformedSystem system(seed);
    sfdae::Solver solver(system.problem(), solver_options(1e-9, GetParam()));
    Point point;
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p", "q"};
    system.exact(0.0, point.x, wanted.directions);
    solver.set_sensitivities(wanted);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    solver.start(point, 2.0);
    EXPECT_LE(largest_error(solver.sensitivities(0.0).S, wanted.directions), 1e-9);
    for (double t : {0.7, 1.3, 2.0}) {
      solver.advance(t, point);
      std::vector<double> x;
      Matrix exact;
      system.exact(t, x, exact);
      EXPECT_LE(largest_error(solver.sensitivities(t).S, exact), 1e-6) << "t = " << t;
    }
    ++solved[std::min(system.mu(), 3)];
  }
  for (int count : solved) EXPECT_GE(count, 2);
}

// Start values off the special solution: against central differences of runs from x0 + h S(0) and x0 - h S(0), which
// are consistent to O(h^2).
TEST_P(RandomSensitivities, AgreeWithDifferencesFromOtherStartValues) {
  constexpr double h = 1e-4, end = 1.5;
  for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(50, 5)); seed <= last; ++seed) {
    const TransformedSystem system(seed);
    const std::size_t n = std::size_t(system.n());
    std::vector<double> x0;
    Matrix unused;
    system.exact(0.0, x0, unused);
    for (std::size_t i = 0; i < n; ++i) x0[i] += 0.1 * std::sin(3.0 * double(i) + seed);
    sfdae::Solver solver(system.problem(), solver_options(1e-9, GetParam()));
    sfdae::Sensitivities wanted;
    wanted.parameters = {"", "q"};
    wanted.directions = Matrix(system.n(), 2);
    for (int i = 0; i < system.n(); ++i) wanted.directions(i, 0) = std::cos(2.0 * i + seed);
    solver.set_sensitivities(wanted);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    Point start{0.0, x0, {}};
    solver.start(start, end);
    const Matrix S0 = solver.sensitivities(0.0).S;
    Point point = start;
    solver.advance(end, point);
    const Matrix S = solver.sensitivities(end).S;
    Matrix differences(system.n(), 2);
    for (int j = 0; j < 2; ++j) {
      std::vector<double> ends[2];
      for (int side = 0; side < 2; ++side) {
        const double change = side == 0 ? -h : h;
        sfdae::Solver other(system.problem(), solver_options(1e-11, SFDAE_METHOD_RADAU));
        if (j == 1) other.set_parameter("q", TransformedSystem::q + change);
        Point moved = start;
        for (std::size_t i = 0; i < n; ++i) moved.x[i] += change * S0(int(i), j);
        other.start(moved, end);
        other.advance(end, moved);
        ends[side] = moved.x;
      }
      for (std::size_t i = 0; i < n; ++i) differences(int(i), j) = (ends[1][i] - ends[0][i]) / (2 * h);
    }
    // h^2 and 1e-11 / h are errors of the differences.
    EXPECT_LE(largest_error(S, differences), 3e-6);
  }
}

// Directions that leave the constraints: what is nearest then, from guesses beyond the last of six digits. Values of
// round numbers beside others, of different sizes.
TEST_P(RandomSensitivities, StartWhereNearestValuesMove) {
  constexpr double h = 1e-4;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const TransformedSystem system(seed);
    Point start{0.0, {}, {}};
    Matrix unused;
    system.exact(0.0, start.x, unused);
    for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", structure " + std::to_string(structure));
      sfdae::Options options = solver_options(1e-8, GetParam());
      options.structure = structure;
      for (int i = 0; i < system.n(); ++i) options.atol_vector.push_back(i % 2 == 0 ? 1e-8 : 1e-10);
      sfdae::Sensitivities wanted;
      wanted.parameters = {""};
      wanted.directions = Matrix(system.n(), 1);
      for (int i = 0; i < system.n(); ++i) wanted.directions(i, 0) = std::cos(2.0 * i + seed);
      sfdae::Solver solver(system.problem(), options);
      solver.set_sensitivities(wanted);
      Point point = start;
      solver.start(point, 1.0);
      const Matrix S0 = solver.sensitivities(0.0).S;
      std::vector<double> ends[2];
      for (int side = 0; side < 2; ++side) {
        Point moved = point;
        for (int i = 0; i < system.n(); ++i)
          moved.x[std::size_t(i)] += (side == 0 ? -h : h) * wanted.directions(i, 0);
        sfdae::Solver(system.problem(), options).start(moved, 1.0);
        ends[side] = moved.x;
      }
      Matrix differences(system.n(), 1);
      for (std::size_t i = 0; i < ends[0].size(); ++i) differences(int(i), 0) = (ends[1][i] - ends[0][i]) / (2 * h);
      EXPECT_LE(largest_error(S0, differences), 1e-6);
    }
  }
}

// ---- Other problems --------------------------------------------------------------------------------------------

// x' = -k (x - cos p t) - p sin p t, 0 = y - x^2: x = cos p t whatever k is, dx/dp = -t sin p t.
TEST(StiffSensitivities, FollowTheSlowSolution) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
      const Expression k = sfdae::parameter(t, "k", 1e6), p = sfdae::parameter(t, "p", 2.0);
      F[0] = xdot[0] + k * (x[0] - cos(p * t)) + p * sin(p * t);
      F[1] = x[1] - x[0] * x[0];
    };
    sfdae::Solver solver(problem, solver_options(1e-8, method));
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p", "k"};
    solver.set_sensitivities(wanted);
    Point point{0.0, {1.0, 1.0}, {}};
    solver.start(point, 5);
    for (double t : {1.0, 2.5, 5.0}) {
      solver.advance(t, point);
      const Matrix S = solver.sensitivities(t).S;
      const double exact = -t * std::sin(2 * t);
      EXPECT_NEAR(S(0, 0), exact, 1e-6);
      EXPECT_NEAR(S(1, 0), 2 * std::cos(2 * t) * exact, 1e-6);
      EXPECT_NEAR(S(0, 1), 0.0, 1e-12);
    }
  }
}

// x1' = p x2, x2' = -p x1 in equations that are linear, with x3 = c x1 and a start value as parameter:
// x1 = x10 cos p t.
TEST(LinearSensitivities, AreThoseOfTheFormula) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    const sfdae::NonlinearProblem problem = rotation();
    sfdae::Solver solver(problem, solver_options(1e-9, method));
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p", "c", ""};
    wanted.directions = Matrix(3, 3);
    wanted.directions(0, 2) = 1.0;
    solver.set_sensitivities(wanted);
    Point point{0.0, {2.0, 0.0, 0.0}, {}};
    solver.start(point, 4);
    solver.advance(4, point);
    const Matrix S = solver.sensitivities(4).S;
    EXPECT_NEAR(S(0, 0), -8 * std::sin(6), 1e-6);
    EXPECT_NEAR(S(2, 0), -24 * std::sin(6), 3e-6);
    EXPECT_NEAR(S(2, 1), 2 * std::cos(6), 1e-7);
    EXPECT_NEAR(S(0, 1), 0.0, 1e-12);
    EXPECT_NEAR(S(2, 2), 3 * std::cos(6), 1e-7);
    // What is said of the problem and its solution is as it was.
    EXPECT_NE(solver.report().find("strangeness index 0"), std::string::npos);
    const sfdae::DerivativeArray array = solver.derivative_array(4.0, 0);
    EXPECT_EQ(array.N(0, 1), 1.5);
    EXPECT_EQ(solver.characteristics().algebraic, 1);
    // Parameters may be changed, and a new start begins with the same directions.
    solver.set_parameter("p", 0.5);
    Point again{0.0, {2.0, 0.0, 0.0}, {}};
    solver.start(again, 4);
    solver.advance(4, again);
    EXPECT_NEAR(solver.sensitivities(4).S(0, 0), -8 * std::sin(2), 1e-6);
    // Backward: x1(4) = 2 stays, x1 = 2 cos p (4 - t).
    solver.set_parameter("p", 1.5);
    Point last{4.0, {2.0, 0.0, 0.0}, {}};
    solver.start(last, 0);
    solver.advance(0, last);
    EXPECT_NEAR(solver.sensitivities(0).S(0, 0), -8 * std::sin(6), 1e-6);
    // Without sensitivities the problem is linear again.
    solver.set_sensitivities({});
    solver.start(again, 8);
    EXPECT_THROW(solver.sensitivities(again.t), sfdae::Error);
  }
}

TEST(EventSensitivities, GiveTheTimeOfAFallAndGoOnAfterAJump) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + sfdae::parameter(t, "g", gravity_of_pendulum) + 0.0 * x[0] * x[1];
  };
  constexpr double height = 2.0, restitution = 0.8;
  sfdae::Solver solver(problem, solver_options(1e-10, SFDAE_METHOD_BDF));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"g", ""};
  wanted.directions = Matrix(2, 2);
  wanted.directions(0, 1) = 1.0;
  solver.set_sensitivities(wanted);
  solver.set_events(1, [](double, auto x, auto, auto g) { g[0] = x[0]; }, {-1});
  Point point{0.0, {height, 0.0}, {}};
  solver.start(point, 10);
  ASSERT_EQ(solver.advance(10, point), SFDAE_EVENT);
  const double fall = std::sqrt(2 * height / gravity_of_pendulum);
  const std::vector<double> dt = solver.event_sensitivities(point.t, 0.0, {1.0, 0.0});
  EXPECT_NEAR(dt[0], -fall / (2 * gravity_of_pendulum), 1e-8);
  EXPECT_NEAR(dt[1], 1 / (gravity_of_pendulum * fall), 1e-8);
  // h(x) = (x1, -e x2): directions of the new start.
  const Matrix before = solver.sensitivities(point.t).S;
  for (int j = 0; j < 2; ++j) {
    wanted.directions(0, j) = before(0, j) + (point.x[1] + restitution * point.x[1]) * dt[std::size_t(j)];
    wanted.directions(1, j) =
        -restitution * before(1, j) + (restitution * gravity_of_pendulum + gravity_of_pendulum) * dt[std::size_t(j)];
  }
  solver.set_sensitivities(wanted);
  point.x[1] *= -restitution;
  const double t_e = point.t;
  solver.start(point, 10);
  solver.advance(t_e + 0.5, point);
  // x1 = v s - g s^2 / 2 with v = e sqrt(2 g height), s = t - sqrt(2 height / g).
  const double s = 0.5, v = restitution * std::sqrt(2 * gravity_of_pendulum * height);
  const double dv[] = {v / (2 * gravity_of_pendulum), v / (2 * height)};
  const double ds[] = {fall / (2 * gravity_of_pendulum), -fall / (2 * height)};
  const Matrix after = solver.sensitivities(point.t).S;
  for (int j = 0; j < 2; ++j)
    EXPECT_NEAR(after(0, j), dv[j] * s + (v - gravity_of_pendulum * s) * ds[j] - (j == 0 ? s * s / 2 : 0.0), 1e-7);
}

// 0 = x1^2 - p and 0 = 2 x1^2 - 2 p^k: redundant for every p if k = 1, else for p = 1 alone.
TEST(RedundantEquations, AreNamedWhereTheyContradictEachOtherForOtherParameters) {
  for (bool contradict : {false, true}) {
    sfdae::NonlinearProblem problem(3, 2);
    problem.equations = [contradict](const Expression& t, auto x, auto xdot, auto F) {
      const Expression p = sfdae::parameter(t, "p", 1.0);
      F[0] = xdot[1] + x[1] * x[0];
      F[1] = x[0] * x[0] - p;
      F[2] = 2.0 * x[0] * x[0] - 2.0 * (contradict ? p * p : p);
    };
    sfdae::Solver solver(problem, solver_options(1e-8, SFDAE_METHOD_BDF));
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    solver.set_sensitivities(wanted);
    Point point{0.0, {1.0, 1.0}, {}};
    if (contradict) {
      try {
        solver.start(point, 1);
        FAIL();
      } catch (const sfdae::Error& error) {
        EXPECT_EQ(error.status(), SFDAE_INCONSISTENT_EQUATIONS) << error.what();
      }
      continue;
    }
    // x2 = exp(-sqrt(p) t)
    solver.start(point, 1);
    solver.advance(1, point);
    const Matrix S = solver.sensitivities(1).S;
    EXPECT_NEAR(S(0, 0), 0.5, 1e-12);
    EXPECT_NEAR(S(1, 0), -0.5 * std::exp(-1.0), 1e-6);
  }
}

// The error test of S sees what x does not show: x stays at 0, dx/dp is a fast oscillation.
class ErrorTestWithMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, ErrorTestWithMethods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(ErrorTestWithMethods, ChoosesStepsForThem) {
  double errors[2];
  for (bool test : {false, true}) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
      const Expression p = sfdae::parameter(t, "p", 0.0);
      F[0] = xdot[0] - p * cos(10.0 * t) * (1.0 + x[1]);
      F[1] = x[1] - x[0] * x[0];
    };
    sfdae::Solver solver(problem, solver_options(1e-5, GetParam()));
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    wanted.error_test = test;
    solver.set_sensitivities(wanted);
    Point point{0.0, {0.0, 0.0}, {}};
    solver.start(point, 10);
    double error = 0.0;
    // Not often: with Radau points within steps are ends of shorter ones.
    for (double t : {5.0, 10.0}) {
      solver.advance(t, point);
      error = std::max(error, std::abs(solver.sensitivities(t).S(0, 0) - std::sin(10.0 * t) / 10.0));
    }
    errors[test ? 1 : 0] = error;
    EXPECT_EQ(solver.sensitivity_statistics().count, 1);
    EXPECT_EQ(solver.sensitivity_statistics().error_test_failures > 0, test);
  }
  EXPECT_GE(errors[0], 1e-2);
  EXPECT_LE(errors[1], 1e-3);
}

// A pendulum at rest, mu = 2, and what a push at the start does to it: S is the solution of the linear pendulum, of
// which x shows nothing, neither for steps nor for orders. Errors of all steps add up.
TEST_P(ErrorTestWithMethods, HoldsForHiddenConstraints) {
  constexpr double tolerance = 1e-7;
  for (bool test : {false, true}) {
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [](const Expression&, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - x[2];
      F[1] = xdot[1] - x[3];
      F[2] = xdot[2] + x[0] * x[4];
      F[3] = xdot[3] + x[1] * x[4] + 9.0;
      F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
    };
    sfdae::Solver solver(problem, solver_options(tolerance, GetParam()));
    sfdae::Sensitivities wanted;
    wanted.parameters = {""};
    wanted.directions = sfdae::Matrix(5, 1);
    wanted.directions(2, 0) = 1.0;
    wanted.error_test = test;
    solver.set_sensitivities(wanted);
    Point point{0.0, {0.0, -1.0, 0.0, 0.0, 9.0}, {}};
    solver.start(point, 10.0);
    double error = 0.0;
    for (double t : {2.5, 10.0}) {
      solver.advance(t, point);
      const sfdae::Matrix S = solver.sensitivities(t).S;
      error = std::max({error, std::abs(S(0, 0) - std::sin(3.0 * t) / 3.0), std::abs(S(2, 0) - std::cos(3.0 * t))});
    }
    if (test) EXPECT_LE(error, 100.0 * tolerance);
    else EXPECT_GE(error, 1e4 * tolerance);
    EXPECT_LE(solver.statistics().steps, 1000);
  }
}

// The scale of a parameter says which S counts as small: a smaller one allows larger errors.
TEST(ErrorTestOfSensitivities, CountsInUnitsOfTheParameters) {
  double errors[2];
  for (double scale : {1.0, 1e-4}) {
    sfdae::NonlinearProblem problem(1, 1);
    problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - sfdae::parameter(t, "p", 0.0) * cos(10.0 * t) * (1.0 + x[0]);
    };
    sfdae::Options options = solver_options(1e-8, SFDAE_METHOD_RADAU);
    options.rtol = 1e-3;
    sfdae::Solver solver(problem, options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p"};
    wanted.error_test = true;
    wanted.scales = {scale};
    solver.set_sensitivities(wanted);
    Point point{0.0, {0.0}, {}};
    solver.start(point, 10.0);
    solver.advance(10.0, point);
    errors[scale < 1.0 ? 1 : 0] = std::abs(solver.sensitivities(10.0).S(0, 0) - std::sin(100.0) / 10.0);
  }
  EXPECT_GT(errors[1], 5.0 * errors[0]);
}

}  // namespace
