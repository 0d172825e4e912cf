// Multibody systems that are driven, stiff, badly scaled, or come near to singular configurations.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pendulum.h"

namespace sfdae::test {
namespace {

class HardCases : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, HardCases, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// q = cos t by a constraint: nothing is free, and lambda = -q'' = cos t.
struct Driven {
  static int forces(double, const double*, const double*, double*, void*) { return 0; }
  static int constraints(double t, const double* q, double* g, void*) {
    g[0] = q[0] - std::cos(t);
    return 0;
  }
  static int jacobian(double, const double*, double* g_q, void*) {
    g_q[0] = 1.0;
    return 0;
  }
  static int rate(double t, const double*, double* g_t, void*) {
    g_t[0] = std::sin(t);
    return 0;
  }
};

TEST_P(HardCases, NothingIsFree) {
  sfdae_multibody_problem problem = multibody_problem_of(1, 1);
  problem.forces = Driven::forces;
  problem.constraints = Driven::constraints;
  problem.constraint_jacobian = Driven::jacobian;
  problem.constraint_rate = Driven::rate;
  MultibodyRun run(problem, options_of(GetParam(), 1e-6));
  ASSERT_EQ(run.start(0.5, 9.0, {0.9, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_EQ(run.characteristics().differential, 0);
  EXPECT_EQ(run.report().degrees_of_freedom, 0);
  for (const double t : {0.7, 3.0, 9.0}) {
    ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.x[0], std::cos(t), 1e-14);
    EXPECT_NEAR(run.x[1], -std::sin(t), 1e-14);
    EXPECT_NEAR(run.x[2], std::cos(t), 1e-8);
    EXPECT_NEAR(run.xdot[1], -std::cos(t), 1e-8);
  }
}

// The pendulum on a pivot at (t^2 / 2, 0): seen from there gravity is (-1, -1).
TEST_P(HardCases, ConstraintsThatMove) {
  Pendulum pendulum;
  sfdae_multibody_problem problem = pendulum.problem();
  problem.constraints = [](double t, const double* q, double* g, void*) {
    const double x = q[0] - 0.5 * t * t;
    g[0] = 0.5 * (x * x + q[1] * q[1] - 1.0);
    return 0;
  };
  problem.constraint_jacobian = [](double t, const double* q, double* g_q, void*) {
    g_q[0] = q[0] - 0.5 * t * t;
    g_q[1] = q[1];
    return 0;
  };
  problem.constraint_rate = [](double t, const double* q, double* g_t, void*) {
    g_t[0] = -t * (q[0] - 0.5 * t * t);
    return 0;
  };
  problem.constraint_curvature = nullptr;
  MultibodyRun run(problem, options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 3.0, Pendulum::state(0.4, 0.0)), SFDAE_OK) << run.message();
  const double energy = run.x[0] + run.x[1];
  for (const double t : {1.0, 2.0, 3.0}) {
    ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
    const double x = run.x[0] - 0.5 * t * t, y = run.x[1], u = run.x[2] - t, v = run.x[3];
    EXPECT_NEAR(0.5 * (u * u + v * v) + x + y, energy, 1e-6);
    EXPECT_LE(std::fabs(x * x + y * y - 1.0), 1e-13);
    EXPECT_LE(std::fabs(x * u + y * v), 1e-13);
  }
}

// Two points at the distance 1, the second held near the slow motion (0, -2) by a spring and a damper of 1e6.
TEST_P(HardCases, StiffForcesDoNotMakeStepsShort) {
  sfdae_multibody_problem problem = multibody_problem_of(4, 1);
  problem.forces = [](double, const double* q, const double* v, double* f, void*) {
    f[1] = -1.0;
    f[2] = -1e6 * (q[2] + v[2]);
    f[3] = -1e6 * (q[3] + 2.0 + v[3]);
    return 0;
  };
  problem.constraints = [](double, const double* q, double* g, void*) {
    const double x = q[0] - q[2], y = q[1] - q[3];
    g[0] = 0.5 * (x * x + y * y - 1.0);
    return 0;
  };
  problem.constraint_jacobian = [](double, const double* q, double* g_q, void*) {
    g_q[0] = q[0] - q[2];
    g_q[1] = q[1] - q[3];
    g_q[2] = -g_q[0];
    g_q[3] = -g_q[1];
    return 0;
  };
  MultibodyRun run(problem, options_of(GetParam(), 1e-5));
  ASSERT_EQ(run.start(0.0, 20.0, {std::sin(0.5), -2.0 - std::cos(0.5), 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0}), SFDAE_OK)
      << run.message();
  ASSERT_EQ(run.advance(20.0), SFDAE_OK) << run.message();
  EXPECT_LE(run.statistics().steps, 1000);
  // The pendulum that is left has lost hardly any energy: the spring gives way by 1e-6.
  EXPECT_NEAR(0.5 * (run.x[4] * run.x[4] + run.x[5] * run.x[5]) + run.x[1] + 2.0, -std::cos(0.5), 2e-3);
}

// Units of constraints do not matter.
TEST_P(HardCases, BadlyScaledConstraints) {
  for (const double scale : {1e-8, 1e8}) {
    struct Scaled {
      Pendulum pendulum;
      double scale;
    } scaled{{}, scale};
    sfdae_multibody_problem problem = scaled.pendulum.problem();
    problem.user = &scaled;
    problem.constraints = [](double t, const double* q, double* g, void* user) {
      auto* self = static_cast<Scaled*>(user);
      Pendulum::constraints(t, q, g, &self->pendulum);
      g[0] *= self->scale;
      return 0;
    };
    problem.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
      for (int i = 0; i < 2; ++i) g_q[i] = static_cast<Scaled*>(user)->scale * q[i];
      return 0;
    };
    problem.constraint_curvature = nullptr;
    sfdae_options options = options_of(GetParam(), 1e-8);
    const std::vector<double> atol = {1e-8, 1e-8, 1e-8, 1e-8, 1e-8 / scale}, rtol(5, 1e-8);
    options.atol_vector = atol.data();
    options.rtol_vector = rtol.data();
    MultibodyRun run(problem, options);
    std::vector<double> start = Pendulum::state(0.3, 2.2);
    start[4] /= scale;
    ASSERT_EQ(run.start(0.0, 5.0, start), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(5.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(Pendulum::energy(run.x.data()), Pendulum::energy(start.data()), 1e-6);
    EXPECT_NEAR(scale * run.x[4], run.x[2] * run.x[2] + run.x[3] * run.x[3] - run.x[1], 1e-7);
  }
}

// Rods of lengths 1 and 1.0001 on a crank and a slider: near the upright position the constraint's gradient is as
// small as 0.014 and turns by 180 degrees within that. It is regular, and the motion goes on.
TEST_P(HardCases, NearlySingularConfigurationsArePassed) {
  sfdae_multibody_problem problem = multibody_problem_of(2, 1);
  problem.forces = [](double, const double*, const double*, double*, void*) { return 0; };
  problem.constraints = [](double, const double* q, double* g, void*) {
    g[0] = std::sin(q[0]) + 1.0001 * std::sin(q[1]);
    return 0;
  };
  problem.constraint_jacobian = [](double, const double* q, double* g_q, void*) {
    g_q[0] = std::cos(q[0]);
    g_q[1] = 1.0001 * std::cos(q[1]);
    return 0;
  };
  MultibodyRun run(problem, options_of(GetParam(), 1e-7));
  ASSERT_EQ(run.start(0.0, 3.0, {0.1, -0.1, 1.0, -1.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
  const double energy = run.x[2] * run.x[2] + run.x[3] * run.x[3];
  ASSERT_EQ(run.advance(3.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[2] * run.x[2] + run.x[3] * run.x[3], energy, 1e-4);
  EXPECT_LE(std::fabs(std::sin(run.x[0]) + 1.0001 * std::sin(run.x[1])), 1e-14);
}

// Started again at a point that it has reached, after a push.
TEST_P(HardCases, RestartsWithOtherVelocities) {
  Pendulum pendulum;
  MultibodyRun run(pendulum.problem(), options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 5.0, Pendulum::state(0.4, 0.0)), SFDAE_OK);
  ASSERT_EQ(run.advance(2.0), SFDAE_OK);
  std::vector<double> x = run.x;
  x[2] += 1.0;
  ASSERT_EQ(run.start(2.0, 5.0, x), SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_EQ(run.report().partitions, 1);
  const double energy = Pendulum::energy(run.x.data());
  ASSERT_EQ(run.advance(5.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(Pendulum::energy(run.x.data()), energy, 1e-6);
}

}  // namespace
}  // namespace sfdae::test
