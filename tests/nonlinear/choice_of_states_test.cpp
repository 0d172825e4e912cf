// SPDX-License-Identifier: BSD-3-Clause
// States of the minimal extension that determine the other unknowns at one point and do not at another: others have
// to take their place in time, and steps have to end before (docs/design/minimal_extension.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "nonlinear_run.h"
#include "test_set/formula_problems.h"
#include "test_set/test_set.h"

namespace {

using namespace sfdae_test;

sfdae_options by_extension(double tolerance, int method) {
  sfdae_options options = options_with(tolerance, method);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  return options;
}

// In tolerances.
double largest_error(const std::vector<double>& x, const std::vector<double>& exact, double tolerance) {
  double largest = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    largest = std::max(largest, std::fabs(x[i] - exact[i]) / (tolerance * (1.0 + std::fabs(exact[i]))));
  return largest;
}

// Each coordinate is a bad state somewhere, and the multiplier is zero: by how many of its sizes it moves with the
// states says nothing.
TEST(ChoiceOfStates, FollowsAMotionOnATorus) {
  const FormulaProblem& problem = formula_problem("torus");
  const TestProblem& p = problem.data;
  const NonlinearEquations equations = equations_of(
      p.m, p.n,
      [&problem](const auto& t, const auto* x, const auto* xdot, auto* F) { problem.residual(t, x, xdot, F); });
  std::vector<double> exact;
  for (const Jet& x : problem.exact(p.tf, 0)) exact.push_back(x[0]);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (double tolerance = 1e-4; tolerance > 1e-11; tolerance *= 0.1) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance);
      NonlinearRun run(equations, by_extension(tolerance, method));
      const int status = run.integrate(p.t0, p.tf, p.x0);
      ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
      EXPECT_LE(largest_error(run.x, exact, tolerance), method == SFDAE_METHOD_BDF ? 20.0 : 1.0);
      // One in ten attempts with BDF, one in three with Radau.
      const sfdae_statistics statistics = run.statistics();
      const long failures = statistics.error_failures + statistics.other_failures;
      EXPECT_LE(failures, method == SFDAE_METHOD_BDF ? statistics.steps / 10 : statistics.steps / 2);
    }
}

// Its energy is known. Newton's method at each stage finds something even if the height is a state on both sides of
// the lowest point.
TEST(ChoiceOfStates, TakesAPendulumThroughItsLowestPoint) {
  const TestProblem p = pendulum();
  const NonlinearEquations equations = equations_of(
      p.m, p.n, [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); });
  for (double tolerance = 1e-2; tolerance > 1e-11; tolerance *= std::sqrt(0.1)) {
    SCOPED_TRACE(tolerance);
    NonlinearRun run(equations, by_extension(tolerance, SFDAE_METHOD_RADAU));
    ASSERT_EQ(run.start(0.0, 10.0, p.x0), SFDAE_OK) << run.message();
    for (double t = 0.25; t <= 10.0; t += 0.25) {
      ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
      const double energy = 0.5 * (run.x[2] * run.x[2] + run.x[3] * run.x[3]) + Pendulum::gravity * run.x[1];
      ASSERT_LE(std::fabs(energy), 3.0 * tolerance * Pendulum::gravity) << t;
    }
  }
}

}  // namespace
