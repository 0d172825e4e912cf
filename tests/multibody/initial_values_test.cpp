// Consistent positions, velocities and forces from values that are not.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "pendulum.h"

namespace sfdae::test {
namespace {

class InitialValues : public testing::Test {
 protected:
  Pendulum pendulum;
  sfdae_options options = options_of(SFDAE_METHOD_BDF, 1e-6);
  static double length(double a, double b) { return std::sqrt(a * a + b * b); }
};

// Nearest on the circle: along the radius. The velocity loses its radial part.
TEST_F(InitialValues, FarAwayGoToTheNearestPoint) {
  MultibodyRun run(pendulum.problem(), options);
  const double x = 0.6 * 1.3, y = -0.8 * 1.3, vx = 1.0, vy = 2.0;
  ASSERT_EQ(run.start(0.0, 1.0, {x, y, vx, vy, 77.0}), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_NEAR(run.x[0], 0.6, 1e-7);
  EXPECT_NEAR(run.x[1], -0.8, 1e-7);
  const double radial = 0.6 * vx - 0.8 * vy;
  EXPECT_NEAR(run.x[2], vx - 0.6 * radial, 1e-6);
  EXPECT_NEAR(run.x[3], vy + 0.8 * radial, 1e-6);
  EXPECT_LE(std::fabs(length(run.x[0], run.x[1]) - 1.0), 1e-14);
  EXPECT_LE(std::fabs(run.x[0] * run.x[2] + run.x[1] * run.x[3]), 1e-14);
  // |v|^2 - g q_2
  EXPECT_NEAR(run.x[4], run.x[2] * run.x[2] + run.x[3] * run.x[3] - run.x[1], 1e-13);
}

TEST_F(InitialValues, SlopesAreThoseOfTheSolution) {
  MultibodyRun run(pendulum.problem(), options);
  ASSERT_EQ(run.start(0.0, 1.0, Pendulum::state(0.7, 1.1)), SFDAE_OK) << run.message();
  const std::vector<double>& x = run.x;
  EXPECT_EQ(run.xdot[0], x[2]);
  EXPECT_EQ(run.xdot[1], x[3]);
  EXPECT_NEAR(run.xdot[2], -x[4] * x[0], 1e-14);
  EXPECT_NEAR(run.xdot[3], -x[4] * x[1] - 1.0, 1e-14);
  // lambda = omega^2 + cos phi, omega' = -sin phi
  EXPECT_NEAR(run.xdot[4], -3.0 * 1.1 * std::sin(0.7), 1e-9);
}

// The mass is that of the kinetic energy: what is heavy moves less. dq = -M^-1 G^T (...), so 4 dq_1 / q_1 = dq_2 /
// q_2.
TEST_F(InitialValues, HeavyComponentsMoveLess) {
  sfdae_multibody_problem problem = pendulum.problem();
  problem.mass = [](double, const double*, double* M, void*) {
    M[0] = 4.0;
    M[3] = 1.0;
    return 0;
  };
  MultibodyRun run(problem, options);
  const std::vector<double> given = {0.7, -0.8, 0.3, 0.4, 0.0};
  ASSERT_EQ(run.start(0.0, 1.0, given), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_NEAR(4.0 * (run.x[0] - given[0]) / run.x[0], (run.x[1] - given[1]) / run.x[1], 1e-6);
  EXPECT_NEAR(4.0 * (run.x[2] - given[2]) / run.x[0], (run.x[3] - given[3]) / run.x[1], 1e-12);
}

// M that is not symmetric is no energy: changes are measured in the 2-norm. The equations stay those that are given.
TEST_F(InitialValues, MassesNeedNotBeSymmetric) {
  sfdae_multibody_problem problem = pendulum.problem();
  problem.mass = [](double, const double*, double* M, void*) {
    M[0] = 4.0;
    M[1] = 1.0;
    M[3] = 2.0;
    return 0;
  };
  MultibodyRun run(problem, options);
  const std::vector<double> given = {0.7, -0.8, 0.3, 0.4, 0.0};
  ASSERT_EQ(run.start(0.0, 1.0, given), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_NEAR((run.x[0] - given[0]) / run.x[0], (run.x[1] - given[1]) / run.x[1], 1e-6);
  EXPECT_NEAR((run.x[2] - given[2]) / run.x[0], (run.x[3] - given[3]) / run.x[1], 1e-12);
  ASSERT_EQ(run.advance(1.0), SFDAE_OK) << run.message();
  const std::vector<double>&x = run.x, &xdot = run.xdot;
  EXPECT_NEAR(4.0 * xdot[2], -x[4] * x[0], 1e-13);
  EXPECT_NEAR(xdot[2] + 2.0 * xdot[3], -1.0 - x[4] * x[1], 1e-13);
}

TEST_F(InitialValues, WeightsOfTheUserCount) {
  const std::vector<double> weights = {1.0, 100.0, 1.0, 100.0, 1.0};
  options.initial_weights = weights.data();
  MultibodyRun run(pendulum.problem(), options);
  const std::vector<double> given = {0.7, -0.8, 0.3, 0.4, 0.0};
  ASSERT_EQ(run.start(0.0, 1.0, given), SFDAE_OK) << run.message();
  EXPECT_NEAR(1e4 * (run.x[0] - given[0]) / run.x[0], (run.x[1] - given[1]) / run.x[1], 1e-5);
}

TEST_F(InitialValues, FixedComponentsStay) {
  const int fixed[] = {1, 0, 1, 0, 0};
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  MultibodyRun run(pendulum.problem(), options);
  ASSERT_EQ(run.start(0.0, 1.0, {0.6, -0.7, 0.3, 5.0, 0.0}), SFDAE_OK) << run.message();
  EXPECT_EQ(run.x[0], 0.6);
  EXPECT_EQ(run.x[2], 0.3);
  EXPECT_NEAR(run.x[1], -0.8, 1e-14);
  EXPECT_NEAR(run.x[3], 0.3 * 0.6 / 0.8, 1e-14);
}

TEST_F(InitialValues, FixedComponentsThatCannotBeAreRefused) {
  int fixed[] = {1, 1, 0, 0, 0};
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  MultibodyRun positions(pendulum.problem(), options);
  std::vector<double> given = {0.6, -0.7, 0.0, 0.0, 0.0};
  EXPECT_EQ(positions.start(0.0, 1.0, given), SFDAE_FIXED_VALUES) << positions.message();
  EXPECT_EQ(positions.x, given);
  fixed[0] = fixed[1] = 0;
  fixed[2] = fixed[3] = 1;
  MultibodyRun velocities(pendulum.problem(), options);
  EXPECT_EQ(velocities.start(0.0, 1.0, {0.6, -0.8, 1.0, 0.0, 0.0}), SFDAE_FIXED_VALUES) << velocities.message();
  fixed[2] = fixed[3] = 0;
  fixed[4] = 1;
  MultibodyRun forces(pendulum.problem(), options);
  EXPECT_EQ(forces.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 3.0}), SFDAE_FIXED_VALUES) << forces.message();
  EXPECT_EQ(forces.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.8}), SFDAE_OK) << forces.message();
}

TEST_F(InitialValues, AcceptedAsGivenOrRefused) {
  options.initial_values = SFDAE_INITIAL_ACCEPT;
  MultibodyRun run(pendulum.problem(), options);
  const std::vector<double> good = Pendulum::state(0.4, 0.2);
  ASSERT_EQ(run.start(0.0, 1.0, good), SFDAE_OK) << run.message();
  EXPECT_EQ(run.x, good);
  std::vector<double> bad = good;
  bad[0] += 1e-3;
  EXPECT_EQ(run.start(0.0, 1.0, bad), SFDAE_INCONSISTENT_VALUES) << run.message();
  EXPECT_EQ(run.x, bad);
}

// x^2 + y^2 + 1 = 0: residuals are least at the origin, where the gradient vanishes.
TEST_F(InitialValues, NoneAreReportedWhereThereAreNone) {
  pendulum.offset = 1.0;
  MultibodyRun run(pendulum.problem(), options);
  const std::vector<double> given = {0.6, -0.7, 0.0, 0.0, 0.0};
  const int status = run.start(0.0, 1.0, given);
  EXPECT_TRUE(status == SFDAE_NO_CONSISTENT_VALUES || status == SFDAE_INCONSISTENT_EQUATIONS) << run.message();
  EXPECT_EQ(run.x, given);
}

TEST_F(InitialValues, MakeConsistentLeavesTheIntegrationAlone) {
  MultibodyRun run(pendulum.problem(), options);
  ASSERT_EQ(run.start(0.0, 2.0, Pendulum::state(0.4, 0.2)), SFDAE_OK);
  ASSERT_EQ(run.advance(1.0), SFDAE_OK);
  std::vector<double> x = {1.2, 0.0, 0.0, 0.0, 0.0};
  ASSERT_EQ(sfdae_make_consistent(run.solver.get(), 1.0, x.data(), nullptr), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_NEAR(x[0], 1.0, 1e-12);
  ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
  MultibodyRun other(pendulum.problem(), options);
  other.start(0.0, 2.0, Pendulum::state(0.4, 0.2));
  other.advance(1.0);
  other.advance(2.0);
  EXPECT_EQ(run.x, other.x);
}

}  // namespace
}  // namespace sfdae::test
