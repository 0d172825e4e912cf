// SPDX-License-Identifier: BSD-3-Clause
// Equations multiplied by matrices that depend on the solution: ranks hold on F_mu = 0 only.
#include <gtest/gtest.h>

#include <cmath>

#include "matrix_checks.h"
#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;

// w' = -w + sin t, e' = y - cos t with e = z - sin t = 0: x = (w, cos t, sin t), mu = 1. The first and the last
// equation turn by an angle that depends on y, whose derivative is free in F_1 = 0: away from e = 0 the pivot |F|
// appears in F_y'.
NonlinearEquations turned_by_hidden_component(double strength) {
  return equations_of(3, 3, [strength](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin, std::cos;
    const auto dynamics = xdot[0] + x[0] - sin(t), constraint = x[2] - sin(t);
    const auto angle = 0.7 + strength * sin(x[1]);
    F[0] = cos(angle) * dynamics - sin(angle) * constraint;
    F[1] = xdot[2] - x[1];
    F[2] = sin(angle) * dynamics + cos(angle) * constraint;
  });
}
double exact_w(double t) { return 0.5 * (std::sin(t) - std::cos(t)) + 0.5 * std::exp(-t); }

TEST(MixedEquations, AreSolvedThoughRanksHoldOnTheSolutionOnly) {
  for (const double strength : {0.3, 1.0})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (const double tolerance : {1e-4, 1e-7}) {
        SCOPED_TRACE(testing::Message() << "strength " << strength << ", method " << method << ", " << tolerance);
        NonlinearRun run(turned_by_hidden_component(strength), options_with(tolerance, method));
        const int status = run.integrate(0.0, 3.0, {0.0, 1.0, 0.0});
        ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
        EXPECT_EQ(run.values(), (CharacteristicValues{1, 1, 2, 0, 0}));
        EXPECT_NEAR(run.x[0], exact_w(3.0), 100.0 * tolerance);
        // Constraints hold to rounding.
        EXPECT_NEAR(run.x[1], std::cos(3.0), 1e-10);
        EXPECT_NEAR(run.x[2], std::sin(3.0), 1e-10);
      }
}

// The same with the constraint once more, times a function of the solution: v = 1.
TEST(MixedEquations, RedundantOnesDoNotContradictWhileIterationsConverge) {
  const auto residual = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    turned_by_hidden_component(1.0).write(nullptr, t, x, xdot, F);
    using std::cos;
    F[3] = (1.5 + cos(x[1])) * F[2] + F[0] * F[1] - 0.3 * F[0];
  };
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tolerance : {1e-3, 1e-5, 1e-8}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", " << tolerance);
      NonlinearRun run(equations_of(4, 3, residual), options_with(tolerance, method));
      const int status = run.integrate(0.0, 3.0, {0.0, 1.0, 0.0});
      ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
      EXPECT_EQ(run.values(), (CharacteristicValues{1, 1, 2, 0, 1}));
      EXPECT_NEAR(run.x[0], exact_w(3.0), 100.0 * tolerance);
    }
}

// F1 = 0 makes x2' F1 vanish in the second equation: what rounding leaves of it is no differential equation.
TEST(MixedEquations, MultiplesOfConstraintsAreNoDifferentialEquations) {
  const auto circle = [](const auto& t, const auto* x) { return x[0] * x[0] + x[1] * x[1] - 1.0 - 0.1 * sin(t); };
  const auto equations = equations_of(2, 2, [circle](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = circle(t, x);
    F[1] = x[0] - x[1] * cos(t) + xdot[1] * F[0];
  });
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(equations, options_with(1e-6, method));
    ASSERT_EQ(run.start(0.3, 2.0, {0.7, 0.8}), SFDAE_OK) << run.message();
    EXPECT_EQ(run.values(), (CharacteristicValues{0, 0, 2, 0, 0}));
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(circle(2.0, run.x.data()), 0.0, 1e-15);
    EXPECT_NEAR(run.x[0] - run.x[1] * std::cos(2.0), 0.0, 1e-15);
  }
}

}  // namespace
