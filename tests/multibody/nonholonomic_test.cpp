// Nonholonomic constraints, kinematics, and systems without constraints: exact solutions.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multibody_run.h"

namespace sfdae::test {
namespace {

class ExactSolutions : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, ExactSolutions, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// A knife edge on a plane inclined along q_1, of mass and moment of inertia 1, q = (x, y, phi): v_1 sin phi - v_2 cos
// phi = 0. With phi = omega t from rest in x, y: the speed u along the edge obeys u' = cos phi, so u = sin(omega t) /
// omega, x = sin^2(omega t) / (2 omega^2), y = (omega t - sin(omega t) cos(omega t)) / (2 omega^2).
struct KnifeEdge {
  static constexpr double omega = 1.5;
  static int forces(double, const double*, const double*, double* f, void*) {
    f[0] = 1.0;
    return 0;
  }
  static int matrix(double, const double* q, double* H, void*) {
    H[0] = std::sin(q[2]);
    H[1] = -std::cos(q[2]);
    return 0;
  }
  static int curvature(double, const double* q, const double* v, double* eta, void*) {
    eta[0] = v[2] * (std::cos(q[2]) * v[0] + std::sin(q[2]) * v[1]);
    return 0;
  }
};

TEST_P(ExactSolutions, KnifeEdgeOnAnInclinedPlane) {
  for (const bool has_curvature : {true, false}) {
    sfdae_multibody_problem problem = multibody_problem_of(3, 0);
    problem.num_nonholonomic = 1;
    problem.forces = KnifeEdge::forces;
    problem.nonholonomic_matrix = KnifeEdge::matrix;
    if (has_curvature) problem.nonholonomic_curvature = KnifeEdge::curvature;
    MultibodyRun run(problem, options_of(GetParam(), 1e-8));
    const double omega = KnifeEdge::omega;
    ASSERT_EQ(run.start(0.0, 5.0, {0.0, 0.0, 0.0, 0.0, 0.0, omega, 0.0}), SFDAE_OK) << run.message();
    EXPECT_EQ(run.characteristics().strangeness_index, 1);
    EXPECT_EQ(run.characteristics().differential, 5);
    for (const double t : {1.0, 2.5, 5.0}) {
      ASSERT_EQ(run.advance(t), SFDAE_OK) << run.message();
      const double s = std::sin(omega * t), c = std::cos(omega * t);
      EXPECT_NEAR(run.x[0], s * s / (2.0 * omega * omega), 2e-6);
      EXPECT_NEAR(run.x[1], (omega * t - s * c) / (2.0 * omega * omega), 2e-6);
      EXPECT_NEAR(run.x[2], omega * t, 2e-6);
      // M v' = f - H^T kappa, multiplied by H = (sin phi, -cos phi, 0).
      const double across = s - (run.xdot[3] * s - run.xdot[4] * c);
      EXPECT_NEAR(run.x[6], across, 1e-9);
      EXPECT_LE(std::fabs(run.x[3] * std::sin(run.x[2]) - run.x[4] * std::cos(run.x[2])), 1e-14);
    }
  }
}

TEST_P(ExactSolutions, OscillatorWithoutConstraints) {
  sfdae_multibody_problem problem = multibody_problem_of(1, 0);
  problem.forces = [](double, const double* q, const double*, double* f, void*) {
    f[0] = -q[0];
    return 0;
  };
  MultibodyRun run(problem, options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 10.0, {1.0, 0.0}), SFDAE_OK) << run.message();
  EXPECT_EQ(run.characteristics().strangeness_index, 0);
  EXPECT_EQ(run.characteristics().differential, 2);
  EXPECT_EQ(run.report().degrees_of_freedom, 1);
  ASSERT_EQ(run.advance(10.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[0], std::cos(10.0), 1e-6);
  EXPECT_NEAR(run.xdot[1], -run.x[0], 1e-14);
}

// A symmetric top without forces in Euler parameters: q' = S(q) w, |q| = 1 as a constraint that S keeps by itself.
// w_3 is constant and (w_1, w_2) turn with (J - 1) w_3, J = J_3 the other moments being 1.
struct Top {
  static constexpr double J = 2.0;
  static int mass(double, const double*, double* M, void*) {
    M[0] = M[4] = 1.0;
    M[8] = J;
    return 0;
  }
  static int forces(double, const double*, const double* w, double* f, void*) {
    f[0] = -(J - 1.0) * w[1] * w[2];
    f[1] = (J - 1.0) * w[0] * w[2];
    return 0;
  }
  static int kinematics(double, const double* q, double* S, void*) {
    const double rows[3][4] = {{-q[1], q[0], q[3], -q[2]}, {-q[2], -q[3], q[0], q[1]}, {-q[3], q[2], -q[1], q[0]}};
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) S[i + 4 * j] = 0.5 * rows[j][i];
    return 0;
  }
  static int constraints(double, const double* q, double* g, void*) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0);
    return 0;
  }
  static int jacobian(double, const double* q, double* g_q, void*) {
    for (int i = 0; i < 4; ++i) g_q[i] = q[i];
    return 0;
  }
};

TEST_P(ExactSolutions, TopInEulerParameters) {
  sfdae_multibody_problem problem = multibody_problem_of(4, 1);
  problem.num_velocities = 3;
  problem.mass = Top::mass;
  problem.forces = Top::forces;
  problem.kinematics = Top::kinematics;
  problem.constraints = Top::constraints;
  problem.constraint_jacobian = Top::jacobian;
  MultibodyRun run(problem, options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 6.0, {1.0, 0.0, 0.0, 0.0, 0.3, 0.0, 1.2, 0.0}), SFDAE_OK) << run.message();
  // Nothing of the constraint is left on the level of velocities.
  EXPECT_EQ(run.report().redundant, 1);
  EXPECT_EQ(run.report().degrees_of_freedom, 3);
  EXPECT_EQ(run.report().position_freedom, 3);
  ASSERT_EQ(run.advance(6.0), SFDAE_OK) << run.message();
  const double angle = (Top::J - 1.0) * 1.2 * 6.0;
  EXPECT_NEAR(run.x[4], 0.3 * std::cos(angle), 1e-6);
  EXPECT_NEAR(run.x[5], 0.3 * std::sin(angle), 1e-6);
  EXPECT_NEAR(run.x[6], 1.2, 1e-6);
  EXPECT_EQ(run.x[7], 0.0);
  double length = 0.0;
  for (int i = 0; i < 4; ++i) length += run.x[static_cast<std::size_t>(i)] * run.x[static_cast<std::size_t>(i)];
  EXPECT_NEAR(length, 1.0, 1e-14);
}

}  // namespace
}  // namespace sfdae::test
