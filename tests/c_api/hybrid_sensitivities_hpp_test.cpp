// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities of hybrid systems, over their transitions, against formulas and differences of solutions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "hybrid_systems.h"
#include "sfdae/hybrid.hpp"
#include "solver_options.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::ball;
using sfdae_test::by;
using sfdae_test::RandomModes;
using sfdae_test::rope;
using sfdae_test::solver_options;
using sfdae_test::System;
using sfdae_test::unit_directions;
using Vector = std::vector<double>;

class HybridSensitivities : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, HybridSensitivities,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

// ---- A ball that bounces -----------------------------------------------------------------------------------------

// Position, velocity and time of the last bounce at t, from height h at rest.
std::array<double, 3> flight(double t, double g, double h, double e) {
  double start = std::sqrt(2.0 * h / g), speed = e * g * start;
  if (t < start) return {h - 0.5 * g * t * t, -g * t, 0.0};
  while (t > start + 2.0 * speed / g) {
    start += 2.0 * speed / g;
    speed *= e;
  }
  const double since = t - start;
  return {speed * since - 0.5 * g * since * since, speed - g * since, start};
}

TEST_P(HybridSensitivities, AreThoseOfABouncingBall) {
  System system = ball(solver_options(1e-10, GetParam()));
  constexpr double g = 9.81, h = 2.0, e = 0.8, step = 1e-5;
  system.hybrid.set_sensitivities(by({"g", "", ""}, unit_directions(3, 3, 1, {0, 2})));
  Point point{0.0, {h, 0.0, e}, {}};
  system.hybrid.start(0, point, 4.0);
  for (double t : {0.3, 0.9, 1.5, 2.2, 2.9}) {
    system.hybrid.advance(t, point);
    const sfdae::SensitivityValues found = system.hybrid.sensitivities(t);
    const Vector dt = t > 0.5 ? system.hybrid.passage_sensitivities() : Vector(3, 0.0);
    for (int j = 0; j < 3; ++j) {
      const auto moved = [&](double by) {
        return flight(t, g + (j == 0 ? by : 0.0), h + (j == 1 ? by : 0.0), e + (j == 2 ? by : 0.0));
      };
      const auto above = moved(step), below = moved(-step);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(found.S(i, j), (above[std::size_t(i)] - below[std::size_t(i)]) / (2.0 * step), 1e-7)
            << t << ", " << i << ", " << j;
      EXPECT_NEAR(dt[std::size_t(j)], (above[2] - below[2]) / (2.0 * step), 1e-7) << t << ", " << j;
      EXPECT_NEAR(found.Sdot(0, j), found.S(1, j), 1e-9);
    }
    EXPECT_NEAR(found.S(2, 2), 1.0, 1e-12);
  }
  EXPECT_GE(system.hybrid.num_passages(), 3);
}

// ---- Two capacitors that are connected at a fixed time -----------------------------------------------------------

