// SPDX-License-Identifier: BSD-3-Clause
// Singular points from C++.
#include <gtest/gtest.h>

#include <cmath>

#include "sfdae/sfdae.hpp"

namespace {

TEST(BranchesInCpp, ArePassed) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {0.0, 1.0}, {}};
  solver.pass_singular_points(1);
  solver.start(point, 3.0);
  EXPECT_THROW(solver.singular_point(), sfdae::Error);
  solver.advance(3.0, point);
  EXPECT_NEAR(point.x[0], std::sin(3.0), 1e-3);
  EXPECT_NEAR(point.x[1], std::cos(3.0), 1e-3);
  const sfdae::SingularPoint met = solver.singular_point();
  EXPECT_EQ(met.kind, SFDAE_SINGULAR_CROSSING);
  EXPECT_EQ(met.passed, 1);
  EXPECT_EQ(met.count, 1);
  EXPECT_THROW(solver.pass_singular_points(-1), sfdae::Error);
}

}  // namespace
