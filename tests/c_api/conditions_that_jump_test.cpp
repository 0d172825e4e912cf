// SPDX-License-Identifier: BSD-3-Clause
//
// Conditions on unknowns at which others jump, since derivatives of equations determine these.

#include <sfdae/sfdae.hpp>
#include <sfdae/solution.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;

constexpr double end = 2.0;

std::vector<sfdae::Options> all_options(double tolerance = 1e-6) {
  std::vector<sfdae::Options> all;
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC}) {
      sfdae::Options options;
      options.method = method;
      options.structure = structure;
      options.rtol = options.atol = tolerance;
      all.push_back(options);
    }
  return all;
}

std::string text_of(const sfdae::Options& options) {
  return "method " + std::to_string(options.method) + ", structure " + std::to_string(options.structure);
}

template <class Equations>
sfdae::NonlinearProblem problem_of(int n, Equations equations) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = equations;
  return problem;
}

// Two capacitors of 1 F, the second with 1 Ohm beside it, divide a voltage that steps when a clock passes 1.
// x = (current, voltage of the second one, source, clock).
sfdae::NonlinearProblem divider() {
  return problem_of(4, [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = x[0] - (xdot[2] - xdot[1]);
    F[1] = (xdot[2] - xdot[1]) - xdot[1] - x[1];
    F[2] = x[2] - choose(x[3] > 1.0, 1.0, 0.0);
    F[3] = xdot[3] - 1.0;
  });
}
const Vector at_rest(4, 0.0);
double divided(double t) { return 0.5 * std::exp(0.5 * (1.0 - t)); }

TEST(Conditions, AtWhichUnknownsJump) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(divider(), options);
    sfdae::Point point{0.0, at_rest, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(0.9, point), SFDAE_OK);
    EXPECT_EQ(point.x[1], 0.0);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[1], divided(end), 1e-6) << text_of(options);
    const sfdae::Jump jump = solver.last_jump();
    EXPECT_NEAR(jump.t, 1.0, 1e-7);
    EXPECT_NEAR(jump.after[1] - jump.before[1], 0.5, 1e-6);
    EXPECT_NEAR(jump.impulses(0, 0), 0.5, 1e-6);  // of the current: the charge
  }
}

TEST(Conditions, AtWhichUnknownsJumpBackward) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(divider(), options);
    sfdae::Point point{end, {0.0, divided(end), 1.0, end}, {}};
    solver.start(point, 0.0);
    ASSERT_EQ(solver.advance(0.5, point), SFDAE_OK);
    EXPECT_NEAR(point.x[1], 0.0, 1e-5) << text_of(options);
  }
}

// The velocity of a crane along a ramp jumps, and with it what else adds the velocity up. A cascade: a second condition
// switches because of the jump of the first.
TEST(Conditions, OfRampsAndOfOtherJumps) {
  const auto crane = problem_of(5, [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = x[0] - max(x[3] - 1.0, 0.0);
    F[1] = xdot[0] - x[1];
    F[2] = xdot[1] - x[2];
    F[3] = xdot[3] - 1.0;
    F[4] = xdot[4] - x[1];
  });
  const auto cascade = problem_of(5, [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = x[0] - choose(x[4] > 1.0, 1.0, 0.0);
    F[3] = x[1] - choose(x[0] > 0.5, 2.0, 0.0);
    F[4] = xdot[4] - 1.0;
  });
  for (const sfdae::Options& options : all_options()) {
    sfdae::Point point{0.0, Vector(5, 0.0), {}};
    sfdae::Solver solver(crane, options);
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    for (int i : {0, 1, 4}) EXPECT_NEAR(point.x[static_cast<std::size_t>(i)], 1.0, 1e-5) << text_of(options);
    sfdae::Point other{0.0, Vector(5, 0.0), {}};
    sfdae::Solver second(cascade, options);
    second.start(other, end);
    ASSERT_EQ(second.advance(end, other), SFDAE_OK);
    EXPECT_NEAR(other.x[0], 1.0, 1e-6);
    EXPECT_NEAR(other.x[1], 2.0, 1e-6) << text_of(options);
  }
}

