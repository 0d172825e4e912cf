// A mechanical system with constraints at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Rows so small that the inverse of their size would overflow count as zero.
double unit_of(double size) {
  constexpr double smallest = 1e-300;
  return size < smallest ? 0.0 : size;
}

// Squares are taken relative to the largest entry, so that they neither overflow nor underflow.
double row_length(ConstView a, int i) {
  constexpr double smallest = 1e-140, largest = 1e140;
  double scale = 0.0;
  for (int j = 0; j < a.cols; ++j) scale = std::max(scale, std::fabs(a(i, j)));
  if (scale == 0.0) return 0.0;
  if (scale > smallest && scale < largest) scale = 1.0;
  double sum = 0.0;
  for (int j = 0; j < a.cols; ++j) sum += (a(i, j) / scale) * (a(i, j) / scale);
  return scale * std::sqrt(sum);
}

// Frobenius norm for one column.
double mean_length(ConstView a) {
  double sum = 0.0;
  for (int i = 0; i < a.rows; ++i) sum += std::pow(row_length(a, i), 2);
  return std::sqrt(sum / std::max(a.cols, 1));
}

bool is_diagonal(ConstView a) {
  for (int j = 0; j < a.cols; ++j) {
    const double* column = a.column(j);
    int others = 0;  // counted without branches, as there are none as a rule
    for (int i = 0; i < a.rows; ++i) others += column[i] != 0.0 ? 1 : 0;
    if (others > (column[j] != 0.0 ? 1 : 0)) return false;
  }
  return true;
}

// Diagonal masses are typical for coordinates of points.
void multiply_mass(ConstView M, ConstView T, View MT) {
  if (!is_diagonal(M)) return multiply(1.0, Op::plain, M, Op::plain, T, 0.0, MT);
  for (int j = 0; j < T.cols; ++j)
    for (int i = 0; i < T.rows; ++i) MT(i, j) = M(i, i) * T(i, j);
}

}  // namespace

void MultibodyPoint::resize(const MultibodySizes& sizes) {
  const std::size_t nq = index(sizes.positions), nv = index(sizes.velocities), nc = index(sizes.constraints());
  terms = MultibodyTerms(sizes);
  q.assign(nq, 0.0);
  v.assign(nv, 0.0);
  a.assign(nv, 0.0);
  mu.assign(nc + 1, 0.0);
  position_units.assign(index(sizes.holonomic) + 1, 0.0);
  velocity_units.assign(nc + 1, 0.0);
  K_ = Matrix();
  pivots_.assign(nv + nc + 1, 0);
  solution_.assign(nv + nc + 1, 0.0);
}

void MultibodyPoint::set(double new_t, const double* new_q, const double* new_v) {
  t = new_t;
  std::copy_n(new_q, q.size(), q.data());
  std::copy_n(new_v, v.size(), v.data());
}

void MultibodyPoint::measure_rows() {
  const int nl = terms.g_q.rows(), nc = terms.C.rows();
  const double kinematics = terms.S.rows() > 0 ? mean_length(terms.S) : 1.0;
  for (int i = 0; i < nl; ++i) {
    position_units[index(i)] = unit_of(row_length(terms.g_q, i));
    velocity_units[index(i)] = unit_of(kinematics * position_units[index(i)]);
  }
  for (int i = nl; i < nc; ++i) velocity_units[index(i)] = unit_of(row_length(terms.C, i));
}

void MultibodyPoint::velocity_residuals(double* residuals) const {
  std::copy_n(terms.velocity_rest.data(), terms.C.rows(), residuals);
  multiply(1.0, Op::plain, terms.C, v.data(), 1.0, residuals);
}

void MultibodyPoint::rates(double* rates) const {
  if (terms.S.rows() == 0) std::copy(v.begin(), v.end(), rates);
  else multiply(1.0, Op::plain, terms.S, v.data(), 0.0, rates);
}

bool MultibodyPoint::factor(const std::vector<int>& rows, int rank) {
  const int nv = terms.M.rows(), order = nv + rank;
  // Allocated when needed, as it is the largest of all.
  const int largest_order = nv + terms.C.rows();
  if (K_.rows() != largest_order) K_ = Matrix(largest_order, largest_order);
  order_ = order;
  const View K{K_.data(), order, order, std::max(order, 1)};
  for (int j = 0; j < nv; ++j) {
    std::copy_n(terms.M.view().column(j), nv, K.column(j));
    const double* C = terms.C.view().column(j);
    for (int k = 0; k < rank; ++k) K(nv + k, j) = K(j, nv + k) = C[rows[index(k)]];
  }
  for (int k = 0; k < rank; ++k) std::fill_n(K.column(nv + k) + nv, rank, 0.0);
  return factor_lu(K, pivots_.data());
}

