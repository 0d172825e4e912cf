// The theory's objects through the C++ interface.
// SPDX-License-Identifier: BSD-3-Clause
#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace {

using sfdae::Matrix;

// Length and gravity 1: x1' = x3, x2' = x4, x3' = -x1 x5, x4' = -x2 x5 - 1, 0 = (x1^2 + x2^2 - 1) / 2.
sfdae::NonlinearProblem theory_pendulum() {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const sfdae::Expression&, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot,
                         sfdae::Expressions F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] * x[4];
    F[3] = xdot[3] + x[1] * x[4] + 1.0;
    F[4] = 0.5 * (x[0] * x[0] + x[1] * x[1] - 1.0);
  };
  return problem;
}

sfdae::MultibodyProblem theory_mechanical_pendulum() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.equations = [](const auto&, auto q, auto, auto to) {
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[1] = sfdae::Expression(-1.0);
    to.g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
  };
  return problem;
}

sfdae::MultibodyProblem theory_pendulum_by_callbacks() {
  sfdae::MultibodyProblem problem(2, 1);
  problem.forces = [](double, sfdae::ConstVectorRef, sfdae::ConstVectorRef, sfdae::VectorRef f) { f[1] = -1.0; };
  problem.constraints = [](double, sfdae::ConstVectorRef q, sfdae::VectorRef g) {
    g[0] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
  };
  problem.constraint_jacobian = [](double, sfdae::ConstVectorRef q, sfdae::MatrixRef g_q) {
    g_q(0, 0) = q[0], g_q(0, 1) = q[1];
  };
  return problem;
}

Matrix transposed(const Matrix& a) {
  Matrix result(a.columns(), a.rows());
  for (int i = 0; i < a.rows(); ++i)
    for (int j = 0; j < a.columns(); ++j) result(j, i) = a(i, j);
  return result;
}

// max |A^T B - scale I|
double largest(const Matrix& a, const Matrix& b, double scale = 0.0) {
  double worst = 0.0;
  for (int i = 0; i < a.columns(); ++i)
    for (int j = 0; j < b.columns(); ++j) {
      double sum = i == j ? -scale : 0.0;
      for (int k = 0; k < a.rows(); ++k) sum += a(k, i) * b(k, j);
      worst = std::max(worst, std::fabs(sum));
    }
  return worst;
}

double largest(const std::vector<double>& values) {
  double worst = 0.0;
  for (double value : values) worst = std::max(worst, std::fabs(value));
  return worst;
}

// Entries of all matrices are below 10, sums have up to 15 terms, pivots are of order 1.
constexpr double rounding = 1e4 * std::numeric_limits<double>::epsilon();

template <class Call>
int status_of_getter(Call call) {
  try {
    call();
    return SFDAE_OK;
  } catch (const sfdae::Error& error) {
    return error.status();
  }
}

void expect_properties(sfdae::Solver& solver, const sfdae::Point& point) {
  const Matrix jet = solver.jet(point.t, 2);
  ASSERT_EQ(jet.rows(), 5);
  ASSERT_EQ(jet.columns(), 4);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(jet(i, 0), point.x[static_cast<std::size_t>(i)], rounding);
  const sfdae::DerivativeArray array = solver.derivative_array(point.t, 2, jet);
  const sfdae::Projectors p = solver.projectors(point.t, jet);
  const sfdae::StrangenessFreeSystem s = solver.strangeness_free(point.t, jet);
  EXPECT_LE(largest(array.g), rounding);
  EXPECT_LE(largest(p.Z2, p.Z2, 1.0), rounding);
  EXPECT_LE(largest(p.Z2, array.M), rounding);
  EXPECT_EQ(p.Z3.columns(), 0);
  EXPECT_LE(largest(transposed(s.A2), p.T2), rounding);
  EXPECT_LE(largest(p.Z1, p.Z1, 1.0), rounding);
  EXPECT_LE(std::max(largest(s.f1), largest(s.f2)), rounding);
  // Without the jet, that of the solution.
  EXPECT_LE(largest(transposed(solver.strangeness_free(point.t).A2), p.T2), rounding);
  EXPECT_LE(largest(solver.projectors(point.t).Z2, solver.derivative_array(point.t, 2).M), rounding);
}

