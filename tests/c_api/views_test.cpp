// Views of C++ callbacks, while equations are recorded and later: they name the entry that does not exist.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "recorded_formulas.h"

namespace sfdae::test {
namespace {

template <class Problem>
std::string error_of(const Problem& problem) {
  try {
    Solver solver(problem);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_EQ(Solver::check(problem), error.what());
    return error.what();
  }
}

TEST(Views, NameTheEntryThatDoesNotExist) {
  NonlinearProblem problem(5, 5);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions, Expressions F) { F[5] = x[0]; };
  EXPECT_EQ(error_of(problem), "F[5] does not exist: F has 5 entries, counted from 0");
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions, Expressions F) { F[0] = x[-1]; };
  EXPECT_EQ(error_of(problem), "x[-1] does not exist: x has 5 entries, counted from 0");
  NonlinearProblem linear(2, 3);
  linear.linear_equations = [](const Expression&, auto E, auto, auto) { E(2, 0) = 1.0; };
  EXPECT_EQ(error_of(linear), "E(2, 0) does not exist: E is 2 x 3, counted from 0");
  MultibodyProblem body(2, 1);
  body.equations = [](const auto&, auto q, auto, auto to) { to.g[1] = q[0]; };
  EXPECT_EQ(error_of(body), "g[1] does not exist: g has 1 entries, counted from 0");
}

TEST(Views, OfCallbacksAreChecked) {
  LinearProblem problem(2, 2);
  problem.E = [](double, int, MatrixRef E) { E(0, 2) = 1.0; };
  problem.A = [](double, int, MatrixRef) {};
  Solver solver(problem);
  try {
    solver.analyze(0.0, 1.0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "E(0, 2) does not exist: E is 2 x 2, counted from 0");
  }
}

}  // namespace
}  // namespace sfdae::test
