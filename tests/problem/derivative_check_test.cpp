// SPDX-License-Identifier: BSD-3-Clause
// Wrong derivatives are found, located and told from right ones.
#include "problem/derivative_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "c_api/problems.h"
#include "family_problem.h"
#include "problem/failure.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::Call;
using sfdae_test::Callback;
using sfdae_test::FamilyProblem;

std::function<void(const Call&, std::span<double>)> add_to(Callback function, int order, std::size_t entry,
                                                           double change) {
  return [=](const Call& call, std::span<double> values) {
    if (call.function == function && call.order == order) values[entry] += change;
  };
}

}  // namespace

TEST(DerivativeCheck, FindsNothingInExactDerivatives) {
  for (sfdae_test::LinearTestProblem& p : sfdae_test::linear_testset()) {
    const double t = 0.5 * (p.t0 + p.tf);
    FamilyProblem callbacks(std::move(p.family));
    LinearProblem problem(functions_of(callbacks.problem));
    const DerivativeMismatch worst = check_derivatives(problem, t, 2);
    EXPECT_FALSE(worst.suspicious()) << callbacks.family().name() << ": " << worst.function << worst.order << ", "
                                     << worst.error << " / " << worst.uncertainty;
  }
}

TEST(DerivativeCheck, LocatesAWrongEntryWithItsValues) {
  const std::shared_ptr<const sfdae_test::LinearFamily> family = sfdae_test::kron(5, 1);
  const int m = family->m();
  struct Case {
    Callback function;
    char name;
    int order, row, column;
  };
  for (const Case c : {Case{Callback::E, 'E', 1, 3, 2},
                       {Callback::A, 'A', 1, 0, 4},
                       {Callback::f, 'f', 1, 2, 0},
                       {Callback::A, 'A', 2, 4, 1}}) {
    FamilyProblem callbacks(family);
    callbacks.hooks.tamper = add_to(c.function, c.order, static_cast<std::size_t>(c.row + c.column * m), 0.01);
    LinearProblem problem(functions_of(callbacks.problem));
    const DerivativeMismatch worst = check_derivatives(problem, 0.3, 2);
    EXPECT_TRUE(worst.suspicious());
    EXPECT_EQ(worst.function, c.name);
    EXPECT_EQ(worst.order, c.order);
    EXPECT_EQ(worst.row, c.row);
    EXPECT_EQ(worst.column, c.column);
    EXPECT_NEAR(worst.supplied - worst.difference, 0.01, 1e-8);  // differences of smooth data: error below 1e-8
    EXPECT_LE(worst.uncertainty, 1e-8);
  }
}

TEST(DerivativeCheck, AFactorThatIsWrongIsSuspicious) {
  FamilyProblem callbacks(std::shared_ptr<const sfdae_test::LinearFamily>(sfdae_test::kron(4, 1)));
  callbacks.hooks.tamper = [](const Call& call, std::span<double> values) {
    if (call.function == Callback::E && call.order == 2)
      for (double& value : values) value *= 0.5;  // Taylor coefficients instead of derivatives
  };
  LinearProblem problem(functions_of(callbacks.problem));
  EXPECT_FALSE(check_derivatives(problem, 0.3, 1).suspicious());
  const DerivativeMismatch worst = check_derivatives(problem, 0.3, 3);
  EXPECT_TRUE(worst.suspicious());
  EXPECT_EQ(worst.function, 'E');
  EXPECT_EQ(worst.order, 2);
}

TEST(DerivativeCheck, ComparesNothingWhereThereIsNothing) {
  FamilyProblem constant(
      std::shared_ptr<const sfdae_test::LinearFamily>(std::move(sfdae_test::no_equations().family)));
  constant.declare_constants();
  constant.problem.f = nullptr;
  LinearProblem problem(functions_of(constant.problem));
  EXPECT_EQ(check_derivatives(problem, 0.0, 3).function, 0);
  EXPECT_EQ(constant.calls(), 0);

  FamilyProblem order_zero(std::shared_ptr<const sfdae_test::LinearFamily>(sfdae_test::kron(4, 1)));
  order_zero.hooks.highest_order = 0;
  LinearProblem without(functions_of(order_zero.problem));
  const DerivativeMismatch worst = check_derivatives(without, 0.3, 3);
  EXPECT_EQ(worst.function, 0);
  EXPECT_FALSE(worst.suspicious());
}

// A negative answer ends the check anywhere; a positive one where the derivative itself is asked for, call 1, while
// points that cannot be reached are replaced by closer ones.
TEST(DerivativeCheck, FailuresOfCallbacksEndIt) {
  struct Case {
    int call, code, status;
  };
  for (const Case c : {Case{7, -3, SFDAE_CALLBACK_STOPPED}, {1, 5, SFDAE_CALLBACK_FAILED}}) {
    FamilyProblem callbacks(std::shared_ptr<const sfdae_test::LinearFamily>(sfdae_test::kron(4, 1)));
    callbacks.hooks.status = sfdae_test::return_at_call(c.call, c.code);
    LinearProblem problem(functions_of(callbacks.problem));
    try {
      check_derivatives(problem, 0.3, 1);
      FAIL() << "no failure";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.status(), c.status);
      EXPECT_EQ(callbacks.calls(), c.call);
    }
  }
}

}  // namespace sfdae::core