TEST_P(HybridSensitivities, KeepTheChargeOfCapacitors) {
  const auto circuit = [](bool is_closed) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [is_closed](const Expression& t, auto x, auto xdot, auto F) {
      const Expression C = sfdae::parameter(t, "C", 1.0), R = sfdae::parameter(t, "R", 2.0);
      F[0] = C * xdot[0] + x[0] / R + x[2];
      F[1] = 3.0 * xdot[1] - x[2];
      if (is_closed) F[2] = x[0] - x[1];
      else F[2] = x[2] + 0.0 * t;
    };
    return problem;
  };
  System system;
  for (bool is_closed : {false, true}) system.add(circuit(is_closed), solver_options(1e-10, GetParam()));
  sfdae::Transition close;
  close.to = 1;
  close.kind = SFDAE_TRANSITION_TIME;
  close.time = 0.5;
  system.hybrid.add_transition(close);
  system.hybrid.set_sensitivities(by({"C", "R", ""}, unit_directions(3, 3, 2, {0})));
  Point point{0.0, {2.0, 0.0, 0.0}, {}};
  system.hybrid.start(0, point, 2.0);
  const auto voltage = [](double t, double C, double R, double v) {
    const double at_switch = C * v * std::exp(-0.5 / (R * C)) / (C + 3.0);
    return at_switch * std::exp(-(t - 0.5) / (R * (C + 3.0)));
  };
  for (double t : {0.5, 1.1, 2.0}) {
    system.hybrid.advance(t, point);
    EXPECT_NEAR(point.x[0], voltage(t, 1.0, 2.0, 2.0), 1e-8);
    const Matrix S = system.hybrid.sensitivities(t, false).S;
    for (int j = 0; j < 3; ++j) {
      const auto moved = [&](double by) {
        return voltage(t, 1.0 + (j == 0 ? by : 0.0), 2.0 + (j == 1 ? by : 0.0), 2.0 + (j == 2 ? by : 0.0));
      };
      const double expected = (moved(1e-5) - moved(-1e-5)) / 2e-5;
      EXPECT_NEAR(S(0, j), expected, 1e-8) << t << ", " << j;
      EXPECT_NEAR(S(1, j), S(0, j), 1e-14);
    }
  }
  EXPECT_EQ(system.hybrid.passage_sensitivities(), Vector(3, 0.0));
  EXPECT_EQ(system.hybrid.mode(1).strangeness_index, 1);
}

// ---- A mass that a rope catches ----------------------------------------------------------------------------------

Vector end_of_rope(double g, const Vector& start, double end) {
  System system = rope(solver_options(1e-12, SFDAE_METHOD_RADAU));
  system.set_parameter("g", g);
  Point point{0.0, start, {}};
  system.hybrid.start(0, point, end);
  system.hybrid.advance(end, point);
  EXPECT_EQ(system.hybrid.num_passages(), 1);
  return point.x;
}

TEST_P(HybridSensitivities, FulfilHiddenConstraintsAfterARopeIsTight) {
  System system = rope(solver_options(1e-9, GetParam()));
  const Vector start = {0.3, 0.2, 0.5, 0.1, 0.0, 1.0};
  constexpr double g = 9.81, end = 1.2, step = 1e-5;
  system.hybrid.set_sensitivities(by({"g", "", ""}, unit_directions(6, 3, 1, {2, 5})));
  Point point{0.0, start, {}};
  system.hybrid.start(0, point, end);
  ASSERT_EQ(system.hybrid.advance_to_transition(end, point), SFDAE_EVENT);
  for (int k = 0; k < 2; ++k) {
    const Matrix S = system.hybrid.sensitivities(point.t, false).S;
    for (int j = 0; j < 3; ++j) {
      const double length = point.x[0] * S(0, j) + point.x[1] * S(1, j) - point.x[5] * S(5, j);
      const double rate = point.x[2] * S(0, j) + point.x[3] * S(1, j) + point.x[0] * S(2, j) + point.x[1] * S(3, j);
      EXPECT_NEAR(length, 0.0, 1e-12 * (1.0 + std::fabs(S(0, j))));
      EXPECT_NEAR(rate, 0.0, 1e-11 * (1.0 + std::fabs(S(2, j))));
    }
    if (k == 0) system.hybrid.advance(end, point);
  }
  const Matrix S = system.hybrid.sensitivities(end, false).S;
  const auto moved = [&](int j, double by) {
    Vector x = start;
    if (j == 1) x[2] += by;
    if (j == 2) x[5] += by;
    return end_of_rope(g + (j == 0 ? by : 0.0), x, end);
  };
  for (int j = 0; j < 3; ++j) {
    const Vector above = moved(j, step), below = moved(j, -step);
    double size = 1.0;
    for (int i = 0; i < 5; ++i) size = std::max(size, std::fabs(S(i, j)));
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(S(i, j), (above[std::size_t(i)] - below[std::size_t(i)]) / (2.0 * step), 1e-5 * size)
          << i << ", " << j;
  }
}

// ---- Random systems ----------------------------------------------------------------------------------------------