void MultibodyPoint::solve_accelerations(const std::vector<int>& rows, int rank) {
  const int nv = terms.M.rows();
  std::copy_n(terms.f.data(), nv, solution_.data());
  for (int k = 0; k < rank; ++k) solution_[index(nv + k)] = -terms.acceleration_rest[index(rows[index(k)])];
  solve(solution_.data());
  std::copy_n(solution_.data(), nv, a.data());
  std::fill(mu.begin(), mu.end(), 0.0);
  for (int k = 0; k < rank; ++k) mu[index(rows[index(k)])] = solution_[index(nv + k)];
}

bool MultibodyPoint::solve_by_masses(const Partition& partition, const Tangent& tangent, Arena& arena) {
  const int nv = terms.M.rows(), r = partition.rank;
  const ConstView M = terms.M, C = tangent.rows();
  double least = M(0, 0), greatest = least;
  for (int j = 1; j < nv; ++j) {
    least = std::min(least, M(j, j));
    greatest = std::max(greatest, M(j, j));
  }
  if (!(least > smallest_mass_ratio * greatest) || !is_diagonal(M)) return false;
  const Arena::Frame frame(arena);
  double* inverse = arena.take(index(nv));
  double* b = arena.take(index(r) + 1);
  const View CM = arena.matrix(r, nv), reduced = arena.matrix(r, r);
  int* pivots = arena.integers(r + 1);
  for (int j = 0; j < nv; ++j) {
    inverse[j] = 1.0 / M(j, j);
    for (int k = 0; k < r; ++k) CM(k, j) = C(k, j) * inverse[j];
  }
  std::copy_n(terms.f.data(), nv, a.data());
  std::fill(mu.begin(), mu.end(), 0.0);
  if (r > 0) {
    for (int k = 0; k < r; ++k) b[k] = tangent.units()[k] * terms.acceleration_rest[index(partition.rows[index(k)])];
    multiply(1.0, Op::plain, CM, terms.f.data(), 1.0, b);
    multiply(1.0, Op::plain, CM, Op::transposed, C, 0.0, reduced);
    if (!factor_lu(reduced, pivots)) return false;
    solve_lu(reduced, pivots, b);
    multiply(-1.0, Op::transposed, C, b, 1.0, a.data());
    for (int k = 0; k < r; ++k) mu[index(partition.rows[index(k)])] = tangent.units()[k] * b[k];
  }
  for (int j = 0; j < nv; ++j) a[index(j)] *= inverse[j];
  return true;
}

bool MultibodyPoint::solve_along(const Partition& partition, const Tangent& tangent, Arena& arena) {
  const int nv = terms.M.rows(), d = nv - partition.rank;
  const ConstView T = tangent.T();
  const Arena::Frame frame(arena);
  double* force = arena.take(index(nv));
  double* y = arena.take(index(d) + 1);
  const View MT = arena.matrix(nv, d), reduced = arena.matrix(d, d);
  int* pivots = arena.integers(d + 1);
  tangent.correction(partition, terms.acceleration_rest.data(), a.data(), arena);
  std::copy_n(terms.f.data(), nv, force);
  multiply(-1.0, Op::plain, terms.M, a.data(), 1.0, force);
  multiply_mass(terms.M, T, MT);
  multiply(1.0, Op::transposed, T, Op::plain, MT, 0.0, reduced);
  multiply(1.0, Op::transposed, T, force, 0.0, y);
  if (!factor_lu(reduced, pivots)) return false;
  if (d > 0) solve_lu(reduced, pivots, y);
  multiply(1.0, Op::plain, T, y, 1.0, a.data());
  multiply(-1.0, Op::plain, MT, y, 1.0, force);
  tangent.multipliers(partition, force, mu.data(), arena);
  return true;
}

void MultibodyPoint::solve(double* yz) const {
  if (order_ > 0) solve_lu(ConstView{K_.data(), order_, order_, order_}, pivots_.data(), yz);
}

void MultibodyPoint::solve(View yz) const {
  if (order_ > 0) solve_lu(ConstView{K_.data(), order_, order_, order_}, pivots_.data(), yz);
}

void MultibodyPoint::solve_transposed(View yz) const {
  if (order_ > 0) solve_lu_transposed(ConstView{K_.data(), order_, order_, order_}, pivots_.data(), yz);
}

// The part of mu in the range of C, which is that of C Q2: C^T mu stays.
void MultibodyPoint::take_least_norm(const Partition& partition, double* forces, Arena& arena) const {
  const int nc = terms.C.rows(), r = partition.rank;
  if (r == nc || r == 0) return;
  const Arena::Frame frame(arena);
  const View range = arena.matrix(nc, r);
  double* tau = arena.take(index(nc));
  double* part = arena.take(index(nc));
  multiply(1.0, Op::plain, terms.C, Op::plain, partition.Q2(), 0.0, range);
  factor_qr(range, tau, arena);
  std::copy_n(forces, nc, part);
  const View column{part, nc, 1, nc};
  apply_q(Op::transposed, range, r, tau, column, arena);
  std::fill(part + r, part + nc, 0.0);
  apply_q(Op::plain, range, r, tau, column, arena);
  std::copy_n(part, nc, forces);
}

