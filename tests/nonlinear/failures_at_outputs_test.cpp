// A function that cannot be evaluated for a while, exactly where an output is: the next try is as good as the first.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "nonlinear_run.h"
#include "sfdae/sfdae.h"

namespace sfdae_test {
namespace {

// So small that the polynomials of three stages are not accurate enough within most steps.
constexpr double tol = 1e-9;
// Iterations at outputs go on to rounding; stages end at a hundredth of the tolerance, and are better as a rule.
constexpr double iteration_error = 0.01 * tol;
constexpr int always = 1 << 30;

enum class Fails { at_the_point, beside_it, with_jacobians };

// x1' = -x2^2 + cos 3t,  0 = x2 - x1 by total derivatives; fails so many times at one t, at all other t, or at that t
// where derivatives are asked for.
struct Riccati {
  double failing_t = -1.0;
  int failures = 0;
  Fails fails = Fails::at_the_point;

  bool is_to_fail(double t, bool wants_jacobians) {
    const bool is_there = fails == Fails::beside_it ? t != failing_t : t == failing_t;
    if (!is_there || (fails == Fails::with_jacobians && !wants_jacobians) || failures == 0) return false;
    --failures;
    return true;
  }

  static int total_derivative(double t, int order, const double* x, double* F, double* F_x, double* F_xdot,
                              void* user) {
    auto& self = *static_cast<Riccati*>(user);
    if (self.is_to_fail(t, F_x != nullptr)) return 1;
    constexpr double quarter = 1.5707963267948966;
    const auto derivative = [x](int i, int k) { return x[i + 2 * k]; };
    F[0] = derivative(0, order + 1) - std::pow(3.0, order) * std::cos(3.0 * t + quarter * order);
    double binomial = 1.0;
    for (int j = 0; j <= order; ++j) {
      F[0] += binomial * derivative(1, j) * derivative(1, order - j);
      binomial *= static_cast<double>(order - j) / (j + 1);
    }
    F[1] = derivative(1, order) - derivative(0, order);
    const double one = order == 0 ? 1.0 : 0.0;
    if (F_x != nullptr) {
      F_x[1] = -one;
      F_x[2] = 2.0 * derivative(1, order);
      F_x[3] = one;
    }
    if (F_xdot != nullptr) F_xdot[0] = one;
    return 0;
  }
};

struct Output {
  int status;
  std::vector<double> x, xdot;
};

// Within the last of so many steps, `part` of it from its end; so many failures exactly there. 0 stages: BDF.
Output output_within_step(int stages, int steps, double part, int failures, Fails fails = Fails::at_the_point) {
  Riccati equations;
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.total_derivative = Riccati::total_derivative;
  problem.user = &equations;
  sfdae_options options = options_with(tol, stages > 0 ? SFDAE_METHOD_RADAU : SFDAE_METHOD_BDF);
  if (stages > 0) options.min_stages = options.max_stages = stages;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  Output output{0, {1.0, 1.0}, {0.0, 0.0}};
  double t = 0.0;
  EXPECT_EQ(sfdae_start(solver, 0.0, 10.0, output.x.data(), output.xdot.data()), SFDAE_OK);
  for (int i = 0; i < steps; ++i)
    EXPECT_EQ(sfdae_step(solver, 10.0, &t, output.x.data(), output.xdot.data()), SFDAE_STEP_TAKEN);
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_get_statistics(solver, &statistics);
  const double at = statistics.t_internal - part * statistics.last_step;
  equations.failing_t = at;
  equations.failures = failures;
  equations.fails = fails;
  output.status = sfdae_interpolate(solver, at, output.x.data(), output.xdot.data());
  if (fails == Fails::at_the_point) {
    EXPECT_TRUE(equations.failures == 0 || output.status == SFDAE_CALLBACK_FAILED);
  }
  sfdae_destroy(&solver);
  return output;
}

// Values by the polynomial of the step are made consistent at once, which is tried once; in long steps it is not
// accurate enough. Two failures make the stages of the point fail with either linearization, so that the point is
// tried again; the first try has put a guess for these stages in the place of the polynomial that shows how accurate
// it is.
TEST(FailuresAtOutputs, ThatPassDoNotSpoilThePoint) {
  int passed = 0;
  for (int stages : {3, 5, 7})
    for (int steps = 2; steps <= 30; ++steps)
      for (double part : {0.1, 0.3, 0.5, 0.7, 0.9}) {
        SCOPED_TRACE(std::to_string(stages) + " stages, step " + std::to_string(steps) + ", " + std::to_string(part));
        const Output undisturbed = output_within_step(stages, steps, part, 0);
        const Output disturbed = output_within_step(stages, steps, part, 2);
        ASSERT_EQ(undisturbed.status, SFDAE_OK);
        if (disturbed.status == SFDAE_CALLBACK_FAILED) continue;
        ASSERT_EQ(disturbed.status, SFDAE_OK);
        ++passed;
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_NEAR(disturbed.x[i], undisturbed.x[i], iteration_error);
          EXPECT_NEAR(disturbed.xdot[i], undisturbed.xdot[i], iteration_error);
        }
      }
  EXPECT_GE(passed, 100);
}

// Where the equations can be evaluated at the output alone, the stages of a step that ends there fail, and a polynomial
// that is not accurate enough is all that is left.
TEST(FailuresAtOutputs, BesideThePointEndTheCallOrDoNotMatter) {
  int failed = 0;
  for (int stages : {3, 5, 7})
    for (int steps = 2; steps <= 30; ++steps)
      for (double part : {0.1, 0.5, 0.9}) {
        SCOPED_TRACE(std::to_string(stages) + " stages, step " + std::to_string(steps) + ", " + std::to_string(part));
        const Output undisturbed = output_within_step(stages, steps, part, 0);
        const Output disturbed = output_within_step(stages, steps, part, always, Fails::beside_it);
        failed += disturbed.status == SFDAE_CALLBACK_FAILED ? 1 : 0;
        if (disturbed.status == SFDAE_CALLBACK_FAILED) continue;
        ASSERT_EQ(disturbed.status, SFDAE_OK);
        for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(disturbed.x[i], undisturbed.x[i], iteration_error);
      }
  EXPECT_GE(failed, 10);
}

// Ranks cannot be checked without Jacobians: within steps of BDF, which judge them now and then only.
TEST(FailuresAtOutputs, OfJacobiansAreReportedWhereRanksAreToBeChecked) {
  int failed = 0, right = 0;
  for (int steps = 2; steps <= 60; ++steps)
    for (int failures : {1, always}) {
      const Output undisturbed = output_within_step(0, steps, 0.3, 0);
      const Output disturbed = output_within_step(0, steps, 0.3, failures, Fails::with_jacobians);
      if (disturbed.status == SFDAE_CALLBACK_FAILED) {
        EXPECT_EQ(failures, always);
        ++failed;
        continue;
      }
      ASSERT_EQ(disturbed.status, SFDAE_OK);
      ++right;
      for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(disturbed.x[i], undisturbed.x[i], iteration_error);
    }
  EXPECT_GE(failed, 30);
  EXPECT_GE(right, 30);
}

}  // namespace
}  // namespace sfdae_test