Vector end_of_random(const RandomModes& modes, double p, const Vector& start, double end) {
  System system = modes.system(solver_options(1e-12, SFDAE_METHOD_RADAU));
  system.set_parameter("p", p);
  Point point{0.0, start, {}};
  system.hybrid.start(0, point, end);
  system.hybrid.advance(end, point);
  return point.x;
}

TEST_P(HybridSensitivities, AgreeWithDifferencesOfRandomSystems) {
  constexpr double end = 5.0, step = 1e-5;
  const Vector start = {0.3, -0.2, 0.4, 0.0};
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomModes modes(seed);
    System system = modes.system(solver_options(1e-9, GetParam()));
    system.hybrid.set_sensitivities(by({"p", ""}, unit_directions(4, 2, 1, {1})));
    Point point{0.0, start, {}};
    system.hybrid.start(0, point, end);
    system.hybrid.advance(end, point);
    EXPECT_GE(system.hybrid.num_passages(), 3);
    const Matrix S = system.hybrid.sensitivities(end, false).S;
    for (int j = 0; j < 2; ++j) {
      const auto moved = [&](double by) {
        Vector x = start;
        if (j == 1) x[1] += by;
        return end_of_random(modes, 0.7 + (j == 0 ? by : 0.0), x, end);
      };
      const Vector above = moved(step), below = moved(-step);
      double size = 1.0;
      for (int i = 0; i < 4; ++i) size = std::max(size, std::fabs(S(i, j)));
      for (int i = 0; i < 4; ++i)
        EXPECT_NEAR(S(i, j), (above[std::size_t(i)] - below[std::size_t(i)]) / (2.0 * step), 2e-6 * size)
            << i << ", " << j;
    }
  }
}

// ---- Transitions at once -----------------------------------------------------------------------------------------

// Mode 1 is left where it begins: x jumps from 2 x + 1 to its square, at the time of the first transition, x = p.
TEST_P(HybridSensitivities, GoThroughModesThatAreLeftAtOnce) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - sfdae::parameter(t, "rate", 0.5) * x[0];
    F[1] = xdot[1];
  };
  System system;
  for (int k = 0; k < 3; ++k) system.add(problem, solver_options(1e-10, GetParam()));
  sfdae::Transition first, second;
  first.to = second.from = 1;
  second.to = 2;
  first.kind = SFDAE_TRANSITION_ZERO;
  first.function = [](double, auto x, auto) { return x[0] - x[1]; };
  first.jump = [](double, auto x) { x[0] = 2.0 * x[0] + 1.0; };
  second.function = [](double, auto x, auto) { return x[0] - 1.0; };
  second.jump = [](double, auto x) { x[0] = x[0] * x[0]; };
  system.hybrid.add_transition(first);
  system.hybrid.add_transition(second);
  system.hybrid.set_sensitivities(by({"rate", "", ""}, unit_directions(2, 3, 1, {0, 1})));
  Point point{0.0, {1.0, 1.5}, {}};
  system.hybrid.start(0, point, 2.0);
  system.hybrid.advance(2.0, point);
  ASSERT_EQ(system.hybrid.num_passages(), 2);
  const auto value = [](double rate, double x, double level) {
    const double at = std::log(level / x) / rate, after = (2.0 * level + 1.0) * (2.0 * level + 1.0);
    return after * std::exp(rate * (2.0 - at));
  };
  EXPECT_NEAR(point.x[0], value(0.5, 1.0, 1.5), 1e-7);
  const Matrix S = system.hybrid.sensitivities(2.0).S;
  for (int j = 0; j < 3; ++j) {
    const auto moved = [&](double by) {
      return value(0.5 + (j == 0 ? by : 0.0), 1.0 + (j == 1 ? by : 0.0), 1.5 + (j == 2 ? by : 0.0));
    };
    EXPECT_NEAR(S(0, j), (moved(1e-5) - moved(-1e-5)) / 2e-5, 1e-5) << j;
  }
}

// ---- Values that stay --------------------------------------------------------------------------------------------

