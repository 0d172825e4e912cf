// SPDX-License-Identifier: BSD-3-Clause
// SFNDAE: solutions, characteristic values, options and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "sfndae_problems.h"

using namespace sfdae_test;

namespace {

double largest_error(const std::vector<double>& x, const std::vector<double>& exact) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, std::fabs(x[i] - exact[i]) / (1.0 + std::fabs(exact[i])));
  return largest;
}

class SfndaeMethods : public testing::TestWithParam<int> {};

template <class I>
void expect_solved(const KnownNonlinear& problem, int method) {
  SfndaeRun<I> run(problem.equations, method, 5, problem.max_index);
  run.set_x(problem.start);
  ASSERT_EQ(run.call(0.0), 4);
  EXPECT_EQ(run.info(1), 2);
  EXPECT_EQ(run.characteristics(), problem.characteristics);
  EXPECT_EQ(run.iwarn, problem.characteristics[3] > 0 ? 1 : 0);
  for (int k = 1; k <= 5; ++k) {
    ASSERT_EQ(run.call(0.4 * k), 3) << k;
    EXPECT_EQ(run.t, 0.4 * k);
    EXPECT_EQ(run.info(1), 1);
    EXPECT_LE(largest_error(run.values(), problem.solution(run.t)), 10 * 1e-6) << k;
  }
  EXPECT_TRUE(run.user.arguments_are_right);
  EXPECT_LE(run.user.highest_order, problem.max_index + 1);
  EXPECT_TRUE(run.guards_intact());
  EXPECT_GT(run.iwork(11), 0);
  EXPECT_GT(run.iwork(12), 0);
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Methods, SfndaeMethods, testing::Values(1, 2),
                         [](const auto& method) { return method.param == 1 ? "Bdf" : "Radau"; });

TEST_P(SfndaeMethods, OrdinaryDifferentialEquationsAreSolved) {
  expect_solved<std::int32_t>(nonlinear_ode(), GetParam());
  expect_solved<std::int64_t>(nonlinear_ode(), GetParam());
}

TEST_P(SfndaeMethods, HighIndexWithoutDynamicsIsSolved) {
  expect_solved<std::int32_t>(path_control(), GetParam());
  expect_solved<std::int64_t>(path_control(), GetParam());
}

TEST_P(SfndaeMethods, FreeComponentsAreHeldAndWarnedOf) {
  expect_solved<std::int32_t>(free_nonlinear_component(), GetParam());
}

TEST_P(SfndaeMethods, RedundantEquationsAreAccepted) {
  expect_solved<std::int32_t>(redundant_equation(), GetParam());
}

TEST_P(SfndaeMethods, RedundantEquationsThatContradictEachOtherAreRefused) {
  const KnownNonlinear problem = redundant_equation(0.1);
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  EXPECT_EQ(run.call(1.0), -24);
  EXPECT_EQ(run.info(1), -1);
  EXPECT_EQ(run.values(), problem.start);
}

// Reference at t = 10: see pendulum.h. Errors grow with the swings; ten tolerances a time unit are allowed.
TEST_P(SfndaeMethods, ThePendulumIsFollowed) {
  const KnownNonlinear problem = pendulum_problem();
  for (double tol : {1e-5, 1e-7}) {
    SfndaeRun<> run(problem.equations, GetParam());
    run.rtol(1) = run.atol(1) = tol;
    // Consistent values are found from a guess: the length is 1.
    run.set_x({1.2, 0.0, 0.5, 0.0, 0.0});
    ASSERT_EQ(run.call(0.0), 4);
    EXPECT_EQ(run.characteristics(), problem.characteristics);
    EXPECT_LE(largest_error(run.values(), {1.0, 0.0, 0.0, 0.0, 0.0}), 1e-12);
    EXPECT_LE(largest_error(run.slopes(), {0.0, 0.0, 0.0, -9.81, 0.0}), 1e-12);
    ASSERT_EQ(run.call(1.0), 3);
    const std::vector<double> x = run.values();
    // Constraints hold to rounding, the hidden ones included; so does the energy within the tolerance.
    EXPECT_LE(std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), 1e-13);
    EXPECT_LE(std::fabs(x[0] * x[2] + x[1] * x[3]), 1e-12);
    EXPECT_LE(std::fabs((x[2] * x[2] + x[3] * x[3]) / 2 + 9.81 * x[1]), 100 * tol);
  }
}

