// Constraints that depend on each other: everywhere, in contradiction, or in singular configurations.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pendulum.h"

namespace sfdae::test {
namespace {

using std::numbers::pi;

TEST(RedundantConstraints, ShareTheForceEvenlyAndChangeNothingElse) {
  Pendulum single, twice{2, 0.0};
  const sfdae_options options = options_of(SFDAE_METHOD_RADAU, 1e-8);
  MultibodyRun one(single.problem(), options), two(twice.problem(), options);
  ASSERT_EQ(one.start(0.0, 5.0, Pendulum::state(1.0, 0.5)), SFDAE_OK);
  ASSERT_EQ(two.start(0.0, 5.0, Pendulum::state(1.0, 0.5)), SFDAE_OK) << two.message();
  EXPECT_EQ(two.report().redundant, 1);
  EXPECT_EQ(two.report().degrees_of_freedom, 1);
  EXPECT_EQ(two.characteristics().differential, 2);
  EXPECT_EQ(two.characteristics().algebraic, 4);
  EXPECT_EQ(two.characteristics().undetermined, 0);
  EXPECT_EQ(two.characteristics().redundant, 0);
  ASSERT_EQ(one.advance(5.0), SFDAE_OK);
  ASSERT_EQ(two.advance(5.0), SFDAE_OK) << two.message();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(one.x[i], two.x[i], 1e-7);
  // Least norm: half of the force in each.
  EXPECT_NEAR(two.x[4], 0.5 * one.x[4], 1e-7);
  EXPECT_NEAR(two.x[5], two.x[4], 1e-12);
}

TEST(RedundantConstraints, ContradictionIsRefusedWithTheConstraintAndItsSize) {
  Pendulum pendulum{2, 0.01};
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    MultibodyRun run(pendulum.problem(), options_of(method, 1e-6));
    EXPECT_EQ(run.start(0.0, 1.0, Pendulum::state(1.0, 0.5)), SFDAE_INCONSISTENT_EQUATIONS);
    EXPECT_NE(run.message().find("holonomic constraint"), std::string::npos) << run.message();
    // Least squares leaves half of the offset in both.
    EXPECT_NE(run.message().find("0.005"), std::string::npos) << run.message();
  }
}

// The second constraint is the first one and a small multiple of q_3.
sfdae_multibody_problem nearly_redundant(double* small) {
  sfdae_multibody_problem problem = multibody_problem_of(3, 2);
  problem.user = small;
  problem.forces = [](double, const double*, const double*, double* f, void*) {
    f[1] = -1.0;
    return 0;
  };
  problem.constraints = [](double, const double* q, double* g, void* user) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    g[1] = g[0] + *static_cast<const double*>(user) * q[2];
    return 0;
  };
  problem.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
    g_q[0] = g_q[1] = q[0];
    g_q[2] = g_q[3] = q[1];
    g_q[5] = *static_cast<const double*>(user);
    return 0;
  };
  return problem;
}

// What is too near to the rounding errors to be judged, or regular but not so to working accuracy, is left to the
// user.
TEST(RedundantConstraints, NearOnesAreDecidedByTheTolerance) {
  struct Case {
    double small;
    int status;
  };
  for (Case one : {Case{3e-13, SFDAE_RANK_UNCLEAR}, Case{1e-10, SFDAE_SINGULAR}}) {
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae_options options = options_of(method, 1e-8);
      const std::vector<double> start = {0.6, -0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
      MultibodyRun undecided(nearly_redundant(&one.small), options);
      EXPECT_EQ(undecided.start(0.0, 3.0, start), one.status);
      EXPECT_NE(undecided.message().find("rank_tol"), std::string::npos) << undecided.message();
      options.rank_tol = 1e-6;
      MultibodyRun run(nearly_redundant(&one.small), options);
      ASSERT_EQ(run.start(0.0, 3.0, start), SFDAE_OK) << run.message();
      EXPECT_EQ(run.report().redundant, 1);
      ASSERT_EQ(run.advance(3.0), SFDAE_OK) << run.message();
      EXPECT_NEAR(0.5 * (run.x[3] * run.x[3] + run.x[4] * run.x[4]) + run.x[1], -0.8, 1e-6);
      EXPECT_NEAR(run.x[6], run.x[7], 1e-9);
    }
  }
}