TEST(Theory, ObjectsHaveTheirPropertiesAlongNonlinearSolutions) {
  sfdae::Solver solver(theory_pendulum());
  sfdae::Point point{0.0, {0.8, -0.6, 0.0, 0.0, 0.0}, {}};
  EXPECT_EQ(status_of_getter([&] { solver.projectors(0.0); }), SFDAE_NOT_STARTED);
  EXPECT_EQ(status_of_getter([&] { solver.jet(0.0, 2, point.x); }), SFDAE_NOT_STARTED);
  solver.start(point, 2.0);
  expect_properties(solver, point);
  for (const double t : {0.5, 1.0, 2.0}) {
    solver.advance(t, point);
    expect_properties(solver, point);
  }
  const std::vector<double> x(4);
  EXPECT_EQ(status_of_getter([&] { solver.jet(2.0, 2, x); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_getter([&] { solver.jet(2.0, -2); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_getter([&] { solver.derivative_array(2.0, 2, Matrix(5, 3)); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_getter([&] { solver.projectors(2.0, Matrix(4, 4)); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_getter([&] { solver.strangeness_free(2.0, Matrix(5, 2)); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_getter([&] { solver.extended_system(2.0); }), SFDAE_ILLEGAL_ARGUMENT);
}

TEST(Theory, ObjectsHaveTheirPropertiesForMechanicalSystems) {
  sfdae::Solver solver(theory_mechanical_pendulum());
  sfdae::Point point{0.0, {0.8, -0.6, 0.0, 0.0, 0.0}, {}};
  solver.start(point, 2.0);
  expect_properties(solver, point);
  solver.advance(1.0, point);
  expect_properties(solver, point);
  const sfdae::ExtendedSystem e = solver.extended_system(1.0);
  ASSERT_EQ(e.E.rows(), 7);  // (q, v, lambda, wq, wv)
  EXPECT_LE(std::max(largest(e.Qq, e.Qq, 1.0), largest(e.Qv, e.Qv, 1.0)), rounding);
  EXPECT_LE(largest(e.f), rounding);
  // w = Q2^T (q', v'), and v' = (0, -1) - q lambda.
  const std::vector<double>& x = point.x;
  EXPECT_NEAR(e.w[0], e.Qq(0, 1) * x[2] + e.Qq(1, 1) * x[3], rounding);
  EXPECT_NEAR(e.w[1], -e.Qv(0, 1) * x[0] * x[4] - e.Qv(1, 1) * (1.0 + x[1] * x[4]), rounding);
}

// Z2 and Z3 are not to be had; the rest is.
TEST(Theory, CallbacksOfMechanicalSystemsHaveNoArray) {
  sfdae::Solver solver(theory_pendulum_by_callbacks());
  sfdae::Point point{0.0, {0.8, -0.6, 0.0, 0.0, 0.0}, {}};
  solver.start(point, 2.0);
  const sfdae::Projectors p = solver.projectors(0.0);
  EXPECT_EQ(p.Z2.columns(), 0);
  EXPECT_EQ(p.Z3.columns(), 0);
  EXPECT_LE(std::max(largest(p.T2, p.T2, 1.0), largest(p.Z1, p.Z1, 1.0)), rounding);
  const sfdae::StrangenessFreeSystem s = solver.strangeness_free(0.0, solver.jet(0.0, 0));
  EXPECT_LE(largest(transposed(s.A2), p.T2), rounding);
  EXPECT_LE(std::max(largest(s.f1), largest(s.f2)), rounding);
  EXPECT_EQ(status_of_getter([&] { solver.derivative_array(0.0, 1); }), SFDAE_ORDER_MISSING);
}

// The plain derivatives of functions by differences: objects that need higher orders choose other spacings for
// themselves only.
TEST(Theory, LeavesTheDifferencesOfAnIntegration) {
  sfdae::LinearProblem problem(2, 2);
  const auto has = [](int order) { return order > 0 ? SFDAE_ORDER_NOT_AVAILABLE : 0; };
  problem.E = [has](double t, int order, sfdae::MatrixRef E) {
    E(0, 0) = 1.0;
    E(0, 1) = 0.5 * std::sin(3.0 * t);
    return has(order);
  };
  problem.A = [has](double t, int order, sfdae::MatrixRef A) {
    A(0, 0) = -std::cos(t);
    A(1, 0) = 1.0;
    A(1, 1) = 2.0 + std::sin(t);
    return has(order);
  };
  problem.f = [has](double t, int order, sfdae::VectorRef f) {
    f[1] = std::exp(-t);
    return has(order);
  };
  sfdae::Options options;
  options.difference_derivatives = 1;
  sfdae::Solver one(problem, options), other(problem, options);
  sfdae::Point of_one{0.0, {0.3, 0.1}, {}}, of_other = of_one;
  one.start(of_one, 2.0);
  other.start(of_other, 2.0);
  for (const double t : {0.5, 1.0, 1.5}) {
    one.derivative_array(t, 3);
    one.projectors(t);
    one.advance(t, of_one);
    other.advance(t, of_other);
    EXPECT_EQ(of_one.x, of_other.x);
    EXPECT_EQ(of_one.xdot, of_other.xdot);
  }
}

}  // namespace
