// SPDX-License-Identifier: BSD-3-Clause
//
// Jumps by impulses that sensitivities are carried over: their equations differentiated.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hybrid_systems.h"
#include "sfdae/hybrid.hpp"
#include "solver_options.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::by;
using sfdae_test::rope;
using sfdae_test::solver_options;
using sfdae_test::System;
using Vector = std::vector<double>;

class HybridJumpDerivatives : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, HybridJumpDerivatives, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// The unit of velocities, which depends on all that a factor of x' may: a parameter q, t and what does not jump.
constexpr double q_in_use = 0.5;
template <class Number>
Number unit_of_velocity(const Number& t, const Number& q, const Number& x) {
  using std::cos;
  return 2.0 + cos(t) + 0.3 * q + 0.1 * x;
}

// The rope of hybrid_systems.h with velocities in that unit.
System rope_in_other_units(const sfdae::Options& options) {
  System system;
  for (const bool is_tight : {false, true}) {
    sfdae::NonlinearProblem problem(6, 6);
    problem.equations = [is_tight](const Expression& t, auto x, auto xdot, auto F) {
      const Expression unit = unit_of_velocity<Expression>(t, sfdae::parameter(t, "q", q_in_use), x[0]);
      for (int i = 0; i < 2; ++i) {
        F[i] = xdot[i] - unit * x[i + 2];
        F[i + 2] = unit * xdot[i + 2] + (0.1 * xdot[0] - sin(t)) * x[i + 2] + x[i] * x[4];
      }
      F[3] = F[3] + sfdae::parameter(t, "g", 9.81);
      if (is_tight) F[4] = x[0] * x[0] + x[1] * x[1] - x[5] * x[5];
      else F[4] = x[4] + 0.0 * t;
      F[5] = xdot[5];
    };
    system.add(problem, options);
  }
  sfdae::Transition tight;
  tight.to = 1;
  tight.kind = SFDAE_TRANSITION_ZERO;
  tight.direction = 1;
  tight.function = [](double, auto x, auto) { return x[0] * x[0] + x[1] * x[1] - x[5] * x[5]; };
  system.hybrid.add_transition(tight);
  return system;
}

// After the jump factors of what jumps have moved with t, x, q: whatever the unit, velocities move as they do in the
// plain one.
TEST_P(HybridJumpDerivatives, DoNotDependOnUnitsThatMove) {
  const sfdae::Options options = solver_options(1e-9, GetParam());
  constexpr double end = 1.2;
  Vector x = {0.3, 0.2, 0.5, 0.1, 0.0, 1.0};
  const std::vector<std::string> parameters = {"g", "q", "", ""};
  Matrix directions(6, 4);
  directions(2, 2) = directions(5, 3) = 1.0;
  System plain = rope(options);
  plain.hybrid.set_sensitivities(by({"g", "", "", ""}, directions));
  System other = rope_in_other_units(options);
  const double unit = unit_of_velocity(0.0, q_in_use, x[0]);
  directions(2, 2) /= unit;
  for (int i = 2; i < 4; ++i) directions(i, 1) = -x[std::size_t(i)] * 0.3 / (unit * unit);
  other.hybrid.set_sensitivities(by(parameters, directions));
  Point at{0.0, x, {}}, there{0.0, x, {}};
  for (int i = 2; i < 4; ++i) there.x[std::size_t(i)] /= unit;
  plain.hybrid.start(0, at, end);
  other.hybrid.start(0, there, end);
  for (const bool is_transition : {true, false}) {
    for (auto [system, point] : {std::pair{&plain, &at}, std::pair{&other, &there}}) {
      if (is_transition) ASSERT_EQ(system->hybrid.advance_to_transition(end, *point), SFDAE_EVENT);
      else system->hybrid.advance(end, *point);
    }
    const Matrix S = plain.hybrid.sensitivities(at.t, false).S;
    const Matrix found = other.hybrid.sensitivities(there.t, false).S;
    const double now = unit_of_velocity(there.t, q_in_use, there.x[0]);
    for (int j = 0; j < 4; ++j) {
      const double by_q = j == 1 ? 0.3 : 0.0;
      for (int i = 0; i < 4; ++i) {
        const double moved =
            i < 2 ? found(i, j) : now * found(i, j) + (by_q + 0.1 * found(0, j)) * there.x[std::size_t(i)];
        EXPECT_NEAR(moved, S(i, j), 1e-6 * (1.0 + std::fabs(S(i, j)))) << is_transition << ", " << i << ", " << j;
      }
    }
  }
}