double condition_of_constraints(const MultibodyPoint& point, const Partition& partition) {
  const int r = partition.rank, nv = partition.Q.rows();
  if (r == 0) return 1.0;
  Matrix C(r, nv);
  for (int k = 0; k < r; ++k) {
    const int i = partition.rows[index(k)];
    for (int j = 0; j < nv; ++j) C(k, j) = point.terms.C(i, j) / point.velocity_units[index(i)];
  }
  const double smallest = singular_values(product(C, partition.Q2())).back();
  return smallest > 0.0 ? singular_values(C).front() / smallest : std::numeric_limits<double>::infinity();
}

double condition_of_constraints(const MultibodyPoint& point) {
  Matrix C = to_matrix(point.terms.C);
  if (C.rows() == 0) return 1.0;
  for (int i = 0; i < C.rows(); ++i)
    if (point.velocity_units[index(i)] == 0.0) return std::numeric_limits<double>::infinity();
  for (int j = 0; j < C.cols(); ++j)
    for (int i = 0; i < C.rows(); ++i) C(i, j) /= point.velocity_units[index(i)];
  const std::vector<double> values = singular_values(C);
  return values.back() > 0.0 ? values.front() / values.back() : std::numeric_limits<double>::infinity();
}

namespace {

// Residuals of rows that vanish are not scaled.
double largest_residual(const std::vector<double>& residuals, const std::vector<double>& units, int count) {
  double worst = 0.0;
  for (std::size_t i = 0; i < index(count); ++i)
    worst = std::max(worst, std::fabs(residuals[i]) / (units[i] > 0.0 ? units[i] : 1.0));
  return worst;
}

}  // namespace

double position_residual(const MultibodyPoint& point) {
  return largest_residual(point.terms.g, point.position_units, point.terms.g_q.rows());
}

double velocity_residual(const MultibodyPoint& point) {
  const int nc = point.terms.C.rows();
  std::vector<double> residuals(index(nc) + 1);
  point.velocity_residuals(residuals.data());
  return largest_residual(residuals, point.velocity_units, nc);
}

namespace {

// Rounding errors relative to the sum of |terms|: of the numbers themselves, of products, and of their sum.
constexpr double roundings = 8.0 * unit_roundoff;

}  // namespace

bool positions_hold_to_rounding(const MultibodyPoint& point) {
  const ConstView g_q = point.terms.g_q;
  const double size = max_abs(point.q);
  for (int i = 0; i < g_q.rows; ++i) {
    double terms = std::fabs(point.terms.velocity_rest[index(i)] * point.t);
    for (int j = 0; j < g_q.cols; ++j) terms += std::fabs(g_q(i, j) * point.q[index(j)]);
    // Terms without derivatives, as cos phi near 0, are taken to be as large as positions.
    terms = std::max(terms, point.position_units[index(i)] * size);
    if (!(std::fabs(point.terms.g[index(i)]) <= roundings * terms)) return false;
  }
  return true;
}

bool velocities_hold_to_rounding(const MultibodyPoint& point) {
  const int rows = point.terms.C.rows();
  std::vector<double> residuals(index(rows) + 1), rates(point.q.size(), 0.0);
  point.velocity_residuals(residuals.data());
  // C = g_q S may consist of rounding errors, as for the length of a quaternion.
  const Matrix& S = point.terms.S;
  for (int j = 0; j < S.cols(); ++j)
    for (int k = 0; k < S.rows(); ++k) rates[index(k)] += std::fabs(S(k, j) * point.v[index(j)]);
  return velocities_hold_to_rounding(point, residuals.data(), rates.data());
}

bool velocities_hold_to_rounding(const MultibodyPoint& point, const double* residuals, const double* rates) {
  const ConstView C = point.terms.C;
  const Matrix& S = point.terms.S;
  const double size = max_abs(point.v);
  for (int i = 0; i < C.rows; ++i) {
    double terms = std::fabs(point.terms.velocity_rest[index(i)]);
    for (int j = 0; j < C.cols; ++j) terms += std::fabs(C(i, j) * point.v[index(j)]);
    for (int k = 0; k < S.rows() && i < point.terms.g_q.rows(); ++k)
      terms += std::fabs(point.terms.g_q(i, k) * rates[k]);
    terms = std::max(terms, point.velocity_units[index(i)] * size);
    if (!(std::fabs(residuals[i]) <= roundings * terms)) return false;
  }
  return true;
}

}  // namespace sfdae::core
