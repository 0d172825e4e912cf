// The pendulum as a multibody system.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pendulum.h"

namespace sfdae::test {
namespace {

// phi'' = -sin phi by the classical Runge-Kutta method, with steps so short that rounding errors are all there is.
std::vector<double> reference(double phi, double omega, double t) {
  const int steps = 20000;
  const double h = t / steps;
  for (int i = 0; i < steps; ++i) {
    const double k1 = omega, l1 = -std::sin(phi);
    const double k2 = omega + 0.5 * h * l1, l2 = -std::sin(phi + 0.5 * h * k1);
    const double k3 = omega + 0.5 * h * l2, l3 = -std::sin(phi + 0.5 * h * k2);
    const double k4 = omega + h * l3, l4 = -std::sin(phi + h * k3);
    phi += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    omega += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
  }
  return Pendulum::state(phi, omega);
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

class PendulumRun : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, PendulumRun, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(PendulumRun, TurnsOverAndKeepsItsConstraints) {
  Pendulum pendulum;
  for (const double tol : {1e-4, 1e-6, 1e-8}) {
    MultibodyRun run(pendulum.problem(), options_of(GetParam(), tol));
    ASSERT_EQ(run.status, SFDAE_OK);
    ASSERT_EQ(run.start(0.0, 10.0, Pendulum::state(0.3, 2.2)), SFDAE_OK) << run.message();
    for (double t = 1.0; t <= 10.0; t += 1.0) {
      ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
      EXPECT_LE(std::fabs(run.x[0] * run.x[0] + run.x[1] * run.x[1] - 1.0), 1e-14);
      EXPECT_LE(std::fabs(run.x[0] * run.x[2] + run.x[1] * run.x[3]), 1e-14);
      EXPECT_LE(distance(run.x, reference(0.3, 2.2, t)), 50.0 * tol);
    }
    const sfdae_multibody_report report = run.report();
    // Twelve turns need a partition for every quarter of a turn at most, and one for every half of it at least.
    EXPECT_GE(report.partitions, 4);
    EXPECT_EQ(report.degrees_of_freedom, 1);
    EXPECT_LE(report.condition, 3.0);
  }
}

}  // namespace
}  // namespace sfdae::test