// x_1 (r x_0 + 2) = 2 after t = 1, with a number before: the values after are those before, and r moves them.
TEST_P(HybridSensitivities, AreThoseOfConstraintsThatBeginToDependOnAParameter) {
  System system;
  for (const bool is_second : {false, true}) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [is_second](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] + 0.0 * t;
      F[1] = x[1] * ((is_second ? sfdae::parameter(t, "r", 3.0) : 3.0 + 0.0 * t) * x[0] + 2.0) - 2.0;
    };
    system.add(problem, solver_options(1e-9, GetParam()));
  }
  sfdae::Transition transition;
  transition.to = 1;
  transition.kind = SFDAE_TRANSITION_TIME;
  transition.time = 1.0;
  system.hybrid.add_transition(transition);
  system.hybrid.set_sensitivities(by({"r"}));
  Point point{0.0, {1.0, 0.4}, {}};
  system.hybrid.start(0, point, 2.0);
  system.hybrid.advance(2.0, point);
  EXPECT_NEAR(system.hybrid.sensitivities(2.0).S(1, 0), -2.0 / 25.0, 1e-9);
}

// ---- Steps that say little ---------------------------------------------------------------------------------------

// x' = rate x passes 1 soon after the start, at t = wait, and jumps to x^2 + sin 2t: steps before it are as short.
TEST_P(HybridSensitivities, AreAccurateAfterTinySteps) {
  for (double wait : {1e-3, 1e-6, 1e-9, 1e-12}) {
    SCOPED_TRACE(wait);
    sfdae::NonlinearProblem problem(1, 1);
    problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - sfdae::parameter(t, "rate", 0.5) * x[0];
    };
    System system;
    for (int k = 0; k < 2; ++k) system.add(problem, solver_options(1e-10, GetParam()));
    sfdae::Transition transition;
    transition.to = 1;
    transition.kind = SFDAE_TRANSITION_ZERO;
    transition.function = [](double, auto x, auto) { return x[0] - 1.0; };
    transition.jump = [](double t, auto x) { x[0] = x[0] * x[0] + std::sin(2.0 * t); };
    system.hybrid.add_transition(transition);
    system.hybrid.set_sensitivities(by({""}, unit_directions(1, 1, 0, {0})));
    const double start = std::exp(-0.5 * wait);
    Point point{0.0, {start}, {}};
    system.hybrid.start(0, point, 1.0);
    ASSERT_EQ(system.hybrid.advance_to_transition(1.0, point), SFDAE_EVENT);
    // x + S dx on both sides: t moves by -2 dx / start, x after it by 2 cos 2t times that, and by -x'/start through
    // the delay.
    const double dt = -2.0 / start;
    EXPECT_NEAR(system.hybrid.passage_sensitivities()[0], dt, 1e-9);
    const double after = 1.0 + std::sin(2.0 * point.t);
    const double expected = 2.0 * std::cos(2.0 * point.t) * dt - 0.5 * after * dt;
    EXPECT_NEAR(system.hybrid.sensitivities(point.t, false).S(0, 0), expected, 1e-8);
  }
}

// x = v sin t passes 1 with a rate of sqrt(v^2 - 1). Where that is no more than what tolerances leave of x it is named.
TEST_P(HybridSensitivities, AreNamedWhereAFunctionTouchesZero) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + x[0];
  };
  int named = 0, right = 0;
  for (double more = 1e-15; more < 0.1; more *= 3.0) {
    SCOPED_TRACE(more);
    System system;
    for (int k = 0; k < 2; ++k) system.add(problem, solver_options(1e-8, GetParam()));
    sfdae::Transition transition;
    transition.to = 1;
    transition.kind = SFDAE_TRANSITION_ZERO;
    transition.direction = 1;
    transition.function = [](double, auto x, auto) { return x[0] - 1.0; };
    system.hybrid.add_transition(transition);
    system.hybrid.set_sensitivities(by({""}, unit_directions(2, 1, 0, {1})));
    Point point{0.0, {0.0, 1.0 + more}, {}};
    system.hybrid.start(0, point, 2.0);
    try {
      if (system.hybrid.advance_to_transition(2.0, point) != SFDAE_EVENT) continue;
      const double exact = -1.0 / ((1.0 + more) * std::sqrt(more * (2.0 + more)));
      EXPECT_NEAR(system.hybrid.passage_sensitivities()[0], exact, 0.1 * std::fabs(exact));
      ++right;
    } catch (const sfdae::Error& error) {
      EXPECT_EQ(error.status(), SFDAE_SINGULAR) << error.what();
      EXPECT_NE(std::string(error.what()).find("touches zero"), std::string::npos) << error.what();
      EXPECT_LT(more, 1e-6);
      ++named;
    }
  }
  EXPECT_GE(right, 10);
  EXPECT_GE(named + right, 10);
}

