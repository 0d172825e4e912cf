// SPDX-License-Identifier: BSD-3-Clause
// What reports say about modes and breakpoints.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sfdae/hybrid.hpp"

namespace {

using sfdae::Expression;
using sfdae::Point;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// x' = a - x; y = x, or y' = 0.
sfdae::Solver decay(bool is_constrained) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [is_constrained](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - sfdae::parameter(t, "a", 1.0) + x[0];
    if (is_constrained) F[1] = x[1] - x[0];
    else F[1] = xdot[1] + 0.0 * t;
  };
  return sfdae::Solver(problem);
}

TEST(ModesReport, SaysWhichModeSinceWhenAndWhatIsNext) {
  sfdae::Solver free = decay(false), bound = decay(true);
  sfdae::Hybrid hybrid;
  hybrid.add_mode(free, "free");
  hybrid.add_mode(bound, "bound");
  sfdae::Transition to_bound, back;
  to_bound.to = back.from = 1;
  to_bound.kind = back.kind = SFDAE_TRANSITION_TIME;
  to_bound.time = 0.5;
  back.time = 1.75;
  hybrid.add_transition(to_bound);
  hybrid.add_transition(back);
  bound.set_breakpoints({1.0, 1.5});
  EXPECT_TRUE(
      contains(free.report(),
               "This is mode 0 (free) of a hybrid system of 2 modes and 2 transitions, which has not been started"));
  EXPECT_TRUE(contains(bound.report(), "Breakpoints: 2 are set"));
  Point point{0.0, {0.0, 0.2}, {}};
  hybrid.start(0, point, 3.0);
  std::string report = hybrid.report();
  EXPECT_TRUE(contains(report, "At t = 0 in mode 0 (free) since t = 0")) << report;
  EXPECT_TRUE(contains(report, "next transition by time: t = 0.5 to mode 1 (bound)")) << report;
  EXPECT_TRUE(contains(report, "mode 1 (bound)                    -     -     -     -     -")) << report;
  hybrid.advance(0.8, point);
  report = hybrid.report();
  EXPECT_TRUE(contains(report, "At t = 0.8 in mode 1 (bound) since t = 0.5")) << report;
  EXPECT_TRUE(contains(report, "next transition by time: t = 1.75 to mode 0 (free)")) << report;
  EXPECT_TRUE(contains(report, "Breakpoints: next t = 1 (kink), t = 1.5 (kink)")) << report;
  EXPECT_TRUE(contains(report, "> mode 1 (bound)                    0     1     1     0     0")) << report;
  EXPECT_TRUE(contains(report, "1 transitions:")) << report;
  report = bound.report();
  EXPECT_TRUE(contains(report, "which is in it since t = 0.5; 1 visits, 1 transitions")) << report;
  EXPECT_TRUE(contains(report, "next transition by time: t = 1.75")) << report;
  EXPECT_TRUE(contains(report, "Breakpoints: next t = 1 (kink)")) << report;
  EXPECT_TRUE(contains(free.report(), "which is in mode 1 (bound) since t = 0.5")) << free.report();
  hybrid.restore_checkpoint(hybrid.save_checkpoint());
  EXPECT_TRUE(contains(hybrid.report(), "1 transitions, all before a checkpoint")) << hybrid.report();
}

TEST(BreakpointsReport, ListsThoseAheadAndTheLastJump) {
  sfdae::NonlinearProblem problem(1, 1);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[0] - sfdae::table(t, 1, {0.0, 0.25, 3.0, 60.0}, {0.0, 1.0, 2.0, 0.0});
  };
  sfdae::Solver solver(problem);
  Point point{0.0, {0.0}, {}};
  EXPECT_FALSE(contains(solver.report(), "Breakpoints"));
  solver.start(point, 5.0);
  EXPECT_TRUE(contains(solver.report(), "Breakpoints: next t = 0.25 (kink), t = 3 (kink)")) << solver.report();
  solver.set_breakpoints({1.0, 2.0}, {SFDAE_BREAKPOINT_JUMP, SFDAE_BREAKPOINT_KINK});
  EXPECT_TRUE(contains(solver.report(), "next t = 0.25 (kink), t = 1 (jump), t = 2 (kink), t = 3 (kink)"))
      << solver.report();
  solver.advance(1.5, point);
  EXPECT_TRUE(contains(solver.report(), "Breakpoints: next t = 2 (kink)")) << solver.report();
  EXPECT_TRUE(contains(solver.report(), "the last jump was at t = 1: largest change 0")) << solver.report();
  solver.advance(4.5, point);
  // The end of the table.
  EXPECT_TRUE(contains(solver.report(), "Breakpoints: next t = 60 (smooth)")) << solver.report();
  std::vector<double> many;
  for (int k = 1; k < 10; ++k) many.push_back(5.0 + k);
  solver.set_breakpoints(many);
  EXPECT_TRUE(contains(solver.report(), "t = 10 (kink), ...")) << solver.report();
  sfdae::Solver plain = decay(true);
  plain.set_breakpoints({1.0, 2.0});
  Point x{0.0, {0.0, 0.0}, {}};
  plain.start(x, 3.0);
  plain.advance(2.5, x);
  EXPECT_TRUE(contains(plain.report(), "Breakpoints: none after t = ")) << plain.report();
  // Backward.
  Point end{4.5, {0.0}, {}};
  solver.start(end, 0.0);
  EXPECT_TRUE(contains(solver.report(), "next t = 3 (kink), t = 0.25 (kink)")) << solver.report();
}

}  // namespace
