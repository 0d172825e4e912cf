// Start values of random linkages: what is right stays, what is not becomes consistent and stays as near as it can.
//
// The metric is that of the kinetic energy (multibody_metric.h): the nearest point differs from the one given by
// W dq = -g_q^T p, M dv = -C^T p with some p. SFDAE_LINKAGES is the number of linkages; a campaign takes 1000.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "family_run.h"
#include "linalg/dense.h"
#include "multibody/linkage.h"
#include "multibody_run.h"

namespace sfdae::test {
namespace {

using core::Matrix;
using sfdae_test::Linkage;
using sfdae_test::LinkageTerms;
using Vector = std::vector<double>;

constexpr double epsilon = 2.2e-16;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

int count_of_linkages() {
  const char* text = std::getenv("SFDAE_LINKAGES");
  return text != nullptr ? std::atoi(text) : sfdae_test::scaled_count(60);
}

Matrix matrix_of(const Vector& values, int rows, int cols) {
  Matrix A(rows, cols);
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) A(i, j) = values[at(i + rows * j)];
  return A;
}

// Rows of length 1 but for those that vanish, as unit quaternions say nothing about velocities; b in the same units.
Matrix unit_rows(Matrix A, Vector* b = nullptr) {
  for (int i = 0; i < A.rows(); ++i) {
    double sum = 0.0;
    for (int j = 0; j < A.cols(); ++j) sum += A(i, j) * A(i, j);
    const double unit = std::sqrt(sum);
    if (unit < 1e-12) continue;
    for (int j = 0; j < A.cols(); ++j) A(i, j) /= unit;
    if (b != nullptr) (*b)[at(i)] /= unit;
  }
  return A;
}

double largest(const Vector& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::fabs(value));
  return result;
}

// C v + r, in units of what rounding makes of it.
double velocity_residual(const LinkageTerms& terms, const Vector& v) {
  const int rows = static_cast<int>(terms.r.size()), nv = static_cast<int>(v.size());
  double worst = 0.0;
  for (int i = 0; i < rows; ++i) {
    double sum = terms.r[at(i)], size = std::fabs(terms.r[at(i)]);
    for (int j = 0; j < nv; ++j) {
      sum += terms.C[at(i + rows * j)] * v[at(j)];
      size += std::fabs(terms.C[at(i + rows * j)]) * largest(v);
    }
    // Rows of unit quaternions are sums of numbers up to 1 that cancel.
    worst = std::max(worst, std::fabs(sum) / (32.0 * epsilon * (size + largest(v))));
  }
  return worst;
}

double position_residual(const LinkageTerms& terms) {
  double worst = 0.0;
  for (std::size_t i = 0; i < terms.g.size(); ++i) worst = std::max(worst, std::fabs(terms.g[i]) / terms.rounding[i]);
  return worst;
}

struct Start {
  Linkage linkage;
  Vector x;               // (q, v, 0)
  double smallest = 0.0;  // singular value of the independent constraints in unit rows
  int movable() const { return linkage.positions() + linkage.velocities(); }
};

// A linkage with velocities that its constraints allow.
Start consistent_start(std::mt19937& engine) {
  Start start;
  // Configurations as near to singular ones as that are not what this is about.
  constexpr double regular = 1e-2;
  while (!(start.smallest > regular)) {
    start = {};
    Linkage& linkage = start.linkage = sfdae_test::random_linkage(engine);
    const LinkageTerms terms(linkage, linkage.t0, linkage.q0.data());
    const int nv = linkage.velocities(), rows = linkage.holonomic() + linkage.nonholonomic();
    const int redundant = static_cast<int>(linkage.copies.size()) + (linkage.has_kinematics() ? linkage.bodies : 0);
    Vector v;
    for (int j = 0; j < nv; ++j) v.push_back(std::uniform_real_distribution<double>(-1.0, 1.0)(engine));
    for (int pass = 0; pass < 3; ++pass) {
      Vector residuals(terms.r);
      for (int i = 0; i < rows; ++i)
        for (int j = 0; j < nv; ++j) residuals[at(i)] += terms.C[at(i + rows * j)] * v[at(j)];
      const Matrix C = unit_rows(matrix_of(terms.C, rows, nv), &residuals);
      start.smallest = core::singular_values(C)[at(rows - redundant - 1)];
      const Vector dv = core::least_squares(C, residuals, 0.5 * start.smallest);
      for (int j = 0; j < nv; ++j) v[at(j)] -= dv[at(j)];
    }
    start.x = linkage.q0;
    start.x.insert(start.x.end(), v.begin(), v.end());
    start.x.resize(start.x.size() + at(rows), 0.0);
  }
  return start;
}

