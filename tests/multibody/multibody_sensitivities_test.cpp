// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities of recorded multibody systems: laws that are known, differences of solutions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"
#include "solver_options.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::MultibodyProblem;
using sfdae::Point;
using sfdae_test::solver_options;

constexpr double gravity = 9.81, mass = 2.0;

// A rod of length L, its constraint given once or more often.
MultibodyProblem pendulum(int copies = 1) {
  MultibodyProblem problem(2, copies);
  problem.equations = [copies](const Expression& t, auto q, auto, const auto& to) {
    const Expression g = sfdae::parameter(t, "g", gravity), m = sfdae::parameter(t, "m", mass),
                     L = sfdae::parameter(t, "L", 1.2);
    to.M(0, 0) = m;
    to.M(1, 1) = m;
    to.f[1] = -m * g;
    for (int i = 0; i < copies; ++i) to.g[i] = (1.0 + i) * (q[0] * q[0] + q[1] * q[1] - L * L);
  };
  return problem;
}

constexpr double at_rest[] = {0.6 * 1.2, -0.8 * 1.2};

class MultibodySensitivities : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, MultibodySensitivities, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// With time in units of 1 / sqrt(g): dq/dg = t q'/(2 g), dv/dg = (v + t v')/(2 g), dl/dg = l/g + t l'/(2 g).
TEST_P(MultibodySensitivities, ObeyTheScalingLawAndHiddenConstraints) {
  constexpr double tol = 1e-9;
  sfdae::Solver solver(pendulum(), solver_options(tol, GetParam()));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"g", "m", "L"};
  wanted.directions = Matrix(5, 3);
  wanted.directions(0, 2) = 0.6, wanted.directions(1, 2) = -0.8;
  solver.set_sensitivities(wanted);
  Point point{0.0, {at_rest[0], at_rest[1], 0, 0, 0}, {}};
  solver.start(point, 5);
  EXPECT_EQ(solver.multibody_report().degrees_of_freedom, 1);
  const double own[] = {0.0, 0.0, 0.5, 0.5, 1.0};
  for (int k = 0; k <= 20; ++k) {
    if (k > 0) solver.advance(0.25 * k, point);
    const Matrix S = solver.sensitivities(point.t).S;
    const std::vector<double>& x = point.x;
    for (std::size_t i = 0; i < 5; ++i) {
      const double of_g = (own[i] * x[i] + 0.5 * point.t * point.xdot[i]) / gravity;
      const double size = 1.0 + std::abs(of_g) + (i == 4 ? 10.0 : 0.0);
      EXPECT_NEAR(S(int(i), 0), of_g, 1e4 * tol * size) << "t = " << point.t;
      EXPECT_NEAR(S(int(i), 1), i < 4 ? 0.0 : x[4] / mass, 1e3 * tol * size) << "t = " << point.t;
    }
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(x[0] * S(0, j) + x[1] * S(1, j), j == 2 ? 1.2 : 0.0, 1e-12);
      EXPECT_NEAR(x[2] * S(0, j) + x[3] * S(1, j) + x[0] * S(2, j) + x[1] * S(3, j), 0.0, 1e-11);
    }
  }
}

// ---- A skate on a tilted table, driven: q' = S(q) v, a constraint on positions and one on velocities ----------------

MultibodyProblem skate() {
  MultibodyProblem problem(4, 1);
  problem.num_velocities = 3;
  problem.num_nonholonomic = 1;
  problem.equations = [](const Expression& t, auto q, auto v, const auto& to) {
    const Expression m = sfdae::parameter(t, "m", 1.5), k = sfdae::parameter(t, "k", 0.8),
                     e = sfdae::parameter(t, "e", 0.3);
    to.S(0, 0) = Expression(1.0), to.S(1, 1) = Expression(1.0);
    to.S(2, 2) = Expression(1.0) + 0.1 * sin(q[0]);
    to.S(3, 2) = 0.4 + 0.1 * e * q[1];
    to.M(0, 0) = m + 0.2 * q[1] * q[1], to.M(1, 1) = m, to.M(2, 2) = 0.4 + 0.1 * m;
    to.f[0] = -k * q[0] + cos(t), to.f[1] = -k * q[1] - 0.2 * v[0] * v[2], to.f[2] = 0.5 - k * q[2];
    to.g[0] = q[3] - 0.5 * e * q[0] * q[1];
    to.H(0, 0) = -sin(q[2]), to.H(0, 1) = cos(q[2]) + e, to.H(0, 2) = Expression(0.0);
    to.h[0] = -0.1 * e * sin(t);
  };
  return problem;
}