// Algebraic equations have no solution near the one before.
TEST(Conditions, BeyondWhichSolutionsAreFar) {
  const auto problem = problem_of(2, [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = x[0] * x[0] - choose(x[1] > 1.0, 0.25, 1.0);
    F[1] = xdot[1] - 1.0;
  });
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {1.0, 0.0}, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[0], 0.5, 1e-6) << text_of(options);
  }
}

// Two conditions switch within one step, of which both ends are the same.
TEST(Conditions, OfPulses) {
  const double width = 0.003;
  const auto problem =
      problem_of(5, [=](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - x[1];
        F[1] = x[0] - x[2];
        F[2] = x[2] - choose(x[3] > 1.0 && x[3] < 1.0 + width, 1.0, 0.0);
        F[3] = xdot[3] - 1.0;
        F[4] = xdot[4] - x[2];
      });
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, Vector(5, 0.0), {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[4], width, 1e-5) << text_of(options);
  }
}

// Floors, remainders and tables of unknowns have branches that cannot be held: where these make unknowns jump, the call
// ends by name. Where they do not, it goes on.
TEST(Conditions, OfFloorsAndTablesAreNamedWhereUnknownsJump) {
  struct Law {
    Expression (*value)(const Expression&);
    double at_start;
  };
  const Law laws[] = {{[](const Expression& z) { return floor(z + 0.3); }, 0.0},
                      {[](const Expression& z) { return modulo(z + 0.3, 1.0); }, 0.3},
                      {[](const Expression& z) {
                         return sfdae::table(z, 1, {-1.0, 0.7, 3.0}, {1.7, 0.0, 2.3});
                       },
                       0.7}};
  for (const Law& law : laws)
    for (bool has_jump : {true, false})
      for (const sfdae::Options& options : all_options()) {
        // p = law(z), v = p', a = v', s' = v' + v; or p = z, and y' = law(z).
        const auto problem =
            problem_of(5, [=](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
              F[0] = x[0] - (has_jump ? law.value(x[3]) : x[3]);
              F[1] = xdot[0] - x[1];
              F[2] = xdot[1] - x[2];
              F[3] = xdot[3] - 1.0;
              F[4] = xdot[4] - (has_jump ? x[2] + x[1] : law.value(x[3]));
            });
        sfdae::Solver solver(problem, options);
        sfdae::Point point{0.0, {has_jump ? law.at_start : 0.0, 0.0, 0.0, 0.0, 0.0}, {}};
        solver.start(point, end);
        try {
          ASSERT_EQ(solver.advance(1.2, point), SFDAE_OK);
          EXPECT_FALSE(has_jump) << text_of(options);
        } catch (const sfdae::Error& error) {
          EXPECT_TRUE(has_jump) << error.what();
          EXPECT_EQ(error.status(), SFDAE_STEP_TOO_SMALL) << error.what();
          EXPECT_NEAR(point.t, 0.7, 1e-6) << error.what();
        }
      }
}

// Both branches lead back to the zero, and the derivative of the relay is needed: its smooth part is found along the
// surface, or the call ends there by name.
TEST(Conditions, ThatLeadTowardEachOtherAreFollowedOrNamed) {
  const auto problem =
      problem_of(3, [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] + sign(x[0]) - 0.5 * cos(t);
        F[1] = x[1] - sign(x[0]);
        F[2] = xdot[1] - x[2];
      });
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {1.0, 1.0, 0.0}, {}};
    solver.start(point, 3.0);
    try {
      solver.advance(3.0, point);
      EXPECT_NEAR(point.x[1], 0.5 * std::cos(3.0), 1e-4) << text_of(options);
      EXPECT_NEAR(point.x[2], -0.5 * std::sin(3.0), 1e-2) << text_of(options);
    } catch (const sfdae::Error& error) {
      EXPECT_TRUE(error.status() == SFDAE_ZENO || error.status() == SFDAE_NO_CONSISTENT_VALUES) << error.what();
      EXPECT_NEAR(point.t, 1.4987, 1e-3);
    }
  }
}

