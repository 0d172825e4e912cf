// SPDX-License-Identifier: BSD-3-Clause
//
// Jumps, impacts and breakpoints through the C++ interface.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

// Two capacitors, 1 and 3 F, connected: charge is kept.
TEST(ModesInCpp, JumpKeepsCharge) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[0] + x[2];
    F[1] = 3.0 * xdot[1] - x[2];
    F[2] = x[0] - x[1];
  };
  sfdae::Solver solver(problem);
  const sfdae::Jump jump = solver.jump(0.0, 1.0, {2.0, 0.0, 0.0}, 2);
  EXPECT_NEAR(jump.after[0], 0.5, 1e-13);
  EXPECT_NEAR(jump.after[1], 0.5, 1e-13);
  EXPECT_EQ(jump.before[0], 2.0);
  EXPECT_NEAR(jump.impulses(2, 0), 1.5, 1e-13);
  EXPECT_EQ(jump.impulses(2, 1), 0.0);
  EXPECT_THROW(solver.jump(0.0, 1.0, {2.0, 0.0}), sfdae::Error);
  EXPECT_THROW(solver.impact(0.0, {2.0, 0.0, 0.0}), sfdae::Error);
  EXPECT_THROW(solver.last_jump(), sfdae::Error);
}

TEST(ModesInCpp, ImpactReversesVelocities) {
  sfdae::MultibodyProblem system(1, 1);
  system.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = 2.0;
    to.g[0] = q[0];
  };
  sfdae::Solver solver(system);
  const sfdae::Jump jump = solver.impact(0.0, {0.0, -3.0, 0.0}, {0.5});
  EXPECT_NEAR(jump.after[1], 1.5, 1e-13);
  EXPECT_NEAR(jump.impulses(2, 0), -9.0, 1e-13);
  EXPECT_NEAR(solver.impact(0.0, {0.0, -3.0, 0.0}).after[1], 0.0, 1e-13);
  EXPECT_THROW(solver.impact(0.0, {0.0, -3.0, 0.0}, {0.5, 0.5}), sfdae::Error);
}

// x1' = x2, 0 = x1 - s(t) with the step s from 0 to 1 at t = 1/2.
TEST(ModesInCpp, BreakpointsAreCrossed) {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double, int order, sfdae::MatrixRef E) {
    if (order == 0) E(0, 0) = 1.0;
    return 0;
  };
  problem.A = [](double, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 1) = A(1, 0) = 1.0;
    return 0;
  };
  problem.f = [](double t, int order, sfdae::VectorRef f) {
    if (order == 0 && t >= 0.5) f[1] = -1.0;
    return 0;
  };
  sfdae::Solver solver(problem);
  EXPECT_THROW(solver.set_breakpoints({0.5}, {SFDAE_BREAKPOINT_JUMP, SFDAE_BREAKPOINT_KINK}), sfdae::Error);
  EXPECT_THROW(solver.set_breakpoints({0.5, 0.4}), sfdae::Error);
  solver.set_breakpoints({0.5}, {SFDAE_BREAKPOINT_JUMP});
  sfdae::Point point{0.0, {0.0, 0.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_NEAR(point.x[0], 1.0, 1e-12);
  EXPECT_NEAR(point.x[1], 0.0, 1e-9);
  EXPECT_NEAR(solver.last_jump().impulses(1, 0), 1.0, 1e-9);
  solver.set_breakpoints({});
}

}  // namespace
