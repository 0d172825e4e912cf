// SPDX-License-Identifier: BSD-3-Clause
//
// Jumps of time-varying and nonlinear equations and of mechanical systems, from what conservation laws say.

#include <sfdae/modes.h>
#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../c_api/weierstrass_modes.h"

namespace {

using Values = std::vector<double>;

struct Result {
  int status;
  Values after, impulses;
  std::string message;
};

Result jump(sfdae::Solver& solver, double t, const Values& before, int orders = 3) {
  Result result{0, before, Values(before.size() * static_cast<std::size_t>(orders)), ""};
  result.status =
      sfdae_jump(solver.get(), t, t + 1.0, before.data(), result.after.data(), orders, result.impulses.data());
  result.message = sfdae_message(solver.get());
  return result;
}

sfdae::Options loose_off() {
  sfdae::Options options;
  options.rtol = options.atol = 1e-8;
  return options;
}

// x = T(t) y with T a rotation by the angle w t of all pairs of neighbours, equations multiplied by a rotation S(t):
// the distributions in y are those of the constant pencil, so that x+ = T(t) Q diag(I, 0) Q^-1 T(t)^-1 x- for f = 0,
// whatever E' and A' do.
TEST(Jumps, OfTimeVaryingEquationsAreThoseOfTheConstantOnes) {
  sfdae_test::Random random(5);
  for (int trial = 0; trial < 60; ++trial) {
    const int mu = trial % 4, d = random.integer(1, 2), a = 2 * ((mu + 2) / 2) + d % 2, n = d + a;
    sfdae_test::Mode mode(random, d, a, mu);
    for (auto& wave : mode.waves) wave.c = 0.0;
    const double speed = random.real(0.3, 2.0), row_speed = random.real(0.3, 2.0), t = random.real(0.0, 2.0);
    sfdae::NonlinearProblem problem(n, n);
    problem.equations = [&](const auto& time, auto x, auto xdot, auto F) {
      const auto c = cos(speed * time), s = sin(speed * time);
      const auto rc = cos(row_speed * time), rs = sin(row_speed * time);
      // y = T^T x, y' = T^T x' + T'^T x for the pairs (0, 1), (2, 3), ...
      const auto has_partner = [=](int i) { return i % 2 == 1 || i + 1 < n; };
      const auto partner = [](int i) { return i % 2 == 0 ? i + 1 : i - 1; };
      const auto sign = [](int i) { return i % 2 == 0 ? 1.0 : -1.0; };
      const auto y = [&](int i) { return has_partner(i) ? c * x[i] + sign(i) * s * x[partner(i)] : 1.0 * x[i]; };
      const auto ydot = [&](int i) {
        if (!has_partner(i)) return 1.0 * xdot[i];
        const int j = partner(i);
        return c * xdot[i] + sign(i) * s * xdot[j] + speed * (sign(i) * c * x[j] - s * x[i]);
      };
      const auto row = [&](int i) {
        auto sum = 0.0 * x[0];
        for (int j = 0; j < n; ++j) sum = sum + mode.E(i, j) * ydot(j) - mode.A(i, j) * y(j);
        return sum;
      };
      for (int i = 0; i < n; ++i) F[i] = has_partner(i) ? rc * row(i) - sign(i) * rs * row(partner(i)) : row(i);
    };
    sfdae::Solver solver(problem, loose_off());
    const auto rotated = [&](const Values& v, double angle) {
      Values result(v);
      for (std::size_t i = 0; i + 1 < v.size(); i += 2) {
        result[i] = std::cos(angle) * v[i] - std::sin(angle) * v[i + 1];
        result[i + 1] = std::sin(angle) * v[i] + std::cos(angle) * v[i + 1];
      }
      return result;
    };
    const Values before = random.reals(n, -1.0, 1.0);
    Values y = mode.Q.inverse * rotated(before, -speed * t);
    for (std::size_t i = static_cast<std::size_t>(d); i < y.size(); ++i) y[i] = 0.0;
    const Values exact = rotated(mode.Q.matrix * y, speed * t);
    const Result found = jump(solver, t, before);
    ASSERT_EQ(found.status, SFDAE_OK) << found.message;
    for (std::size_t i = 0; i < exact.size(); ++i)
      EXPECT_NEAR(found.after[i], exact[i], 1e-9) << trial << " mu " << mu;
  }
}

// Two nonlinear capacitors, q = v + v^3 and q = 3 v, are connected: q1' + i = 0, q2' - i = 0, q1 = v1 + v1^3, q2 = 3
// v2, v1 = v2. The charge is kept: v + v^3 + 3 v = q1 + q2, and the charge that flows is the impulse of i.
TEST(Jumps, KeepTheChargeOfNonlinearCapacitors) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[4];
    F[1] = xdot[1] - x[4];
    F[2] = x[0] - x[2] - x[2] * x[2] * x[2];
    F[3] = x[1] - 3.0 * x[3];
    F[4] = x[2] - x[3];
  };
  sfdae::Solver solver(problem, loose_off());
  const Values before = {10.0, 0.0, 2.0, 0.0, 0.0};  // 2 + 8
  const Result found = jump(solver, 0.0, before);
  ASSERT_EQ(found.status, SFDAE_OK) << found.message;
  const double v = found.after[2];
  EXPECT_NEAR(v * v * v + 4.0 * v, 10.0, 1e-9);
  EXPECT_NEAR(found.after[3], v, 1e-10);
  EXPECT_NEAR(found.after[0] + found.after[1], 10.0, 1e-9);
  EXPECT_NEAR(found.impulses[4], found.after[1], 1e-9);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found.impulses[static_cast<std::size_t>(i)], 0.0, 1e-9);
}