// An event at the zero itself has the values before the jump or those after it, and the jump is not lost.
TEST(Conditions, WithEventsAtTheSameTime) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(divider(), options);
    solver.set_events(1, [](double, auto x, auto, auto g) { g[0] = x[3] - 1.0; });
    sfdae::Point point{0.0, at_rest, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_EVENT) << text_of(options);
    EXPECT_NEAR(point.t, 1.0, 1e-7);
    EXPECT_NEAR(point.x[1], 0.5 * point.x[2], 1e-6) << text_of(options);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    EXPECT_NEAR(point.x[1], divided(end), 1e-6) << text_of(options);
  }
}

// The same divider by functions that the library calls, of which it does not know when they switch: after 1 s, or with
// the clock. Linear and nonlinear problems are different systems.
TEST(Conditions, OfFunctionsThatNobodyHasDeclared) {
  for (const double moment : {1.0, 0.3217}) {
    // No more derivatives than mu = 1 needs: x' at the end of a step is not known.
    sfdae::LinearProblem short_of_derivatives(3, 3);
    short_of_derivatives.E = [](double, int order, sfdae::MatrixRef E) {
      if (order > 1) return SFDAE_ORDER_NOT_AVAILABLE;
      if (order == 0) E(0, 1) = E(1, 2) = 1.0, E(0, 2) = -1.0, E(1, 1) = -2.0;
      return 0;
    };
    sfdae::NonlinearProblem nonlinear(3, 3);
    nonlinear.total_derivative = [moment](double t, int k, sfdae::ConstMatrixRef x, sfdae::TotalDerivatives to) {
      to.F[0] = x(0, k) - (x(2, k + 1) - x(1, k + 1));
      to.F[1] = x(2, k + 1) - 2.0 * x(1, k + 1) - x(1, k);
      to.F[2] = x(2, k) - (k == 0 && t > moment ? 1.0 : 0.0);
      if (k > 0) return;
      if (to.F_x) to.F_x(0, 0) = to.F_x(2, 2) = 1.0, to.F_x(1, 1) = -1.0;
      if (!to.F_xdot) return;
      to.F_xdot(0, 1) = to.F_xdot(1, 2) = 1.0;
      to.F_xdot(0, 2) = -1.0;
      to.F_xdot(1, 1) = -2.0;
    };
    sfdae::LinearProblem linear(3, 3);
    linear.E = [](double, int order, sfdae::MatrixRef E) {
      if (order > 0) return;
      E(0, 1) = E(1, 2) = 1.0;
      E(0, 2) = -1.0;
      E(1, 1) = -2.0;
    };
    linear.A = [](double, int order, sfdae::MatrixRef A) {
      if (order == 0) A(0, 0) = A(2, 2) = -1.0, A(1, 1) = 1.0;
    };
    linear.f = [moment](double t, int order, sfdae::VectorRef f) { f[2] = order == 0 && t > moment ? 1.0 : 0.0; };
    short_of_derivatives.A = linear.A;
    short_of_derivatives.f = linear.f;
    for (const sfdae::Options& options : all_options()) {
      const auto expect_right = [&](sfdae::Solver solver) {
        sfdae::Point point{0.0, Vector(3, 0.0), {}};
        solver.start(point, end);
        ASSERT_EQ(solver.advance(end, point), SFDAE_OK) << text_of(options);
        EXPECT_NEAR(point.x[1], 0.5 * std::exp(0.5 * (moment - end)), 1e-5) << text_of(options);
        EXPECT_NEAR(solver.last_jump().t, moment, 1e-9) << text_of(options);
        EXPECT_LT(solver.statistics().steps, 400) << text_of(options);
      };
      expect_right(sfdae::Solver(nonlinear, options));
      expect_right(sfdae::Solver(linear, options));
      if (options.structure == SFDAE_STRUCTURE_OFF) expect_right(sfdae::Solver(short_of_derivatives, options));
    }
  }
}

