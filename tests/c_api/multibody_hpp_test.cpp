// SPDX-License-Identifier: BSD-3-Clause
//
// Mechanical systems through the C++ interface.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace {

using sfdae::ConstVectorRef;
using sfdae::MatrixRef;
using sfdae::VectorRef;

static_assert(std::is_copy_constructible_v<sfdae::MultibodyProblem>);

// Length and gravity 1: q'' = (0, -1) - lambda q, 0 = (|q|^2 - 1) / 2; lambda = |v|^2 - q_2, and the energy is
// conserved.
sfdae::MultibodyProblem recorded_pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto& t, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = -sfdae::parameter(t, "gravity", 1.0);
    to.g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
  };
  return problem;
}

sfdae::MultibodyProblem pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.forces = [](double, ConstVectorRef, ConstVectorRef, VectorRef f) { f[1] = -1.0; };
  problem.constraints = [](double, ConstVectorRef q, VectorRef g) { g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0); };
  problem.constraint_jacobian = [](double, ConstVectorRef q, MatrixRef g_q) { g_q(0, 0) = q[0], g_q(0, 1) = q[1]; };
  return problem;
}

void expect_pendulum(const sfdae::Point& point, double gravity) {
  const std::vector<double>& x = point.x;
  ASSERT_EQ(x.size(), 5u);
  EXPECT_NEAR(std::hypot(x[0], x[1]), 1.0, 1e-12);
  EXPECT_NEAR(x[0] * x[2] + x[1] * x[3], 0.0, 1e-12);
  EXPECT_NEAR(0.5 * (x[2] * x[2] + x[3] * x[3]) + gravity * x[1], 0.0, 1e-4);
  EXPECT_NEAR(x[4], x[2] * x[2] + x[3] * x[3] - gravity * x[1], 1e-10);
}

// A skate on a plane that is inclined along the first coordinate, turning with unit speed from rest, gravity 1:
//     x = sin^2(t) / 2,  y = (t - sin t cos t) / 2,  theta = t
// (Ju. I. Neimark, N. A. Fufaev: Dynamics of Nonholonomic Systems. AMS, 1972.)
sfdae::MultibodyProblem skate() {
  sfdae::MultibodyProblem problem(3);
  problem.num_nonholonomic = 1;
  problem.equations = [](const auto&, auto q, auto, auto to) {
    for (int i = 0; i < 3; ++i) to.M(i, i) = 1.0;
    to.f[0] = 1.0;
    to.H(0, 0) = sin(q[2]), to.H(0, 1) = -cos(q[2]);
  };
  return problem;
}

// The same with the speed along the blade and that of turning as velocities.
sfdae::MultibodyProblem skate_without_constraint() {
  sfdae::MultibodyProblem problem(3);
  problem.num_velocities = 2;
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[0] = cos(q[2]);
    to.S(0, 0) = cos(q[2]), to.S(1, 0) = sin(q[2]), to.S(2, 1) = 1.0;
  };
  return problem;
}

template <class Call>
int status_of(Call call) {
  try {
    return call();
  } catch (const sfdae::Error& error) {
    EXPECT_STRNE(error.what(), "");
    return error.status();
  }
}

}  // namespace

TEST(MultibodyProblem, IsSolvedFromFormulasAndFromFunctions) {
  for (const sfdae::MultibodyProblem& problem : {recorded_pendulum(), pendulum()}) {
    for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      sfdae::Options options;
      options.method = method;
      sfdae::Solver solver(problem, options);
      EXPECT_EQ(solver.num_unknowns(), 5);
      sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
      EXPECT_EQ(solver.start(point, 3.0), SFDAE_OK);
      EXPECT_EQ(solver.characteristics().strangeness_index, 2);
      EXPECT_EQ(solver.characteristics().differential, 2);
      EXPECT_EQ(solver.advance(3.0, point), SFDAE_OK);
      expect_pendulum(point, 1.0);
      const sfdae::MultibodyReport report = solver.multibody_report();
      EXPECT_EQ(report.holonomic, 1);
      EXPECT_EQ(report.degrees_of_freedom, 1);
      EXPECT_LE(report.position_residual, 1e-12);
    }
  }
}

TEST(MultibodyProblem, HasParameters) {
  sfdae::Solver solver(recorded_pendulum());
  EXPECT_EQ(solver.parameter("gravity"), 1.0);
  for (double gravity : {1.0, 4.0}) {
    solver.set_parameter("gravity", gravity);
    sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
    EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
    EXPECT_NEAR(point.xdot[3], -gravity, 1e-12);
    EXPECT_EQ(solver.advance(1.0, point), SFDAE_OK);
    expect_pendulum(point, gravity);
  }
}