// The same with C(v) v' in place of q': E depends on what jumps, and what is kept is not said.
TEST(Jumps, AreRefusedWhereFactorsJump) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = (1.0 + 3.0 * x[0] * x[0]) * xdot[0] + x[2];
    F[1] = 3.0 * xdot[1] - x[2];
    F[2] = x[0] - x[1];
  };
  sfdae::Solver solver(problem, loose_off());
  const Result found = jump(solver, 0.0, {2.0, 0.0, 0.0});
  EXPECT_EQ(found.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(found.message.find("by a factor that jumps itself"), std::string::npos) << found.message;
  EXPECT_EQ(found.after, Values({2.0, 0.0, 0.0}));
  // Nothing jumps: nothing is refused.
  const Result still = jump(solver, 0.0, {1.0, 1.0, 0.0});
  ASSERT_EQ(still.status, SFDAE_OK) << still.message;
  EXPECT_NEAR(still.after[0], 1.0, 1e-12);
}

// An impulse that enters by its square has no meaning.
TEST(Jumps, AreRefusedWhereImpulsesAreSquared) {
  sfdae::NonlinearProblem problem(4, 4);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + x[2];
    F[1] = 3.0 * xdot[1] - x[2];
    F[2] = x[0] - x[1];
    F[3] = xdot[3] - x[2] * x[2];
  };
  sfdae::Solver solver(problem, loose_off());
  const Result found = jump(solver, 0.0, {2.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(found.status, SFDAE_NO_CONSISTENT_VALUES) << found.after[3];
}

// x1' + x2 = 0 with x2 free: any jump would do.
TEST(Jumps, AreRefusedWhereComponentsAreFree) {
  sfdae::NonlinearProblem problem(1, 2);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) { F[0] = xdot[0] + x[1]; };
  sfdae::Solver solver(problem, loose_off());
  const Result found = jump(solver, 0.0, {1.0, 0.0});
  EXPECT_EQ(found.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(found.message.find("free"), std::string::npos) << found.message;
}

// A body that moves freely is caught by a rod of length 1 at (0.6, -0.8): the velocity along the rod is lost, with the
// impulse p = m v_r / |g_q| (g_q = 2 q, of length 2). As first-order equations of index 3, and as a multibody system.
TEST(Jumps, LeaveVelocitiesAlongConstraints) {
  const Values before = {0.6, -0.8, 1.0, 2.0, 0.0};
  const double m = 1.5, along = 0.6 * 1.0 - 0.8 * 2.0;
  const Values v = {1.0 - along * 0.6, 2.0 + along * 0.8};
  sfdae::NonlinearProblem raw(5, 5);
  raw.equations = [=](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = m * xdot[2] + 2.0 * x[0] * x[4];
    F[3] = m * xdot[3] + 2.0 * x[1] * x[4] + 9.81 * m;
    F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
  };
  sfdae::MultibodyProblem system(2, 1);
  system.equations = [=](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = m;
    to.f[1] = -9.81 * m;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - 1.0;
  };
  sfdae::Solver of_raw(raw, loose_off()), of_system(system, loose_off());
  for (sfdae::Solver* solver : {&of_raw, &of_system}) {
    const Result found = jump(*solver, 0.0, before);
    ASSERT_EQ(found.status, SFDAE_OK) << found.message;
    EXPECT_NEAR(found.after[0], 0.6, 1e-12);
    EXPECT_NEAR(found.after[1], -0.8, 1e-12);
    EXPECT_NEAR(found.after[2], v[0], 1e-9);
    EXPECT_NEAR(found.after[3], v[1], 1e-9);
    EXPECT_NEAR(found.impulses[4], m * along / 2.0, 1e-9);
  }
  // Positions cannot jump.
  const Result beside = jump(of_system, 0.0, {0.7, -0.8, 1.0, 2.0, 0.0});
  EXPECT_EQ(beside.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(beside.message.find("impulses change velocities only"), std::string::npos) << beside.message;
  EXPECT_EQ(jump(of_raw, 0.0, {0.7, -0.8, 1.0, 2.0, 0.0}).status, SFDAE_NO_CONSISTENT_VALUES);
}

// A slider between stops at q1 = 0 on a frame that is held: restitution 0.8 of one constraint, 0 of the other.
TEST(Impacts, ReverseVelocitiesByTheCoefficients) {
  sfdae::MultibodyProblem system(2, 2);
  system.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = 2.0;
    to.M(1, 1) = 3.0;
    to.M(0, 1) = to.M(1, 0) = 1.0;
    to.g[0] = q[0];
    to.g[1] = q[1] - 1.0;
  };
  sfdae::Solver solver(system, loose_off());
  const Values before = {0.0, 1.0, -2.0, 0.5, 0.0, 0.0}, e = {0.8, 0.0};
  Values after(6), p(2);
  ASSERT_EQ(sfdae_impact(solver.get(), 0.0, e.data(), before.data(), after.data(), p.data()), SFDAE_OK)
      << sfdae_message(solver.get());
  EXPECT_NEAR(after[2], 1.6, 1e-14);
  EXPECT_NEAR(after[3], 0.0, 1e-14);
  // M (v+ - v-) = -p for C = I.
  EXPECT_NEAR(p[0], -(2.0 * 3.6 - 0.5), 1e-12);
  EXPECT_NEAR(p[1], -(3.6 - 1.5), 1e-12);
  EXPECT_EQ(after[4], 0.0);
  const double wrong[] = {1.2, 0.0};
  EXPECT_EQ(sfdae_impact(solver.get(), 0.0, wrong, before.data(), after.data(), p.data()), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(std::string(sfdae_message(solver.get())).find("restitution[0] = 1.2"), std::string::npos);
}

// Two equal constraints share the impulse; they cannot have different coefficients.
TEST(Impacts, OfRedundantConstraintsAreShared) {
  sfdae::MultibodyProblem system(1, 2);
  system.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = 2.0;
    to.g[0] = q[0];
    to.g[1] = q[0];
  };
  sfdae::Solver solver(system, loose_off());
  const Values before = {0.0, -3.0, 0.0, 0.0};
  Values after(4), p(2);
  ASSERT_EQ(sfdae_impact(solver.get(), 0.0, nullptr, before.data(), after.data(), p.data()), SFDAE_OK)
      << sfdae_message(solver.get());
  EXPECT_NEAR(after[1], 0.0, 1e-14);
  EXPECT_NEAR(p[0], -3.0, 1e-12);
  EXPECT_NEAR(p[1], -3.0, 1e-12);
  const double different[] = {0.5, 0.0};
  EXPECT_EQ(sfdae_impact(solver.get(), 0.0, different, before.data(), after.data(), p.data()),
            SFDAE_INCONSISTENT_EQUATIONS);
}

// The minimal extension with sparse matrices has the same jumps, also at breakpoints: a capacitor whose charge is q =
// v + v^3 follows a source that steps from 0 to 1 at t = 1/2, q' = i, v = s(t), and charges another one through i2, 3
// w' = i2 = v - w.
TEST(Jumps, OfSparseEquationsAreTheSame) {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = x[0] - x[1] - x[1] * x[1] * x[1];
    F[2] = x[1] - choose(t < 0.5, 0.0, 1.0);
    F[3] = 3.0 * xdot[3] - x[4];
    F[4] = x[4] - x[1] + x[3];
  };
  for (int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC, SFDAE_STRUCTURE_REQUIRED})
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae::Options options = loose_off();
      options.structure = structure;
      options.method = method;
      sfdae::Solver solver(problem, options);
      solver.set_breakpoints({0.5}, {SFDAE_BREAKPOINT_JUMP});
      sfdae::Point point{0.0, {0.0, 0.0, 0.0, 0.0, 0.0}, {}};
      solver.start(point, 1.0);
      solver.advance(1.0, point);
      EXPECT_NEAR(point.x[0], 2.0, 1e-7) << structure;
      EXPECT_NEAR(point.x[1], 1.0, 1e-7);
      EXPECT_NEAR(point.x[2], 0.0, 1e-6);
      EXPECT_NEAR(point.x[3], 1.0 - std::exp(-0.5 / 3.0), 1e-7);
      EXPECT_NEAR(solver.last_jump().impulses(2, 0), 2.0, 1e-7);
      EXPECT_NEAR(solver.last_jump().after[3], 0.0, 1e-7);
    }
}