// A pendulum with drag c |v| v: momentum equations have kinks, which nothing that is differentiated contains. Nothing
// jumps there, however loose tolerances are, and whether impulses would be determined does not matter.
TEST(Conditions, OfDragLeaveUnknownsContinuous) {
  for (const double c : {0.01, 0.1, 1.0}) {
    const auto pendulum =
        problem_of(5, [c](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
          F[0] = xdot[0] - x[2];
          F[1] = xdot[1] - x[3];
          F[2] = xdot[2] + x[4] * x[0] + c * abs(x[2]) * x[2];
          F[3] = xdot[3] + x[4] * x[1] + 9.81 + c * abs(x[3]) * x[3];
          F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
        });
    const auto angle_at_end = [&](const sfdae::Options& options) {
      sfdae::Solver solver(pendulum, options);
      sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
      solver.start(point, 10.0);
      EXPECT_EQ(solver.advance(10.0, point), SFDAE_OK) << text_of(options);
      EXPECT_THROW(solver.last_jump(), sfdae::Error);  // there is none
      return std::atan2(point.x[0], -point.x[1]);
    };
    const double expected = angle_at_end(all_options(1e-9)[2]);
    for (const double tolerance : {1e-3, 1e-4, 1e-6})
      for (const sfdae::Options& options : all_options(tolerance))
        EXPECT_NEAR(angle_at_end(options), expected, 200.0 * tolerance) << text_of(options) << ", c = " << c;
  }
}

// Pulses of unit area where an unknown passes an interval, in equations that nothing differentiates: the ends of steps
// do not show them. Conditions: both ends by themselves, one distance, products, squares, one within the other.
TEST(Conditions, OfPulsesBetweenTheEndsOfSteps) {
  constexpr double from = 0.7371;
  const auto pulse = [=](int kind, const Expression& z, double width) -> Expression {
    const double to = from + width, middle = from + 0.5 * width;
    switch (kind) {
      case 0: return sfdae::choose(z > from, 1.0, 0.0) * sfdae::choose(z < to, 1.0, 0.0);
      case 1: return sfdae::choose(sfdae::abs(z - middle) < 0.5 * width, 1.0, 0.0);
      case 2: return sfdae::choose((z - from) * (z - to) < 0.0, 1.0, 0.0);
      case 3: return sfdae::choose(sfdae::pow(z - middle, 2.0) < 0.25 * width * width, 1.0, 0.0);
      case 4: return sfdae::choose(z > from, sfdae::choose(z > to, 0.0, 1.0), 0.0);
      default: return 2.0 * sfdae::max(1.0 - sfdae::abs(z - middle) / (0.5 * width), 0.0);
    }
  };
  for (int kind = 0; kind < 6; ++kind)
    for (const double width : {0.1, 1e-3, 1e-5, 1e-7}) {
      if (kind == 5 && width < 1e-5) continue;  // slopes of 1e14 hide the other numbers
      const auto problem =
          problem_of(3, [&](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
            F[0] = xdot[0] - 0.5 * pulse(kind, x[1], width) / width;
            F[1] = xdot[1] - 1.0;
            F[2] = x[2] - 2.0 * x[0];
          });
      for (const sfdae::Options& options : all_options()) {
        sfdae::Solver solver(problem, options);
        sfdae::Point point{0.0, Vector(3, 0.0), {}};
        solver.start(point, end);
        ASSERT_EQ(solver.advance(end, point), SFDAE_OK) << text_of(options);
        EXPECT_NEAR(point.x[0], 0.5, 1e-4) << text_of(options) << ", kind " << kind << ", width " << width;
        EXPECT_NEAR(point.x[2], 1.0, 2e-4) << text_of(options) << ", kind " << kind << ", width " << width;
      }
    }
}