// How far q and v have moved, each relative to its largest entry, times the condition of the constraints.
double moved(const Start& start, const Vector& x) {
  double q = 0.0, v = 0.0, of_q = 0.0, of_v = 0.0;
  for (int i = 0; i < start.movable(); ++i) {
    const bool is_position = i < start.linkage.positions();
    double &change = is_position ? q : v, &size = is_position ? of_q : of_v;
    change = std::max(change, std::fabs(x[at(i)] - start.x[at(i)]));
    size = std::max(size, std::fabs(start.x[at(i)]));
  }
  return std::max(q / of_q, v / of_v) * start.smallest;
}

// Balance of forces at the start: M v' + C^T mu = f with the forces found.
double imbalance(const Start& start, const Vector& x, const Vector& xdot) {
  const Linkage& linkage = start.linkage;
  const LinkageTerms terms(linkage, linkage.t0, x.data());
  const int nq = linkage.positions(), nv = linkage.velocities(), rows = linkage.holonomic() + linkage.nonholonomic();
  Vector f(at(nv), 0.0);
  linkage.force(x.data(), x.data() + nq, f.data());
  double worst = 0.0;
  for (int i = 0; i < nv; ++i) {
    double sum = -f[at(i)], size = std::fabs(f[at(i)]);
    const auto add = [&](double term) { sum += term, size += std::fabs(term); };
    for (int j = 0; j < nv; ++j) add(terms.M[at(i + nv * j)] * xdot[at(nq + j)]);
    for (int k = 0; k < rows; ++k) add(terms.C[at(k + rows * i)] * x[at(nq + nv + k)]);
    worst = std::max(worst, std::fabs(sum) / (size > 0.0 ? size : 1.0));
  }
  return worst;
}

TEST(StartValuesOfLinkages, ThatAreConsistentStay) {
  std::mt19937 engine(1);
  const int count = count_of_linkages();
  int unmoved = 0;
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE(k);
    const Start start = consistent_start(engine);
    MultibodyRun run(start.linkage.problem(), options_of(SFDAE_METHOD_BDF, 1e-6));
    ASSERT_EQ(run.start(start.linkage.t0, start.linkage.t0 + 1.0, start.x), SFDAE_OK) << run.message();
    EXPECT_EQ(run.message(), "");
    const double move = moved(start, run.x);
    EXPECT_LE(move, 1e3 * epsilon);
    unmoved += move == 0.0 ? 1 : 0;
    EXPECT_LE(imbalance(start, run.x, run.xdot), 1e-9);
    // Restarted where it is, as after an event.
    Start again = start;
    again.x = run.x;
    ASSERT_EQ(run.start(start.linkage.t0, start.linkage.t0 + 1.0, again.x), SFDAE_OK) << run.message();
    EXPECT_LE(moved(again, run.x), 1e3 * epsilon);
  }
  // Not a bit changes unless rounding errors of the values given are visible in the constraints.
  EXPECT_GE(unmoved, count * 9 / 10);
  RecordProperty("unmoved", unmoved);
}

// Without a drive constraints are homogeneous in v: an impact v *= -0.5 keeps them.
TEST(StartValuesOfLinkages, ThatAreThoseOfAnImpactStay) {
  std::mt19937 engine(3);
  for (int k = 0; k < count_of_linkages(); ++k) {
    SCOPED_TRACE(k);
    Start start = consistent_start(engine);
    if (start.linkage.drive != 0.0) continue;
    MultibodyRun run(start.linkage.problem(), options_of(SFDAE_METHOD_RADAU, 1e-6));
    ASSERT_EQ(run.start(start.linkage.t0, start.linkage.t0 + 1.0, start.x), SFDAE_OK) << run.message();
    for (int i = start.linkage.positions(); i < start.movable(); ++i) start.x[at(i)] *= -0.5;
    ASSERT_EQ(run.start(start.linkage.t0, start.linkage.t0 + 1.0, start.x), SFDAE_OK) << run.message();
    EXPECT_LE(moved(start, run.x), 1e3 * epsilon);
  }
}

// R upper triangular, W = R^T R.
Matrix root_of(const Matrix& W) {
  const int n = W.rows();
  Matrix R(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= j; ++i) {
      double sum = W(i, j);
      for (int k = 0; k < i; ++k) sum -= R(k, i) * R(k, j);
      R(i, j) = i < j ? sum / R(i, i) : std::sqrt(sum);
    }
  return R;
}