// The same capacitors, as many as threads take.
TEST(Jumps, HappenInEnsembles) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] - sfdae::parameter(t, "height", 1.0) * choose(t < 0.5, 0.0, 1.0);
  };
  sfdae::Solver solver(problem, loose_off());
  solver.set_breakpoints({0.5}, {SFDAE_BREAKPOINT_JUMP});
  sfdae::Ensemble ensemble;
  ensemble.times = {1.0};
  ensemble.parameter_names = {"height"};
  ensemble.x0 = sfdae::Matrix(2, 3);
  ensemble.parameters = sfdae::Matrix(1, 3);
  for (int i = 0; i < 3; ++i) ensemble.parameters(0, i) = 1.0 + i;
  sfdae::EnsembleSolution solution = solver.solve_ensemble(ensemble);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(solution.statuses[static_cast<std::size_t>(i)], SFDAE_OK)
        << solution.messages[static_cast<std::size_t>(i)];
    EXPECT_NEAR(solution.x()[static_cast<std::size_t>(2 * i)], 1.0 + i, 1e-7);
    EXPECT_NEAR(solution.x()[static_cast<std::size_t>(2 * i + 1)], 0.0, 1e-7);
  }
}

// A driven circuit, E x' = A x + f with redundant equations that agree, and with some that contradict the values
// before: x1' = 0, x1 = 1.
TEST(Jumps, AreRefusedWhereRedundantEquationsContradict) {
  sfdae::NonlinearProblem problem(2, 1);
  problem.equations = [](const auto&, auto x, auto xdot, auto F) {
    F[0] = xdot[0];
    F[1] = x[0] - 1.0;
  };
  sfdae::Solver solver(problem, loose_off());
  const Result found = jump(solver, 0.0, {2.0});
  EXPECT_EQ(found.status, SFDAE_NO_CONSISTENT_VALUES);
  EXPECT_NE(found.message.find("redundant"), std::string::npos) << found.message;
  EXPECT_EQ(jump(solver, 0.0, {1.0}).status, SFDAE_OK);
}

}  // namespace