TEST_P(SfndaeMethods, ItIsTheSameBackward) {
  const KnownNonlinear problem = nonlinear_ode();
  SfndaeRun<> run(problem.equations, GetParam());
  run.t = 1.0;
  run.set_x(problem.solution(1.0));
  ASSERT_EQ(run.call(0.0), 3);
  EXPECT_LE(largest_error(run.values(), problem.solution(0.0)), 1e-5);
}

TEST_P(SfndaeMethods, AfterAFirstCallEitherDirectionIsPossible) {
  const KnownNonlinear problem = path_control();
  SfndaeRun<> run(problem.equations, GetParam(), 5, 4);
  run.set_x(problem.start);
  ASSERT_EQ(run.call(0.0), 4);
  ASSERT_EQ(run.call(-1.0), 3);
  EXPECT_LE(largest_error(run.values(), problem.solution(-1.0)), 1e-5);
}

TEST_P(SfndaeMethods, ChangedStartValuesAreMadeConsistentAgain) {
  const KnownNonlinear problem = redundant_equation();
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  ASSERT_EQ(run.call(0.0), 4);
  run.set_x({0.5, 0.25});
  ASSERT_EQ(run.call(1.0), 3);
  // x1(0) = 1/2: x1 = 1 / (2 + t)
  EXPECT_LE(largest_error(run.values(), {1.0 / 3.0, 1.0 / 9.0}), 1e-5);
}

TEST_P(SfndaeMethods, Info11TakesConsistentValuesAndRefusesOthers) {
  const KnownNonlinear problem = redundant_equation();
  SfndaeRun<> run(problem.equations, GetParam());
  run.info(11) = 1;
  run.set_x({1.0, 1.0});
  EXPECT_EQ(run.call(1.0), 3);
  SfndaeRun<> other(problem.equations, GetParam());
  other.info(11) = 1;
  other.set_x({1.0, 0.9});
  EXPECT_EQ(other.call(1.0), -24);
  EXPECT_EQ(other.values(), (std::vector<double>{1.0, 0.9}));
}

TEST_P(SfndaeMethods, Info12KeepsDifferentialComponents) {
  const KnownNonlinear problem = redundant_equation();
  SfndaeRun<> run(problem.equations, GetParam());
  run.info(12) = 1;
  run.set_x({0.5, 0.9});
  ASSERT_EQ(run.call(0.0), 4);
  EXPECT_LE(largest_error(run.values(), {0.5, 0.25}), 1e-12);
  // The nearest point is another one.
  SfndaeRun<> nearest(problem.equations, GetParam());
  nearest.set_x({0.5, 0.9});
  ASSERT_EQ(nearest.call(0.0), 4);
  EXPECT_GT(std::fabs(nearest.x(1) - 0.5), 0.1);
}

TEST_P(SfndaeMethods, NothingIsEvaluatedBeyondTheStopPoint) {
  const KnownNonlinear problem = nonlinear_ode();
  SfndaeRun<> run(problem.equations, GetParam());
  double farthest = 0.0;
  run.user.ierr = [&](double t, int) {
    farthest = std::max(farthest, t);
    return 0;
  };
  run.info(4) = 1;
  run.rwork(1) = 1.0;
  run.set_x(problem.start);
  ASSERT_EQ(run.call(1.0), 3);
  EXPECT_EQ(farthest, 1.0);
  EXPECT_EQ(run.call(1.5), -110);
}

TEST_P(SfndaeMethods, StepsAreReturnedOneByOne) {
  const KnownNonlinear problem = nonlinear_ode();
  SfndaeRun<> run(problem.equations, GetParam());
  run.info(3) = 1;
  run.info(7) = 1;
  run.rwork(2) = 0.125;
  run.set_x(problem.start);
  double before = 0.0;
  int calls = 0;
  while (run.call(1.0) == 1) {
    EXPECT_GT(run.t, before);
    EXPECT_LE(run.t - before, 0.125 * (1.0 + 1e-12));
    EXPECT_EQ(run.iwork(11), ++calls);
    before = run.t;
  }
  EXPECT_EQ(run.ierr, 3);
  EXPECT_GE(calls, 7);
}

TEST_P(SfndaeMethods, AnIndexAboveTheLimitIsReported) {
  const KnownNonlinear problem = path_control();
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  EXPECT_EQ(run.call(1.0), -22);
  EXPECT_EQ(run.cval(1), -1);
  EXPECT_EQ(run.values(), problem.start);
  EXPECT_EQ(run.t, 0.0);
}

// ---- NDIF fails ----