TEST(MultibodyProblem, HasNonholonomicConstraintsAndKinematics) {
  for (const sfdae::MultibodyProblem& problem : {skate(), skate_without_constraint()}) {
    sfdae::Options options;
    options.rtol = options.atol = 1e-8;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, std::vector<double>(static_cast<std::size_t>(problem.num_unknowns()), 0.0), {}};
    point.x[static_cast<std::size_t>(2 + problem.num_velocities)] = 1.0;
    EXPECT_EQ(solver.start(point, 4.0), SFDAE_OK);
    EXPECT_EQ(solver.advance(4.0, point), SFDAE_OK);
    const double s = std::sin(4.0), c = std::cos(4.0);
    EXPECT_NEAR(point.x[0], 0.5 * s * s, 1e-6);
    EXPECT_NEAR(point.x[1], 0.5 * (4.0 - s * c), 1e-6);
    EXPECT_NEAR(point.x[2], 4.0, 1e-6);
  }
}

TEST(MultibodyProblem, FindsMistakesInDerivatives) {
  sfdae::MultibodyProblem problem = pendulum();
  problem.constraint_curvature = [](double, ConstVectorRef, ConstVectorRef v, VectorRef gamma) {
    gamma[0] = v[0] * v[0] + v[1] * v[1];
  };
  EXPECT_EQ(sfdae::Solver(problem).check_multibody_derivatives(0.0, {0.6, 0.7}, {1.0, 2.0}).suspicious, 0);
  problem.constraint_curvature = [](double, ConstVectorRef, ConstVectorRef v, VectorRef gamma) { gamma[0] = v[0]; };
  sfdae::Solver wrong_curvature(problem);
  const sfdae::DerivativeCheck found = wrong_curvature.check_multibody_derivatives(0.0, {0.6, 0.7}, {1.0, 2.0});
  EXPECT_EQ(found.suspicious, 1);
  EXPECT_EQ(found.function, 'C');
  EXPECT_NEAR(found.difference, 5.0, 1e-9);
  EXPECT_NE(wrong_curvature.message().find("gamma"), std::string::npos);
  problem.constraint_jacobian = [](double, ConstVectorRef q, MatrixRef g_q) { g_q(0, 0) = q[0], g_q(0, 1) = -q[1]; };
  const sfdae::DerivativeCheck gradient =
      sfdae::Solver(problem).check_multibody_derivatives(0.0, {0.6, 0.7}, {1.0, 2.0});
  EXPECT_EQ(gradient.function, 'G');
  EXPECT_EQ(gradient.column, 1);
  EXPECT_EQ(
      status_of([&] {
        return static_cast<int>(sfdae::Solver(problem).check_multibody_derivatives(0.0, {0.6}, {1.0, 2.0}).size);
      }),
      SFDAE_ILLEGAL_ARGUMENT);
  sfdae::Solver recorded(recorded_pendulum());
  EXPECT_EQ(status_of([&] {
              return static_cast<int>(recorded.check_multibody_derivatives(0.0, {0.6, 0.7}, {1.0, 2.0}).size);
            }),
            SFDAE_ILLEGAL_ARGUMENT);
}

// Without its derivative by t a moving constraint would be solved wrong.
TEST(MultibodyProblem, ConstraintsThatMoveNeedTheirRate) {
  sfdae::MultibodyProblem problem = pendulum();
  problem.constraints = [](double t, ConstVectorRef q, VectorRef g) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0 - t);
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0, 0.5, 0.0, 0.0}, {}};
  EXPECT_EQ(status_of([&] { return solver.start(point, 1.0); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(solver.message().find("constraint_rate"), std::string::npos);
  EXPECT_EQ(solver.check_multibody_derivatives(0.0, {0.6, 0.7}, {1.0, 2.0}).function, 'T');
  problem.constraint_rate = [](double, ConstVectorRef, VectorRef g_t) { g_t[0] = -0.5; };
  sfdae::Solver moving(problem);
  EXPECT_EQ(moving.start(point, 1.0), SFDAE_OK);
  EXPECT_EQ(moving.advance(1.0, point), SFDAE_OK);
  EXPECT_NEAR(std::hypot(point.x[0], point.x[1]), std::sqrt(2.0), 1e-10);
}

TEST(MultibodyProblem, PassesExceptionsOn) {
  struct Mishap : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  sfdae::MultibodyProblem problem = pendulum();
  problem.forces = [](double, ConstVectorRef, ConstVectorRef, VectorRef) { throw Mishap("forces"); };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
  EXPECT_THROW(solver.start(point, 1.0), Mishap);
  problem.equations = [](const auto&, auto, auto, auto) { throw Mishap("formulas"); };
  EXPECT_THROW(sfdae::Solver{problem}, Mishap);
}

TEST(MultibodyProblem, NamesMistakesInFormulas) {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto&, auto, auto v, auto to) { to.M(1, 0) = v[0]; };
  EXPECT_NE(sfdae::Solver::check(problem).find("M(1, 0) depends on v"), std::string::npos);
  problem.equations = [](const auto&, auto, auto, auto to) { to.g[0] = std::nan(""); };
  EXPECT_NE(sfdae::Solver::check(problem).find("g[0]"), std::string::npos);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = log(q[0] - 2.0);
    to.g[0] = q[0] - 1.0;
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
  EXPECT_LT(status_of([&] { return solver.start(point, 1.0); }), 0);
  EXPECT_NE(solver.message().find("log of -1 in f[1]"), std::string::npos) << solver.message();
}
