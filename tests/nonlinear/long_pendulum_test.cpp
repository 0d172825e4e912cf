// SPDX-License-Identifier: BSD-3-Clause
// The raw pendulum of index 3 over 100 periods: energy, phase, constraints.
#include <gtest/gtest.h>

#include <cmath>

#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;

constexpr double gravity = 9.81;

NonlinearEquations raw_pendulum() {
  return equations_of(5, 5, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] * x[4];
    F[3] = xdot[3] + x[1] * x[4] + gravity;
    F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
  });
}

// Released at rest from the horizontal it is there again after T = 4 K(sin 45 deg) / sqrt(g). Errors of the energy,
// 0, add up over some 10 steps a radian; those of the phase are errors of the energy, added up once more.
TEST(LongPendulum, KeepsEnergyAndPhaseOverAHundredPeriods) {
  constexpr double K = 1.8540746773013719;
  const double period = 4.0 * K / std::sqrt(gravity), radians = 100.0 * 2.0 * std::acos(-1.0);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tolerance : {1e-6, 1e-8}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", " << tolerance);
      NonlinearRun run(raw_pendulum(), options_with(tolerance, method));
      const int status = run.integrate(0.0, 100.0 * period, {1.0, 0.0, 0.0, 0.0, 0.0});
      ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
      const std::vector<double>& x = run.x;
      const double energy = 0.5 * (x[2] * x[2] + x[3] * x[3]) + gravity * x[1];
      EXPECT_LE(std::fabs(energy), 10.0 * radians * tolerance);
      EXPECT_LE(std::fabs(x[3] / gravity), 100.0 * radians * tolerance);  // v = -g (t - 100 T): time lost
      EXPECT_LE(std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), 1e-13);
      EXPECT_LE(std::fabs(x[0] * x[2] + x[1] * x[3]), 1e-12);
    }
}

}  // namespace