// ---- Derivatives by t --------------------------------------------------------------------------------------------

// Events are searched for without x', which is there at all points that are returned: sin 2 pi t = x_0 through a
// diode that conducts (without differential equations) or not, C x_0' = -x_0 / R.
TEST_P(HybridSensitivities, AreFoundWithSlopesWherePointsAreReturned) {
  const double pi = std::acos(-1.0);
  System system;
  sfdae::Options options = solver_options(1e-8, GetParam());
  options.max_step = 0.1;
  options.max_steps = GetParam() == SFDAE_METHOD_BDF ? 5 : 1;
  for (bool conducts : {false, true}) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] + sfdae::parameter(t, "rate", 1.0) * x[0] - x[1];
      F[1] = x[2] - (sin(2.0 * pi * t) - x[0]);
      F[2] = conducts ? x[2] + 0.0 * t : x[1] + 0.0 * t;
    };
    system.add(problem, options);
  }
  for (int k = 0; k < 2; ++k) {
    sfdae::Transition transition;
    transition.from = k;
    transition.to = 1 - k;
    transition.function = [k](double, auto x, auto) { return k == 0 ? x[2] : -x[1]; };
    system.hybrid.add_transition(transition);
  }
  system.hybrid.set_sensitivities(by({"rate"}));
  Point point{0.0, {0.0, 0.0, 0.0}, {}};
  system.hybrid.start(0, point, 3.0);
  int seen[2] = {0, 0}, stopped = 0;
  for (double t = 0.05; t < 3.0;) {
    try {
      system.hybrid.advance(t, point);
      t += 0.17;
    } catch (const sfdae::Error& error) {
      ASSERT_EQ(error.status(), SFDAE_MAX_STEPS) << error.what();
      ++stopped;
    }
    const bool conducts = system.hybrid.current_mode() == 1;
    const double rate = 2.0 * pi * std::cos(2.0 * pi * point.t);
    ++seen[conducts ? 1 : 0];
    EXPECT_NEAR(point.xdot[0], conducts ? rate : -point.x[0], 1e-5) << point.t;
    EXPECT_NEAR(point.xdot[2], conducts ? 0.0 : rate + point.x[0], 1e-5) << point.t;
  }
  EXPECT_GE(seen[0], 5);
  EXPECT_GE(seen[1], 3);
  EXPECT_GE(stopped, 3);
}

// ---- Checkpoints -------------------------------------------------------------------------------------------------