// A mass that slides along a rail gets its energy within an interval of positions, from forces of a mechanical system.
sfdae::MultibodyProblem pushed(double from, double width) {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [=](const auto& t, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    const auto begin = parameter(t, "begin", from);
    to.f[0] = choose(q[0] > begin, 1.5 / width, 0.0) * choose(q[0] < begin + width, 1.0, 0.0);
    to.g[0] = q[1] - 0.5;
  };
  return problem;
}

TEST(Conditions, OfMechanicalSystemsAreLookedAtBetweenTheEndsOfSteps) {
  for (const double width : {0.1, 1e-2, 1e-3, 1e-5})
    for (const sfdae::Options& options : all_options()) {
      sfdae::Solver solver(pushed(0.7371, width), options);
      sfdae::Point point{0.0, {0.0, 0.5, 1.0, 0.0, 0.0}, {}};
      solver.start(point, end);
      ASSERT_EQ(solver.advance(end, point), SFDAE_OK) << text_of(options);
      EXPECT_NEAR(point.x[2], 2.0, 1e-3) << text_of(options) << ", width " << width;
      EXPECT_NEAR(point.x[0], 0.7371 + 2.0 * (end - 0.7371), 1e-2 + width) << text_of(options);
    }
}

// Their times move with the parameter: x jumps by nothing there, sensitivities do. The energy comes later by 1 for each
// unit of `begin`, and the mass has half the speed until then.
TEST(Conditions, OfMechanicalSystemsMoveSensitivities) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(pushed(0.7, 0.5), options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"begin"};
    solver.set_sensitivities(wanted);
    sfdae::Point point{0.0, {0.0, 0.5, 1.0, 0.0, 0.0}, {}};
    solver.start(point, end);
    solver.advance(end, point);
    EXPECT_NEAR(point.x[2], 2.0, 1e-4) << text_of(options);
    const sfdae::Matrix S = solver.sensitivities(end).S;
    EXPECT_NEAR(S(0, 0), -1.0, 1e-3) << text_of(options);
    EXPECT_NEAR(S(2, 0), 0.0, 1e-3) << text_of(options);
  }
}

// Checkpoints after each step, of which those next to the jump hold branches, lead to the same numbers.
TEST(Conditions, AreInCheckpoints) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(divider(), options), other(divider(), options);
    sfdae::Point point{0.0, at_rest, {}}, last = point;
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, last), SFDAE_OK);
    solver.start(point, end);
    Vector previous = solver.save_checkpoint();
    while (point.t < end) {
      solver.step(end, point);
      if (point.t >= end) break;
      const Vector checkpoint = solver.save_checkpoint();
      other.restore_checkpoint(checkpoint);
      sfdae::Point again;
      again.x = at_rest;
      ASSERT_EQ(other.advance(end, again), SFDAE_OK);
      ASSERT_EQ(again.x, last.x) << text_of(options) << ", t = " << point.t;
      // Whatever branches the integration before has held.
      other.restore_checkpoint(checkpoint);
      other.restore_checkpoint(previous);
      ASSERT_EQ(other.advance(end, again), SFDAE_OK);
      ASSERT_EQ(again.x, last.x) << text_of(options) << ", before t = " << point.t;
      previous = checkpoint;
    }
  }
}

TEST(Conditions, AreInSolutions) {
  for (const sfdae::Options& options : all_options()) {
    sfdae::Solver solver(divider(), options);
    sfdae::Solution solution;
    solver.record(solution);
    sfdae::Point point{0.0, at_rest, {}};
    solver.start(point, end);
    ASSERT_EQ(solver.advance(end, point), SFDAE_OK);
    for (double t : {0.5, 0.999, 1.001, 1.5})
      EXPECT_NEAR(solution(t).x[1], t < 1.0 ? 0.0 : divided(t), 1e-5) << text_of(options) << ", t = " << t;
  }
}

}  // namespace