// The part of a change that constraints with these rows leave open, in the metric W, relative to all of it.
double open_part(const Matrix& W, const Vector& rows, const Vector& change) {
  const Matrix R = root_of(W);
  const int n = W.rows(), count = static_cast<int>(rows.size()) / n;
  Matrix J = matrix_of(rows, count, n);
  Vector y(at(n), 0.0), Jy(at(count), 0.0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i <= j; ++i) y[at(i)] += R(i, j) * change[at(j)];
  core::solve_upper_right(R, J);
  J = unit_rows(J);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < count; ++i) Jy[at(i)] += J(i, j) * y[at(j)];
  const Vector normal = core::least_squares(J, Jy, 1e-9);
  double open = 0.0, all = 0.0;
  for (int j = 0; j < n; ++j) {
    open += std::pow(y[at(j)] - normal[at(j)], 2);
    all += std::pow(y[at(j)], 2);
  }
  return all > 0.0 ? std::sqrt(open / all) : 0.0;
}

// W = B^T M B + (I - S B)^T D (I - S B) for translations and quaternions e: B = S^+ = 4 S^T / |e|^2 there.
Matrix position_metric(const Linkage& linkage, const LinkageTerms& terms, const double* q) {
  const int nq = linkage.positions(), nv = linkage.velocities();
  if (!linkage.has_kinematics()) return matrix_of(terms.M, nq, nq);
  Matrix B = core::transpose(matrix_of(terms.S, nq, nv));
  for (int body = 0; body < linkage.bodies; ++body) {
    double squares = 0.0;
    for (int i = 3; i < 7; ++i) squares += std::pow(q[7 * body + i], 2);
    for (int i = 3; i < 6; ++i)
      for (int j = 0; j < nq; ++j) B(6 * body + i, j) *= 4.0 / squares;
  }
  Matrix W = core::transpose_product(B, core::product(matrix_of(terms.M, nv, nv), B));
  Matrix rest = core::product(matrix_of(terms.S, nq, nv), B), weighted(nq, nq);
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nq; ++i) {
      rest(i, j) = (i == j ? 1.0 : 0.0) - rest(i, j);
      weighted(i, j) = W(i, i) * rest(i, j);
    }
  core::multiply(1.0, core::Op::transposed, rest, core::Op::plain, weighted, 1.0, W);
  return W;
}

TEST(StartValuesOfLinkages, ThatAreNotMoveAsLittleAsTheyCan) {
  // Of the change, what the last step of Newton's method may leave.
  constexpr double open = 1e-6;
  std::mt19937 engine(2);
  for (int k = 0; k < count_of_linkages(); ++k) {
    SCOPED_TRACE(k);
    Start start = consistent_start(engine);
    const Linkage& linkage = start.linkage;
    const int nq = linkage.positions(), nv = linkage.velocities();
    for (int i = 0; i < start.movable(); ++i)
      start.x[at(i)] *= 1.0 + 0.3 * std::uniform_real_distribution<double>(-1.0, 1.0)(engine);
    MultibodyRun run(linkage.problem(), options_of(SFDAE_METHOD_BDF, 1e-6));
    ASSERT_EQ(run.start(linkage.t0, linkage.t0 + 1.0, start.x), SFDAE_VALUES_CHANGED) << run.message();
    EXPECT_NE(run.message().find("most of all x["), std::string::npos) << run.message();
    const LinkageTerms given(linkage, linkage.t0, start.x.data()), found(linkage, linkage.t0, run.x.data());
    EXPECT_LE(position_residual(found), 1.0);
    EXPECT_LE(velocity_residual(found, Vector(run.x.begin() + nq, run.x.begin() + nq + nv)), 1.0);
    Vector change(run.x);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= start.x[i];
    const Vector dq(change.begin(), change.begin() + nq), dv(change.begin() + nq, change.begin() + nq + nv);
    EXPECT_LE(open_part(position_metric(linkage, given, start.x.data()), found.g_q, dq), open);
    EXPECT_LE(open_part(matrix_of(found.M, nv, nv), found.C, dv), open);
    // Said once: from there on nothing changes.
    EXPECT_EQ(run.start(linkage.t0, linkage.t0 + 1.0, run.x), SFDAE_OK) << run.message();
  }
}

}  // namespace
}  // namespace sfdae::test