TEST_P(HybridSensitivities, GoOnFromCheckpointsInEveryBit) {
  const auto make = [&] {
    System system = rope(solver_options(1e-7, GetParam()));
    system.hybrid.set_sensitivities(by({"g", ""}, unit_directions(6, 2, 1, {5})));
    return system;
  };
  System plain = make();
  auto broken = std::make_unique<System>(make());
  Point x{0.0, {0.3, 0.2, 0.5, 0.1, 0.0, 1.0}, {}}, y = x;
  plain.hybrid.start(0, x, 1.0);
  broken->hybrid.start(0, y, 1.0);
  for (int k = 1; k <= 20; ++k) {
    const Vector checkpoint = broken->hybrid.save_checkpoint();
    broken.reset();  // solvers outlive the system that they are modes of
    broken = std::make_unique<System>(make());
    broken->hybrid.restore_checkpoint(checkpoint);
    const int status = plain.hybrid.advance_to_transition(0.05 * k, x);
    ASSERT_EQ(broken->hybrid.advance_to_transition(0.05 * k, y), status);
    ASSERT_EQ(x.x, y.x) << k;
    const Matrix S = plain.hybrid.sensitivities(x.t).S, R = broken->hybrid.sensitivities(x.t).S;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 6; ++i) ASSERT_EQ(S(i, j), R(i, j)) << k;
    if (plain.hybrid.num_passages() > 0) {
      EXPECT_EQ(plain.hybrid.passage_sensitivities(), broken->hybrid.passage_sensitivities());
    }
  }
  EXPECT_EQ(plain.hybrid.num_passages(), 1);
  const Vector checkpoint = broken->hybrid.save_checkpoint();
  System without = rope(solver_options(1e-7, GetParam()));
  try {
    without.hybrid.restore_checkpoint(checkpoint);
    FAIL();
  } catch (const sfdae::Error& error) {
    EXPECT_NE(std::string(error.what()).find("sfdae_set_hybrid_sensitivities"), std::string::npos) << error.what();
  }
  System other = rope(solver_options(1e-7, GetParam()));
  other.hybrid.set_sensitivities(by({"", "g"}));
  EXPECT_THROW(other.hybrid.restore_checkpoint(checkpoint), sfdae::Error);
}

// ---- What has no sensitivities -----------------------------------------------------------------------------------

std::string failure_of(const std::function<void()>& call, int status) {
  try {
    call();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
    return error.what();
  }
  return "";
}

sfdae::NonlinearProblem growth() {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - sfdae::parameter(t, "p", 1.0) + 0.0 * x[0];
  };
  return problem;
}

System with_function(sfdae::TransitionFunction function, sfdae::JumpFunction jump = {}) {
  System system;
  for (int k = 0; k < 2; ++k) system.add(growth(), solver_options(1e-8, SFDAE_METHOD_BDF));
  sfdae::Transition transition;
  transition.to = 1;
  transition.kind = SFDAE_TRANSITION_ZERO;
  transition.function = std::move(function);
  transition.jump = std::move(jump);
  system.hybrid.add_transition(transition);
  system.hybrid.set_sensitivities(by({"p"}));
  return system;
}

std::string end_of(System system, int status) {
  Point point{0.0, {0.0}, {}};
  system.hybrid.start(0, point, 3.0);
  return failure_of([&] { system.hybrid.advance(3.0, point); }, status);
}

TEST(WithoutHybridSensitivities, TransitionsAreNamed) {
  const auto level = [](double, auto x, auto) { return x[0] - 1.0; };
  EXPECT_EQ(end_of(with_function(level), SFDAE_OK), "");
  // The kink of |x - 1| is not met: x = 1 at the transition, whatever p.
  EXPECT_EQ(end_of(with_function(level, [](double, auto x) { x[0] = std::fabs(x[0] - 1.0); }), SFDAE_OK), "");
  EXPECT_NE(
      end_of(with_function([](double, auto x, auto xdot) { return x[0] + xdot[0] - 2.0; }), SFDAE_ILLEGAL_ARGUMENT)
          .find("x'"),
      std::string::npos);
  // Where x' counts only if it is small, it is found as well.
  EXPECT_NE(end_of(with_function([](double t, auto x, auto xdot) { return std::min(x[0] - 1.0, xdot[0] + t - 2.5); }),
                   SFDAE_ILLEGAL_ARGUMENT)
                .find("x'"),
            std::string::npos);
  // The root of x - 1 from both sides, with its sign: its rate is infinite.
  EXPECT_NE(end_of(with_function([](double, auto x, auto) { return std::cbrt(x[0] - 1.0); }), SFDAE_SINGULAR)
                .find("no derivative"),
            std::string::npos);
  EXPECT_NE(end_of(with_function(level, [](double t, auto x) { x[0] = std::fabs(t - 1.0); }), SFDAE_SINGULAR)
                .find("no derivative"),
            std::string::npos);
}

}  // namespace
