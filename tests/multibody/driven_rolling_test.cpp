// A system with everything at once: q' = S(t, q) v, masses that are coupled and move, a holonomic and a nonholonomic
// constraint that both depend on time. Formulas, callbacks and the general nonlinear path have to agree.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sfdae/sfdae.hpp"

namespace sfdae::test {
namespace {

// q = (x, y, phi, z), v = (u, w, omega), the same formulas for numbers and expressions:
//   x' = u cos phi - w sin phi,  y' = u sin phi + w cos phi,  phi' = omega,  z' = u + omega sin t
//   0 = z - x y / 2 + sin(2 t) / 10,   0 = 0.2 u cos t + w + 0.1 x omega - 0.3 sin t
template <class Number>
struct Formulas {
  Number S[4][3], M[3][3], f[3], g, g_q[4], H[3], h;

  template <class Values>
  Formulas(const Number& t, const Values& q, const Values& v) {
    using std::cos, std::sin;
    const Number c = cos(q[2]), s = sin(q[2]);
    set(S[0], {c, -s, Number(0.0)});
    set(S[1], {s, c, Number(0.0)});
    set(S[2], {Number(0.0), Number(0.0), Number(1.0)});
    set(S[3], {Number(1.0), Number(0.0), sin(t)});
    set(M[0], {2.0 + 0.5 * s, 0.2 * c, Number(0.0)});
    set(M[1], {0.2 * c, Number(1.5), Number(0.0)});
    set(M[2], {Number(0.0), Number(0.0), 1.0 + 0.1 * q[0] * q[0]});
    set(f, {cos(t) - q[0], -q[1], v[0] * v[1] - q[2]});
    g = q[3] - 0.5 * q[0] * q[1] + 0.1 * sin(2.0 * t);
    for (int j = 0; j < 4; ++j) g_q[j] = j == 0 ? -0.5 * q[1] : j == 1 ? -0.5 * q[0] : Number(j == 3 ? 1.0 : 0.0);
    set(H, {0.2 * cos(t), Number(1.0), 0.1 * q[0]});
    h = -0.3 * sin(t);
  }
  static void set(Number (&row)[3], const std::array<Number, 3>& values) {
    std::copy(values.begin(), values.end(), row);
  }
};

MultibodyProblem empty_problem() {
  MultibodyProblem problem(4, 1);
  problem.num_velocities = 3;
  problem.num_nonholonomic = 1;
  return problem;
}

MultibodyProblem recorded() {
  MultibodyProblem problem = empty_problem();
  problem.equations = [](const Expression& t, auto q, auto v, const auto& to) {
    const Formulas<Expression> by(t, q, v);
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) to.S(i, j) = by.S[i][j];
      for (int i = 0; i < 3; ++i) to.M(i, j) = by.M[i][j];
      to.f[j] = by.f[j];
      to.H(0, j) = by.H[j];
    }
    to.g[0] = by.g;
    to.h[0] = by.h;
  };
  return problem;
}

Formulas<double> numbers(double t, const double* q, const double* v) { return Formulas<double>(t, q, v); }
constexpr double at_rest[3] = {0.0, 0.0, 0.0};

MultibodyProblem from_callbacks() {
  MultibodyProblem problem = empty_problem();
  problem.kinematics = [](double t, auto q, auto S) {
    const auto by = numbers(t, q.data(), at_rest);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i) S(i, j) = by.S[i][j];
  };
  problem.mass = [](double t, auto q, auto M) {
    const auto by = numbers(t, q.data(), at_rest);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) M(i, j) = by.M[i][j];
  };
  problem.forces = [](double t, auto q, auto v, auto f) {
    const auto by = numbers(t, q.data(), v.data());
    std::copy(by.f, by.f + 3, f.begin());
  };
  problem.constraints = [](double t, auto q, auto g) { g[0] = numbers(t, q.data(), at_rest).g; };
  problem.constraint_jacobian = [](double t, auto q, auto g_q) {
    const auto by = numbers(t, q.data(), at_rest);
    for (int j = 0; j < 4; ++j) g_q(0, j) = by.g_q[j];
  };
  problem.constraint_rate = [](double t, auto, auto g_t) { g_t[0] = 0.2 * std::cos(2.0 * t); };
  problem.nonholonomic_matrix = [](double t, auto q, auto H) {
    const auto by = numbers(t, q.data(), at_rest);
    for (int j = 0; j < 3; ++j) H(0, j) = by.H[j];
  };
  problem.nonholonomic_offset = [](double t, auto, auto h) { h[0] = -0.3 * std::sin(t); };
  return problem;
}

