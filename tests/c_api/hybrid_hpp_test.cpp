// SPDX-License-Identifier: BSD-3-Clause
//
// Hybrid systems from C++.

#include <gtest/gtest.h>

#include <cmath>
#include <sfdae/hybrid.hpp>
#include <stdexcept>

namespace {

// Capacitors of 1 F with a leak of 1 S and of 3 F, with a switch between them.
sfdae::Solver capacitors(double closed) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [closed](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[0] + x[2];
    F[1] = 3 * xdot[1] - x[2];
    F[2] = closed * (x[0] - x[1]) + (1 - closed) * x[2];
  };
  return sfdae::Solver(problem);
}

sfdae::Solver flight() {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + 9.81;
  };
  return sfdae::Solver(problem);
}

TEST(HybridInCpp, JoinsCapacitorsWhereTheyDifferByOne) {
  sfdae::Solver open = capacitors(0), closed = capacitors(1);
  sfdae::Hybrid hybrid;
  EXPECT_EQ(hybrid.add_mode(open, "open"), 0);
  EXPECT_EQ(hybrid.add_mode(closed, "closed"), 1);
  sfdae::Transition close;
  close.to = 1;
  close.function = [](double, auto x, auto) { return 2 - x[0] + x[1]; };
  EXPECT_EQ(hybrid.add_transition(close), 0);
  sfdae::Solution solution;
  hybrid.record(solution);
  sfdae::Point point{0, {4, 0, 0}, {}};
  EXPECT_EQ(hybrid.start(0, point, 2), SFDAE_OK);
  EXPECT_EQ(hybrid.advance_to_transition(2, point), SFDAE_EVENT);
  EXPECT_NEAR(point.t, std::log(2.0), 1e-5);
  EXPECT_NEAR(point.x[1], 0.5, 1e-5);
  EXPECT_EQ(hybrid.current_mode(), 1);
  EXPECT_NEAR(hybrid.last_jump().impulses(2, 0), 1.5, 1e-5);
  EXPECT_NEAR(hybrid.passage(0).largest_change, 1.5, 1e-5);
  const std::vector<double> checkpoint = hybrid.save_checkpoint();
  EXPECT_EQ(hybrid.advance(2, point), SFDAE_OK);
  EXPECT_NEAR(point.x[0], 0.5 * std::exp(-(2 - std::log(2.0)) / 4), 1e-4);
  EXPECT_NEAR(solution(0.5).x[0], 4 * std::exp(-0.5), 1e-4);
  EXPECT_EQ(hybrid.num_passages(), 1);
  EXPECT_EQ(hybrid.mode(1).strangeness_index, 1);
  EXPECT_GT(hybrid.statistics().steps, hybrid.mode(1).steps);
  EXPECT_NE(hybrid.report().find("mode 1 (closed)"), std::string::npos);
  const std::vector<double> x = point.x;
  hybrid.restore_checkpoint(checkpoint);
  hybrid.advance(2, point);
  EXPECT_EQ(point.x, x);
}

TEST(HybridInCpp, BouncesUntilTheyAccumulate) {
  sfdae::Solver solver = flight();
  sfdae::Hybrid hybrid;
  hybrid.add_mode(solver);
  sfdae::Transition bounce;
  bounce.kind = SFDAE_TRANSITION_ZERO;
  bounce.direction = -1;
  bounce.function = [](double, auto x, auto) { return x[0]; };
  bounce.jump = [](double, auto x) { x[1] = -0.7 * x[1]; };
  hybrid.add_transition(bounce);
  sfdae::Point point{0, {0, 5}, {}};
  hybrid.start(0, point, 10);
  try {
    hybrid.advance(10, point);
    ADD_FAILURE();
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ZENO);
  }
  const double limit = 2 * 5 / (9.81 * (1 - 0.7));
  EXPECT_NEAR(hybrid.accumulation(), limit, 1e-3 * limit);
}

TEST(HybridInCpp, PassesExceptionsOn) {
  sfdae::Solver solver = flight();
  sfdae::Hybrid hybrid;
  hybrid.add_mode(solver);
  sfdae::Transition fall;
  fall.function = [](double, auto x, auto) { return -x[0]; };
  fall.jump = [](double, auto) { throw std::out_of_range("no jump"); };
  hybrid.add_transition(fall);
  sfdae::Point point{0, {0.1, 5}, {}};
  hybrid.start(0, point, 10);
  EXPECT_THROW(hybrid.advance(10, point), std::out_of_range);
  fall.to = 3;
  EXPECT_THROW(hybrid.add_transition(fall), sfdae::Error);
}

}  // namespace
