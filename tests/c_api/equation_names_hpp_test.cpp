// Names of equations and constraints as C++ gives them.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace sfdae::test {
namespace {

template <class Problem>
std::string failure_at_start(const Problem& problem, const std::vector<double>& x) {
  Solver solver(problem);
  Point point{0.0, x, {}};
  try {
    solver.start(point, 1.0);
  } catch (const Error& error) {
    return error.what();
  }
  return "started";
}

void expect_part(const std::string& text, const char* part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
}

TEST(NamesInCpp, AreInMessagesOfLinearProblems) {
  LinearProblem problem(2, 1);
  problem.E = [](double, int, MatrixRef) {};
  problem.A = [](double, int order, MatrixRef A) { A(0, 0) = A(1, 0) = order == 0 ? 1.0 : 0.0; };
  problem.f = [](double, int order, VectorRef f) { f[1] = order == 0 ? -1.0 : 0.0; };
  problem.equation_names = {"low water", "high water"};
  expect_part(failure_at_start(problem, {0.0}), "equations 0 (low water) and 1 (high water) that cannot hold");
  problem.equation_names = {"one"};
  EXPECT_THROW(Solver{problem}, Error);
}

TEST(NamesInCpp, AreInMessagesOfNonlinearProblems) {
  NonlinearProblem problem(2, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[0];
    F[1] = x[1] - log(x[0] - 0.5);
  };
  problem.equation_names = {"", "level"};
  expect_part(failure_at_start(problem, {0.25, 0.0}), "log of -0.25 in equation 1 (level)");
  problem.equation_names.push_back("one too many");
  try {
    Solver solver(problem);
    FAIL();
  } catch (const Error& error) {
    expect_part(error.what(), "equation_names has 3 entries, not 2 as the problem has equations");
  }
}

// Two rods of different lengths between two points; a constraint that depends on t without saying so.
TEST(NamesInCpp, AreInMessagesOfMechanicalSystems) {
  MultibodyProblem rods(2, 2);
  rods.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - 1.0;
    to.g[1] = q[0] * q[0] + q[1] * q[1] - 4.0;
  };
  rods.constraint_names = {"rod", "rod"};
  expect_part(failure_at_start(rods, {1.0, 0.0, 0.0, 0.0, 0.0, 0.0}), " (rod)");
  rods.constraint_names = {"one"};
  EXPECT_THROW(Solver{rods}, Error);

  MultibodyProblem moved(1, 1);
  moved.forces = [](double, ConstVectorRef, ConstVectorRef, VectorRef) {};
  moved.constraints = [](double t, ConstVectorRef q, VectorRef g) { g[0] = q[0] - t; };
  moved.constraint_jacobian = [](double, ConstVectorRef, MatrixRef G) { G(0, 0) = 1.0; };
  moved.constraint_names = {"slide"};
  expect_part(failure_at_start(moved, {0.0, 0.0, 0.0}), "holonomic constraint 0 (slide) depends on t");
}

// q1 q2 = 0 at the origin: the gradient vanishes where the crossing is reached.
TEST(NamesInCpp, AreInMessagesOfSingularConfigurations) {
  MultibodyProblem problem(2, 1);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.g[0] = q[0] * q[1];
  };
  problem.constraint_names = {"crossing"};
  Solver solver(problem);
  Point point{0.0, {-1.0, 0.0, 1.0, 0.0, 0.0}, {}};
  solver.start(point, 2.0);
  try {
    solver.advance(2.0, point);
    FAIL();
  } catch (const Error& error) {
    expect_part(error.what(), "the gradient of holonomic constraint 0 (crossing) vanishes");
  }
}

}  // namespace
}  // namespace sfdae::test