// The motion is that of the constraint chosen among the two.
TEST(RedundantConstraints, ContradictionIsIgnoredIfAskedFor) {
  Pendulum pendulum{2, 1e-4};
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae_options options = options_of(method, 1e-8);
    options.ignore_inconsistency = 1;
    MultibodyRun run(pendulum.problem(), options);
    EXPECT_EQ(run.start(0.0, 1.0, Pendulum::state(1.0, 0.5)), SFDAE_INCONSISTENCY_IGNORED) << run.message();
    const double energy = Pendulum::energy(run.x.data()), length = std::hypot(run.x[0], run.x[1]);
    EXPECT_EQ(run.advance(1.0), SFDAE_INCONSISTENCY_IGNORED) << run.message();
    EXPECT_NEAR(Pendulum::energy(run.x.data()), energy, 1e-6);
    EXPECT_NEAR(std::hypot(run.x[0], run.x[1]), length, 1e-13);
  }
}

// A second constraint that agrees up to t = 1 only: |q|^2 = 1 + (t - 1)^2 from then on.
struct LateContradiction {
  static int constraints(double t, const double* q, double* g, void*) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    g[1] = g[0] - (t > 1.0 ? 0.5 * (t - 1.0) * (t - 1.0) * (t - 1.0) : 0.0);
    return 0;
  }
  static int rate(double t, const double*, double* g_t, void*) {
    g_t[1] = t > 1.0 ? -1.5 * (t - 1.0) * (t - 1.0) : 0.0;
    return 0;
  }
};

TEST(RedundantConstraints, ContradictionOnTheWayStopsTheIntegration) {
  Pendulum pendulum{2, 0.0};
  sfdae_multibody_problem problem = pendulum.problem();
  problem.constraints = LateContradiction::constraints;
  problem.constraint_rate = LateContradiction::rate;
  problem.constraint_curvature = nullptr;
  MultibodyRun run(problem, options_of(SFDAE_METHOD_BDF, 1e-6));
  ASSERT_EQ(run.start(0.0, 3.0, Pendulum::state(1.0, 0.5)), SFDAE_OK) << run.message();
  EXPECT_EQ(run.advance(3.0), SFDAE_INCONSISTENT_EQUATIONS);
  EXPECT_NE(run.message().find("holonomic constraint"), std::string::npos) << run.message();
  EXPECT_GE(run.t, 0.9);
  EXPECT_LE(run.t, 1.2);
}

// Crank and rod of equal length, (sin phi_1 + sin phi_2) = 0: where both stand upright the gradient (cos phi_1, cos
// phi_2) vanishes and two branches of motion cross.
struct CrankAndRod {
  static int forces(double, const double*, const double*, double*, void*) { return 0; }
  static int constraints(double, const double* q, double* g, void*) {
    g[0] = std::sin(q[0]) + std::sin(q[1]);
    return 0;
  }
  static int jacobian(double, const double* q, double* g_q, void*) {
    g_q[0] = std::cos(q[0]);
    g_q[1] = std::cos(q[1]);
    return 0;
  }
  static sfdae_multibody_problem problem() {
    sfdae_multibody_problem result = multibody_problem_of(2, 1);
    result.forces = forces;
    result.constraints = constraints;
    result.constraint_jacobian = jacobian;
    return result;
  }
};