// A length that only the second mode knows: with another one the mass is not on the circle when the rope is tight,
// and no impulse brings it there. The linearized equations do, by an impulse of higher order.
TEST_P(HybridJumpDerivatives, AreRefusedWherePositionsWouldHaveToJump) {
  System system;
  const sfdae::Options options = solver_options(1e-8, GetParam());
  for (const bool is_tight : {false, true}) {
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [is_tight](const Expression& t, auto x, auto xdot, auto F) {
      for (int i = 0; i < 2; ++i) {
        F[i] = xdot[i] - x[i + 2];
        F[i + 2] = xdot[i + 2] + x[i] * x[4];
      }
      F[3] = F[3] + 9.81;
      const Expression length = sfdae::parameter(t, "length", 1.0);
      if (is_tight) F[4] = x[0] * x[0] + x[1] * x[1] - length * length;
      else F[4] = x[4] + 0.0 * length;
    };
    system.add(problem, options);
  }
  sfdae::Transition tight;
  tight.to = 1;
  tight.kind = SFDAE_TRANSITION_ZERO;
  tight.direction = 1;
  tight.function = [](double, auto x, auto) { return x[0] * x[0] + x[1] * x[1] - 1.0; };
  system.hybrid.add_transition(tight);
  const auto end_with = [&](const std::vector<std::string>& parameters) {
    system.hybrid.set_sensitivities(by(parameters));
    Point point{0.0, {0.3, 0.2, 0.5, 0.1, 0.0}, {}};
    system.hybrid.start(0, point, 1.0);
    system.hybrid.advance(1.0, point);
  };
  EXPECT_NO_THROW(end_with({""}));
  try {
    end_with({"length"});
    ADD_FAILURE() << "a length that positions would have to jump for is differentiated";
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_NO_CONSISTENT_VALUES) << error.what();
    EXPECT_EQ(system.hybrid.num_passages(), 0);
  }
}

// Two modes of three differential equations with twelve parameters, and a constraint that x jumps to in the second one.
System modes_with_parameters(int count) {
  System system;
  for (const int mode : {0, 1}) {
    sfdae::NonlinearProblem problem(4, 4);
    problem.equations = [mode](const Expression& t, auto x, auto xdot, auto F) {
      const auto p = [&](int i, int j) {
        return sfdae::parameter(t, "p" + std::to_string(3 * i + j), 0.3 * std::sin(1.0 + 2.7 * (3 * i + j)));
      };
      for (int i = 0; i < 3; ++i) {
        F[i] = xdot[i] - (1.0 + 0.3 * i) * x[3];
        for (int j = 0; j < 3; ++j) F[i] = F[i] - (mode == 0 ? 1.0 : -1.0) * p(i, j) * x[j];
      }
      F[3] = (mode == 0 ? x[3] : 0.0 * x[3]) + x[0] + 0.5 * x[1] * x[1] - sin(2.0 * t);
      for (int j = 0; j < 3; ++j) F[3] = F[3] + 0.2 * p(3, j) * x[j];
    };
    system.add(problem, solver_options(1e-6, SFDAE_METHOD_RADAU));
  }
  sfdae::Transition next;
  next.to = 1;
  next.kind = SFDAE_TRANSITION_TIME;
  next.time = 0.5;
  system.hybrid.add_transition(next);
  std::vector<std::string> names;
  for (int j = 0; j < count; ++j) names.push_back("p" + std::to_string(j));
  system.hybrid.set_sensitivities(by(names));
  return system;
}

// Equations are evaluated as often for all parameters as for one.
TEST(HybridJumpWork, DoesNotGrowWithParameters) {
  long linearizations[2];
  for (const int k : {0, 1}) {
    System system = modes_with_parameters(k == 0 ? 1 : 12);
    Point point{0.0, {0.1, 0.2, 0.3, 0.0}, {}};
    system.hybrid.start(0, point, 1.0);
    ASSERT_EQ(system.hybrid.advance_to_transition(1.0, point), SFDAE_EVENT);
    linearizations[k] = system.solvers[1]->statistics().linearizations;
  }
  EXPECT_EQ(linearizations[1], linearizations[0]);
}

}  // namespace