TEST_P(SfndaeMethods, FailuresAtTheStartAreReported) {
  const KnownNonlinear problem = pendulum_problem();
  for (int code : {-1, 1, -7}) {
    SfndaeRun<> run(problem.equations, GetParam());
    run.set_x(problem.start);
    run.user.ierr = [code](double, int) { return code; };
    EXPECT_EQ(run.call(1.0), -10);
    EXPECT_EQ(run.values(), problem.start);
  }
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  run.user.returns_nan = true;
  EXPECT_EQ(run.call(1.0), -10);
}

TEST_P(SfndaeMethods, DerivativesThatAreMissingAreReported) {
  const KnownNonlinear problem = pendulum_problem();
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  run.user.ierr = [](double, int order) { return order > 1 ? -2 : 0; };
  EXPECT_EQ(run.call(1.0), -21);
  EXPECT_EQ(run.info(1), -1);
}

// Order mu + 1 makes XPRIME more accurate and is no more than that.
TEST_P(SfndaeMethods, OrdersUpToTheIndexSuffice) {
  const KnownNonlinear problem = pendulum_problem();
  SfndaeRun<> run(problem.equations, GetParam());
  run.set_x(problem.start);
  run.user.ierr = [](double, int order) { return order > 2 ? -2 : 0; };
  ASSERT_EQ(run.call(0.0), 4);
  ASSERT_EQ(run.call(0.5), 3);
  EXPECT_LE(std::fabs(run.x(1) * run.x(1) + run.x(2) * run.x(2) - 1.0), 1e-13);
  EXPECT_LE(std::fabs(run.xprime(1) - run.x(3)), 1e-3);
}

TEST_P(SfndaeMethods, FailuresOnTheWayLeaveTheLastPointAndCanBeGoneOnFrom) {
  const KnownNonlinear problem = nonlinear_ode();
  for (bool as_nan : {false, true}) {
    SfndaeRun<> run(problem.equations, GetParam());
    run.set_x(problem.start);
    bool fails = true;
    run.user.ierr = [&](double t, int) {
      run.user.returns_nan = as_nan && fails && t > 0.5;
      return !as_nan && fails && t > 0.5 ? -1 : 0;
    };
    ASSERT_EQ(run.call(1.0), -10);
    EXPECT_GT(run.t, 0.4);
    EXPECT_LE(run.t, 0.5);
    EXPECT_LE(largest_error(run.values(), problem.solution(run.t)), 1e-5);
    EXPECT_EQ(run.call(1.0), -998);
    // As far as NDIF is defined.
    run.info(1) = 1;
    run.info(4) = 1;
    run.rwork(1) = 0.5;
    if (run.t < 0.5) {
      ASSERT_EQ(run.call(0.5), 3);
    }
    EXPECT_LE(largest_error(run.values(), problem.solution(0.5)), 1e-5);
    fails = false;
    run.info(4) = 0;
    ASSERT_EQ(run.call(1.0), 3);
    EXPECT_LE(largest_error(run.values(), problem.solution(1.0)), 1e-5);
  }
}

// A call begins with an evaluation at the last point.
TEST_P(SfndaeMethods, AFailureRightAtTheBeginningOfACallChangesNothing) {
  const KnownNonlinear problem = nonlinear_ode();
  for (const auto& [returned, expected] : {std::pair{-1, -10}, std::pair{-2, -21}}) {
    SfndaeRun<> run(problem.equations, GetParam());
    run.set_x(problem.start);
    ASSERT_EQ(run.call(0.5), 3);
    const std::vector<double> before = run.values();
    int code = returned;
    run.user.ierr = [&code](double, int) { return code; };
    EXPECT_EQ(run.call(1.0), expected);
    EXPECT_EQ(run.t, 0.5);
    EXPECT_EQ(run.values(), before);
    code = 0;
    run.info(1) = 1;
    ASSERT_EQ(run.call(1.0), 3);
    EXPECT_LE(largest_error(run.values(), problem.solution(1.0)), 1e-5);
  }
}

// x' = x^2: x = 1 / (1 - t) ends at t = 1.
TEST_P(SfndaeMethods, SolutionsThatEndAreReported) {
  const auto equations = std::make_shared<NonlinearEquations>(
      1, [](const Term&, const Term* x, const Term* xdot) -> std::vector<Term> { return {xdot[0] - x[0] * x[0]}; });
  SfndaeRun<> run(equations, GetParam());
  run.set_x({1.0});
  const int ierr = run.call(2.0);
  EXPECT_TRUE(ierr == -6 || ierr == -1) << ierr;
  EXPECT_NEAR(run.t, 1.0, 1e-3);
}