class SingularConfiguration : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, SingularConfiguration, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(SingularConfiguration, IsFoundAndNotPassedSilently) {
  MultibodyRun run(CrankAndRod::problem(), options_of(GetParam(), 1e-6));
  ASSERT_EQ(run.start(0.0, 3.0, {0.1, -0.1, 1.0, -1.0, 0.0}), SFDAE_OK) << run.message();
  EXPECT_EQ(run.advance(3.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
  // phi_1 = 0.1 + t
  EXPECT_NEAR(run.t, 0.5 * pi - 0.1, 1e-4);
  EXPECT_NE(run.message().find("singular"), std::string::npos) << run.message();
  EXPECT_NE(run.message().find("holonomic constraint 0"), std::string::npos) << run.message();
}

// Two or three of them that do the same: the determinant of two does not change its sign.
TEST_P(SingularConfiguration, OfTwoMechanismsAtOnceAreNotPassedSilently) {
  struct Twins {
    int count;
    static int of(void* user) { return static_cast<const Twins*>(user)->count; }
  };
  for (int count : {2, 3}) {
    Twins twins{count};
    sfdae_multibody_problem problem = multibody_problem_of(2 * count, count);
    problem.user = &twins;
    problem.forces = CrankAndRod::forces;
    problem.constraints = [](double t, const double* q, double* g, void* user) {
      for (int k = 0; k < Twins::of(user); ++k) CrankAndRod::constraints(t, q + 2 * k, g + k, nullptr);
      return 0;
    };
    problem.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
      const int rows = Twins::of(user);
      for (int j = 0; j < 2 * rows; ++j) g_q[j / 2 + rows * j] = std::cos(q[j]);
      return 0;
    };
    std::vector<double> x(static_cast<std::size_t>(5 * count));
    for (std::size_t j = 0; j < static_cast<std::size_t>(2 * count); ++j) {
      const double sign = j % 2 == 0 ? 1.0 : -1.0;
      x[j] = 0.1 * sign;
      x[j + static_cast<std::size_t>(2 * count)] = sign;
    }
    MultibodyRun run(problem, options_of(GetParam(), 1e-6));
    ASSERT_EQ(run.start(0.0, 3.0, x), SFDAE_OK) << run.message();
    EXPECT_EQ(run.advance(3.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
    EXPECT_NEAR(run.t, 0.5 * pi - 0.1, 1e-4);
    EXPECT_NE(run.message().find("vanishes"), std::string::npos) << run.message();
  }
}

TEST_P(SingularConfiguration, IsRefusedAtTheStart) {
  MultibodyRun run(CrankAndRod::problem(), options_of(GetParam(), 1e-6));
  EXPECT_EQ(run.start(0.0, 3.0, {0.5 * pi, -0.5 * pi, 1.0, -1.0, 0.0}), SFDAE_CHARACTERISTICS_CHANGED)
      << run.message();
}

// (q_1 - q_2)^2 = 0: the gradient vanishes wherever the constraint holds, and says nothing about velocities.
TEST_P(SingularConfiguration, SquaredConstraintsAreRefused) {
  sfdae_multibody_problem problem = CrankAndRod::problem();
  problem.constraints = [](double, const double* q, double* g, void*) {
    g[0] = (q[0] - q[1]) * (q[0] - q[1]);
    return 0;
  };
  problem.constraint_jacobian = [](double, const double* q, double* g_q, void*) {
    g_q[0] = 2.0 * (q[0] - q[1]);
    g_q[1] = -g_q[0];
    return 0;
  };
  for (const double q : {0.5, 0.8}) {
    MultibodyRun run(problem, options_of(GetParam(), 1e-6));
    EXPECT_EQ(run.start(0.0, 1.0, {0.5, q, 1.0, 1.0, 0.0}), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
    EXPECT_NE(run.message().find("gradient of holonomic constraint 0 vanishes"), std::string::npos) << run.message();
  }
}

// M = diag(1, 0) with the constraint q_2 = 0 is regular, with q_1 = 0 nothing determines q_2''.
struct Massless {
  int component = 1;
  static int mass(double, const double*, double* M, void*) {
    M[0] = 1.0;
    return 0;
  }
  static int forces(double, const double* q, const double*, double* f, void*) {
    f[0] = -q[0];
    f[1] = -3.0;
    return 0;
  }
  static int constraints(double, const double* q, double* g, void* user) {
    g[0] = q[static_cast<const Massless*>(user)->component];
    return 0;
  }
  static int jacobian(double, const double*, double* g_q, void* user) {
    g_q[static_cast<const Massless*>(user)->component] = 1.0;
    return 0;
  }
  sfdae_multibody_problem problem() {
    sfdae_multibody_problem result = multibody_problem_of(2, 1);
    result.mass = mass;
    result.forces = forces;
    result.constraints = constraints;
    result.constraint_jacobian = jacobian;
    result.user = this;
    return result;
  }
};

TEST(SingularMass, IsFineWhereConstraintsHoldWhatHasNoMass) {
  Massless model;
  MultibodyRun run(model.problem(), options_of(SFDAE_METHOD_RADAU, 1e-9));
  ASSERT_EQ(run.start(0.0, 2.0, {1.0, 0.0, 0.0, 0.0, 0.0}), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[4], -3.0, 1e-12);
  ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[0], std::cos(2.0), 1e-7);
  EXPECT_NEAR(run.x[4], -3.0, 1e-7);
}

TEST(SingularMass, IsRefusedWhereNothingDeterminesAnAcceleration) {
  Massless model{0};
  MultibodyRun run(model.problem(), options_of(SFDAE_METHOD_RADAU, 1e-9));
  EXPECT_EQ(run.start(0.0, 2.0, {0.0, 0.0, 0.0, 0.0, 0.0}), SFDAE_SINGULAR) << run.message();
}

}  // namespace
}  // namespace sfdae::test
