// Multibody systems where positions, velocities or masses vanish, and where units of constraints differ very much.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "pendulum.h"

namespace sfdae::test {
namespace {

class SmallValues : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, SmallValues, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// The pendulum of length 1 seen from its lowest point, damped: g is rounded as lengths of 1 are, wherever q is. The
// constraint is repeated in other units.
struct LowPendulum {
  int copies = 1;
  double damping = 0.0;
  double unit = 2.0;   // of each copy in that of the one before
  double first = 1.0;  // unit

  sfdae_multibody_problem problem() {
    sfdae_multibody_problem result = multibody_problem_of(2, copies);
    result.user = this;
    result.forces = [](double, const double*, const double* v, double* f, void* user) {
      const auto& self = *static_cast<LowPendulum*>(user);
      f[0] = -self.damping * v[0];
      f[1] = -1.0 - self.damping * v[1];
      return 0;
    };
    result.constraints = [](double, const double* q, double* g, void* user) {
      const auto& self = *static_cast<LowPendulum*>(user);
      for (int i = 0; i < self.copies; ++i)
        g[i] = self.first * std::pow(self.unit, i) * 0.5 * (q[0] * q[0] + (q[1] - 1.0) * (q[1] - 1.0) - 1.0);
      return 0;
    };
    result.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
      const auto& self = *static_cast<LowPendulum*>(user);
      for (int i = 0; i < self.copies; ++i) {
        g_q[i] = self.first * std::pow(self.unit, i) * q[0];
        g_q[i + self.copies] = self.first * std::pow(self.unit, i) * (q[1] - 1.0);
      }
      return 0;
    };
    return result;
  }
};

TEST_P(SmallValues, MotionsComeToRestAtTheOrigin) {
  for (const int copies : {1, 2})
    for (const double tol : {1e-7, 1e-11}) {
      LowPendulum pendulum{copies, 3.0};
      MultibodyRun run(pendulum.problem(), options_of(GetParam(), tol));
      ASSERT_EQ(run.start(0.0, 200.0, {0.3, 0.0, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
      ASSERT_EQ(run.advance(200.0), SFDAE_OK) << run.message();
      EXPECT_LE(std::fabs(run.x[0]), 10.0 * tol);
      EXPECT_LE(std::fabs(run.x[1]), 1e-15);
    }
}

TEST_P(SmallValues, EventsAtTheOriginAreReachedAndStartedFrom) {
  for (const int copies : {1, 2}) {
    LowPendulum pendulum{copies};
    MultibodyRun run(pendulum.problem(), options_of(GetParam(), 1e-8));
    ASSERT_EQ(run.start(0.0, 30.0, {0.3, 0.05, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
    const auto crossing = [](double, const double* x, const double*, double* g, void*) {
      g[0] = x[0];
      return 0;
    };
    ASSERT_EQ(sfdae_set_events(run.solver.get(), 1, crossing, nullptr, nullptr), SFDAE_OK);
    double before = 0.0, period = 0.0;
    for (int k = 0; k < 6; ++k) {
      ASSERT_EQ(run.advance(30.0), SFDAE_EVENT) << run.message();
      if (k == 1) period = run.t - before;
      if (k > 1) {
        EXPECT_NEAR(run.t - before, period, 1e-5);
      }
      before = run.t;
      ASSERT_EQ(run.start(run.t, 30.0, run.x), SFDAE_OK) << run.message();
    }
  }
}

// 200 steps are many times what either method needs, whatever the unit of the copy.
TEST_P(SmallValues, UnitsOfRedundantConstraintsDoNotMatter) {
  for (const double unit : {1.0, 1e-6, 1e6}) {
    LowPendulum pendulum{2, 0.0, unit};
    MultibodyRun run(pendulum.problem(), options_of(GetParam(), 1e-6));
    ASSERT_EQ(run.start(0.0, 2.0, {0.8, 0.4, 0.0, 0.0}), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_LE(run.statistics().steps, 200) << unit;
  }
}

// Squares of this gradient overflow, but there is a constraint all the same.
TEST_P(SmallValues, UnitsNearOverflowDoNotHideConstraints) {
  LowPendulum pendulum{1, 0.0, 1.0, 1e200};
  MultibodyRun run(pendulum.problem(), options_of(GetParam(), 1e-8));
  // Too much for the matrix of the equations, perhaps, but then that is said.
  if (run.start(0.0, 2.0, {0.3, 0.05, 0.0, 0.0}) == SFDAE_SINGULAR) return;
  ASSERT_EQ(run.status, SFDAE_VALUES_CHANGED) << run.message();
  EXPECT_EQ(run.report().degrees_of_freedom, 1);
}

// v_1 = 0 and v_1 + q_2 v_2 = 0: nothing moves, and what is left of v is rounding errors.
TEST_P(SmallValues, NothingMoves) {
  sfdae_multibody_problem problem = multibody_problem_of(2, 0);
  problem.num_nonholonomic = 2;
  problem.forces = [](double, const double*, const double*, double* f, void*) {
    f[0] = f[1] = 1.0;
    return 0;
  };
  problem.nonholonomic_matrix = [](double, const double* q, double* H, void*) {
    H[0] = H[1] = 1.0;
    H[3] = q[1];
    return 0;
  };
  MultibodyRun run(problem, options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 2.0, {0.0, 1.0, 0.3, 1.0}), SFDAE_VALUES_CHANGED) << run.message();
  ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[0], 0.0, 1e-14);
  EXPECT_NEAR(run.x[1], 1.0, 1e-14);
}

// A bar of a microsystem that hangs by one end, (x, y, angle), each in a unit of its own: its moment of inertia,
// 8e-21 kg m2, beside a mass of 1e-9 kg is no zero.
struct Bar {
  double length = 1e-5, mass = 1e-9;
  double unit[3] = {1.0, 1.0, 1.0};
  double half_cos(const double* q) const { return 0.5 * length * std::cos(unit[2] * q[2]); }
  double half_sin(const double* q) const { return 0.5 * length * std::sin(unit[2] * q[2]); }

  sfdae_multibody_problem problem() {
    sfdae_multibody_problem result = multibody_problem_of(3, 2);
    result.user = this;
    result.mass = [](double, const double*, double* M, void* user) {
      const Bar& bar = *static_cast<Bar*>(user);
      const double masses[] = {bar.mass, bar.mass, bar.mass * bar.length * bar.length / 12.0};
      for (int i = 0; i < 3; ++i) M[4 * i] = bar.unit[i] * bar.unit[i] * masses[i];
      return 0;
    };
    result.forces = [](double, const double*, const double*, double* f, void* user) {
      const Bar& bar = *static_cast<Bar*>(user);
      f[1] = -bar.unit[1] * bar.mass * 9.81;
      return 0;
    };
    result.constraints = [](double, const double* q, double* g, void* user) {
      const Bar& bar = *static_cast<Bar*>(user);
      g[0] = bar.unit[0] * q[0] - bar.half_cos(q);
      g[1] = bar.unit[1] * q[1] - bar.half_sin(q);
      return 0;
    };
    result.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
      const Bar& bar = *static_cast<Bar*>(user);
      g_q[0] = bar.unit[0];
      g_q[3] = bar.unit[1];
      g_q[4] = bar.unit[2] * bar.half_sin(q);
      g_q[5] = -bar.unit[2] * bar.half_cos(q);
      return 0;
    };
    return result;
  }
};

void expect_energy_kept(int method, double angle) {
  for (const double other : {1.0, 1e-3, 1e3})
    for (const double other_angle : {1.0, 1e-3, 1e3}) {
      Bar bar{.unit = {1.0, other, other_angle}};
      const double T = std::sqrt(bar.length / 9.81);
      const double sizes[] = {bar.length, bar.length / other, 1.0 / other_angle};
      const double force = bar.mass * 9.81;
      std::vector<double> q = {0.5 * bar.length * std::cos(angle), 0.5 * bar.length * std::sin(angle) / other,
                               angle / other_angle},
                          atol(8, 1e-8 * force);
      for (int i = 0; i < 3; ++i)
        atol[std::size_t(i)] = 1e-8 * sizes[i], atol[std::size_t(3 + i)] = 1e-8 * sizes[i] / T;
      sfdae_options options = options_of(method, 1e-8);
      options.atol_vector = atol.data();
      MultibodyRun run(bar.problem(), options);
      ASSERT_GE(run.start(0.0, 3.0 * T, q), SFDAE_OK) << run.message();
      ASSERT_EQ(run.advance(3.0 * T), SFDAE_OK) << run.message();
      // Its energy, m l^2 / 6 angle'^2 + m g l / 2 sin(angle), in m g l.
      const double theta = other_angle * run.x[2], speed = other_angle * run.x[5] * T;
      EXPECT_NEAR(speed * speed / 6.0 + 0.5 * std::sin(theta), 0.5 * std::sin(angle), 1e-6)
          << other << ' ' << other_angle;
    }
}

TEST_P(SmallValues, MomentsOfInertiaOfMicrosystemsCount) { expect_energy_kept(GetParam(), -1.0); }

// Hanging straight, where the cosine of the angle is 6e-17 or a little more.
TEST_P(SmallValues, MomentsOfInertiaOfMicrosystemsCountAtRest) {
  for (const double beside : {0.0, 1e-12, 1e-10, 1e-6})
    expect_energy_kept(GetParam(), -std::acos(-1.0) / 2.0 + beside);
}

// Of a mass that no joint ties to others nothing but its size is known, which may be that of a rounding error.
TEST_P(SmallValues, SmallMassesByThemselvesAreNone) {
  for (const double mass : {-1e-26, 1e-26}) {
    double masses[] = {1.0, mass};
    sfdae_multibody_problem problem = multibody_problem_of(2, 1);
    problem.user = masses;
    problem.mass = [](double, const double*, double* M, void* user) {
      M[0] = static_cast<const double*>(user)[0];
      M[3] = static_cast<const double*>(user)[1];
      return 0;
    };
    problem.forces = [](double, const double*, const double*, double*, void*) { return 0; };
    problem.constraints = [](double, const double* q, double* g, void*) {
      g[0] = q[0];
      return 0;
    };
    problem.constraint_jacobian = [](double, const double*, double* g_q, void*) {
      g_q[0] = 1.0;
      return 0;
    };
    MultibodyRun run(problem, options_of(GetParam(), 1e-6));
    EXPECT_EQ(run.start(0.0, 1.0, {0.0, 0.0, 0.0, 0.0}), SFDAE_SINGULAR) << mass;
  }
}

// M = 0 and q = sin t by a constraint: lambda is the force, 3.
TEST_P(SmallValues, NoMassIsNeededWhereConstraintsDetermineTheMotion) {
  sfdae_multibody_problem problem = multibody_problem_of(1, 1);
  problem.mass = [](double, const double*, double*, void*) { return 0; };
  problem.forces = [](double, const double*, const double*, double* f, void*) {
    f[0] = 3.0;
    return 0;
  };
  problem.constraints = [](double t, const double* q, double* g, void*) {
    g[0] = q[0] - std::sin(t);
    return 0;
  };
  problem.constraint_jacobian = [](double, const double*, double* g_q, void*) {
    g_q[0] = 1.0;
    return 0;
  };
  problem.constraint_rate = [](double t, const double*, double* g_t, void*) {
    g_t[0] = -std::cos(t);
    return 0;
  };
  MultibodyRun run(problem, options_of(GetParam(), 1e-8));
  ASSERT_EQ(run.start(0.0, 3.0, {0.0, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
  ASSERT_EQ(run.advance(3.0), SFDAE_OK) << run.message();
  EXPECT_NEAR(run.x[0], std::sin(3.0), 1e-14);
  EXPECT_NEAR(run.x[2], 3.0, 1e-13);
}

// |q|^2 = 1 and |q|^2 + 2 angle z = 1, so that z = 0: forces of the size 1 / angle, up to where they make no sense.
TEST_P(SmallValues, ConstraintsMayNearlyDependOnEachOther) {
  for (const double angle : {1e-3, 1e-6, 1e-9, 1e-10}) {
    double user = angle;
    sfdae_multibody_problem problem = multibody_problem_of(3, 2);
    problem.user = &user;
    problem.forces = [](double, const double*, const double*, double* f, void*) {
      f[1] = f[2] = -1.0;
      return 0;
    };
    problem.constraints = [](double, const double* q, double* g, void* data) {
      g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
      g[1] = g[0] + *static_cast<double*>(data) * q[2];
      return 0;
    };
    problem.constraint_jacobian = [](double, const double* q, double* g_q, void* data) {
      g_q[0] = g_q[1] = q[0];
      g_q[2] = g_q[3] = q[1];
      g_q[5] = *static_cast<double*>(data);
      return 0;
    };
    MultibodyRun run(problem, options_of(GetParam(), 1e-7));
    const std::vector<double> start = {std::sin(0.4), -std::cos(0.4), 0.0};
    if (angle < 5e-8) {
      EXPECT_EQ(run.start(0.0, 2.0, start), SFDAE_SINGULAR) << angle;
      continue;
    }
    ASSERT_EQ(run.start(0.0, 2.0, start), SFDAE_OK) << run.message();
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(0.5 * (run.x[3] * run.x[3] + run.x[4] * run.x[4]) + run.x[1], -std::cos(0.4), 1e-5);
    EXPECT_NEAR(run.x[7] * angle, -1.0, 1e-6);
  }
}

// The only point has no gradient, from wherever it is approached.
TEST_P(SmallValues, PointsWithoutGradientAreRefused) {
  sfdae_multibody_problem problem = multibody_problem_of(2, 1);
  problem.forces = [](double, const double*, const double*, double*, void*) { return 0; };
  problem.constraints = [](double, const double* q, double* g, void*) {
    g[0] = q[0] * q[0] + q[1] * q[1];
    return 0;
  };
  problem.constraint_jacobian = [](double, const double* q, double* g_q, void*) {
    for (int i = 0; i < 2; ++i) g_q[i] = 2.0 * q[i];
    return 0;
  };
  for (const double distance : {0.0, 1e-9, 1e-3, 1.0}) {
    MultibodyRun run(problem, options_of(GetParam(), 1e-7));
    EXPECT_EQ(run.start(0.0, 1.0, {distance, 2.0 * distance}), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
  }
}

}  // namespace
}  // namespace sfdae::test