NonlinearProblem general() {
  NonlinearProblem problem(9, 9);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression* entries = &x[0];
    const Formulas<Expression> by(t, entries, entries + 4);
    for (int i = 0; i < 4; ++i) {
      F[i] = xdot[i];
      for (int j = 0; j < 3; ++j) F[i] -= by.S[i][j] * x[4 + j];
    }
    F[8] = by.h;
    for (int i = 0; i < 3; ++i) {
      F[4 + i] = by.H[i] * x[8] - by.f[i];
      for (int j = 0; j < 3; ++j) F[4 + i] += by.M[i][j] * xdot[4 + j];
      for (int k = 0; k < 4; ++k) F[4 + i] += by.g_q[k] * by.S[k][i] * x[7];
      F[8] += by.H[i] * x[4 + i];
    }
    F[7] = by.g;
  };
  return problem;
}

Options options_of(int method, double tol) {
  Options options;
  options.method = method;
  options.rtol = options.atol = tol;
  return options;
}

class DrivenRolling : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, DrivenRolling, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(DrivenRolling, MovesAsTheGeneralPathSays) {
  constexpr double tol = 1e-8;
  for (const double end : {3.0, -3.0}) {
    Point reference{0.0, {0.4, 0.3, 0.2, 0.06, 0.5, 0.1, 0.3, 0.0, 0.0}, {}};
    Solver(recorded(), options_of(SFDAE_METHOD_RADAU, tol)).start(reference, end);
    const std::vector<double> start = reference.x;
    Solver whole(general(), options_of(SFDAE_METHOD_RADAU, 1e-11));
    whole.start(reference, end);
    // The start is consistent with the derivative array, forces of constraints included.
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(reference.x[i], start[i], 1e-10);
    whole.advance(end, reference);
    for (const MultibodyProblem& problem : {recorded(), from_callbacks()}) {
      Point point{0.0, start, {}};
      Solver solver(problem, options_of(GetParam(), tol));
      solver.start(point, end);
      EXPECT_EQ(solver.multibody_report().degrees_of_freedom, 1);
      EXPECT_EQ(solver.multibody_report().position_freedom, 3);
      solver.advance(end, point);
      for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(point.x[i], reference.x[i], 10.0 * tol) << i;
      for (std::size_t i = 7; i < 9; ++i) EXPECT_NEAR(point.x[i], reference.x[i], 100.0 * tol) << i;
      const auto by = numbers(end, point.x.data(), point.x.data() + 4);
      EXPECT_LE(std::fabs(by.g), 1e-14);
      EXPECT_LE(std::fabs(by.h + by.H[0] * point.x[4] + by.H[1] * point.x[5] + by.H[2] * point.x[6]), 1e-14);
    }
  }
}

// As the README has it.
TEST(PendulumInFormulas, KeepsItsEnergy) {
  MultibodyProblem problem(2, 1);
  problem.equations = [](const Expression&, auto q, auto, const auto& to) {
    to.M(0, 0) = to.M(1, 1) = 1;
    to.f[1] = -9.81;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - 1;
  };
  Solver solver(problem, options_of(SFDAE_METHOD_RADAU, 1e-9));
  Point point{0.0, {1, 0, 0, 0, 0}, {}};
  solver.start(point, 10.0);
  solver.advance(10.0, point);
  EXPECT_NEAR(0.5 * (point.x[2] * point.x[2] + point.x[3] * point.x[3]) + 9.81 * point.x[1], 0.0, 1e-7);
}

}  // namespace
}  // namespace sfdae::test