const std::vector<double> skating = {0.5, 0.3, 0.2, 0.0, 1.0, 0.2, 0.3, 0.0, 0.0};

TEST_P(MultibodySensitivities, AgreeWithDifferencesOfSolutions) {
  const char* const names[] = {"m", "k", "e", ""};
  const double values[] = {1.5, 0.8, 0.3, 0.0};
  constexpr double h = 1e-4, end = 2.0;
  constexpr int n = 9, freedom = 3;
  sfdae::Solver solver(skate(), solver_options(1e-9, GetParam()));
  sfdae::Sensitivities wanted;
  for (const char* name : names) wanted.parameters.emplace_back(name);
  wanted.directions = Matrix(n, 4);
  for (int i = 0; i < n; ++i) wanted.directions(i, freedom) = std::cos(2.0 * i);
  solver.set_sensitivities(wanted);
  Point start{0.0, skating, {}};
  solver.start(start, end);
  const Matrix S0 = solver.sensitivities(0.0).S;
  Point point = start;
  solver.advance(end, point);
  const Matrix S = solver.sensitivities(end).S;
  for (int j = 0; j < 4; ++j) {
    SCOPED_TRACE(names[j]);
    std::vector<double> ends[2];
    for (int side = 0; side < 2; ++side) {
      const double change = side == 0 ? -h : h;
      // With local coordinates, as without sensitivities.
      sfdae::Solver other(skate(), solver_options(1e-11, SFDAE_METHOD_RADAU));
      if (*names[j] != '\0') other.set_parameter(names[j], values[j] + change);
      Point moved = start;
      for (int i = 0; i < n; ++i) moved.x[std::size_t(i)] += change * S0(i, j);
      other.start(moved, end);
      other.advance(end, moved);
      ends[side] = moved.x;
    }
    for (std::size_t i = 0; i < std::size_t(n); ++i)
      EXPECT_NEAR(S(int(i), j), (ends[1][i] - ends[0][i]) / (2 * h), 1e-5) << "component " << i;
  }
}

// x and what is said of the system are those without sensitivities, before and after.
TEST_P(MultibodySensitivities, ChangeNothingElse) {
  sfdae::Solver solver(skate(), solver_options(1e-8, GetParam())), alone(skate(), solver_options(1e-8, GetParam()));
  Point point{0.0, skating, {}}, reference = point;
  alone.start(reference, 1);
  alone.advance(1, reference);
  for (bool with : {true, false}) {
    sfdae::Sensitivities wanted;
    if (with) wanted.parameters = {"m"};
    solver.set_sensitivities(wanted);
    point = Point{0.0, skating, {}};
    solver.start(point, 1);
    solver.advance(1, point);
    for (std::size_t i = 0; i < point.x.size(); ++i)
      EXPECT_NEAR(point.x[i], reference.x[i], with ? 1e-5 : 0.0) << "component " << i;
    EXPECT_EQ(solver.characteristics().strangeness_index, alone.characteristics().strangeness_index);
    EXPECT_EQ(solver.characteristics().differential, alone.characteristics().differential);
    EXPECT_EQ(solver.multibody_report().degrees_of_freedom, alone.multibody_report().degrees_of_freedom);
    EXPECT_NE(solver.report().find("strangeness index 2"), std::string::npos) << solver.report();
  }
}

TEST(RefusedMultibodySensitivities, AreNamed) {
  MultibodyProblem problem(1, 0);
  problem.forces = [](double, auto q, auto, auto f) { f[0] = -q[0]; };
  sfdae::Solver callbacks(problem);
  sfdae::Sensitivities wanted{{"k"}, {}, false, {}};
  EXPECT_THROW(callbacks.set_sensitivities(wanted), sfdae::Error);
  sfdae::Options options;
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  for (int copies : {1, 2}) {
    sfdae::Solver solver = copies == 1 ? sfdae::Solver(pendulum(), options) : sfdae::Solver(pendulum(copies));
    wanted.parameters = {"g"};
    solver.set_sensitivities(wanted);
    Point point{0.0, {at_rest[0], at_rest[1], 0, 0, 0}, {}};
    point.x.resize(std::size_t(4 + copies));
    try {
      solver.start(point, 1);
      FAIL();
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
      EXPECT_NE(std::string(error.what()).find(copies == 1 ? "REQUIRED" : "redundant"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
