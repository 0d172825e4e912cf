// Dependent directions as functions of independent ones under constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_tangent.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// N is formed for at most so many independent rows, as products are much faster than solutions of small systems; the
// limit depends on the machine, and no figures were recorded.
constexpr int most_explicit = 16;

// Elimination with X + X^T.
bool has_positive_symmetric_part(ConstView X, Arena& arena) {
  const int n = X.cols;
  const Arena::Frame frame(arena);
  const View A = arena.matrix(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i) A(i, j) = X(i, j) + X(j, i);
  for (int k = 0; k < n; ++k) {
    if (!(A(k, k) > 0.0)) return false;
    for (int j = k + 1; j < n; ++j) {
      const double factor = A(j, k) / A(k, k);
      for (int i = j; i < n; ++i) A(i, j) -= factor * A(i, k);
    }
  }
  return true;
}

}  // namespace

void Tangent::resize(int directions, int constraints) {
  C_ = Matrix(constraints, directions);
  T_ = Matrix(directions, directions);
  N_ = Matrix(directions, constraints);
  lu_ = Matrix(constraints, constraints);
  pivots_.resize(index(constraints) + 1);
  units_.assign(index(constraints) + 1, 1.0);
}

// N from (C Q2)^-1.
bool Tangent::invert(const Partition& partition, View C2) {
  double pivots[most_explicit];
  if (!invert_small(C2, pivots, sign_)) return false;
  for (int k = 0; k < rank_; ++k) pivot_ = std::min(pivot_, std::fabs(pivots[k]));
  if (has_N_) multiply(1.0, Op::plain, partition.Q2(), Op::plain, C2, 0.0, N_.view().columns(0, rank_));
  return true;
}

bool Tangent::factor(View C2) {
  if (!factor_lu(C2, pivots_.data())) return false;
  for (int k = 0; k < rank_; ++k) {
    pivot_ = std::min(pivot_, std::fabs(C2(k, k)));
    if ((C2(k, k) < 0.0) != (pivots_[index(k)] != k + 1)) sign_ = -sign_;
  }
  return true;
}

bool Tangent::fit(const Partition& partition, const ConstraintRows& constraints, Uses uses) {
  const int n = partition.Q.rows(), r = partition.rank;
  rank_ = r;
  is_complete_ = false;
  has_N_ = uses == Uses::many && r <= most_explicit;
  rotation_ = 0.0;
  pivot_ = 1.0;
  sign_ = 1;
  if (r == 0) return true;
  for (int k = 0; k < r; ++k) {
    const double unit = constraints.units[partition.rows[index(k)]];
    units_[index(k)] = unit > 0.0 ? 1.0 / unit : 1.0;
  }
  const View C{C_.data(), r, n, r}, C2{lu_.data(), r, r, r};
  for (int j = 0; j < n; ++j) {
    const double* from = constraints.matrix.column(j);
    double* to = C.column(j);
    for (int k = 0; k < r; ++k) to[k] = units_[index(k)] * from[partition.rows[index(k)]];
  }
  multiply(1.0, Op::plain, C, Op::plain, partition.Q2(), 0.0, C2);
  if (r <= most_explicit ? invert(partition, C2) : factor(C2)) return true;
  pivot_ = 0.0;
  sign_ = 0;
  return false;
}

bool Tangent::complete(const Partition& partition, Arena& arena) {
  const int n = partition.Q.rows(), r = rank_;
  const View T{T_.data(), n, n - r, std::max(n, 1)};
  copy(partition.Q1(), T);
  is_complete_ = true;
  if (r == 0) return true;
  const Arena::Frame frame(arena);
  const View C1 = arena.matrix(r, n - r);
  multiply(1.0, Op::plain, rows(), Op::plain, partition.Q1(), 0.0, C1);
  View E = C1;
  if (r <= most_explicit) {
    E = arena.matrix(r, n - r);
    multiply(1.0, Op::plain, ConstView{lu_.data(), r, r, r}, Op::plain, C1, 0.0, E);
  } else {
    solve_lu(ConstView{lu_.data(), r, r, r}, pivots_.data(), E);
  }
  rotation_ = max_abs(E);
  multiply(-1.0, Op::plain, partition.Q2(), Op::plain, E, 1.0, T);
  return std::isfinite(rotation_);
}

void Tangent::gather(const Partition& partition, const double* residuals, double* b) const {
  for (int k = 0; k < rank_; ++k) b[k] = units_[index(k)] * residuals[partition.rows[index(k)]];
}

void Tangent::subtract(const Partition& partition, double* b, double* w) const {
  const int r = rank_;
  if (has_N_) return multiply(-1.0, Op::plain, N_.view().columns(0, r), b, 1.0, w);
  const ConstView lu{lu_.data(), r, r, r};
  if (r <= most_explicit) {
    double solution[most_explicit];
    multiply(1.0, Op::plain, lu, b, 0.0, solution);
    return multiply(-1.0, Op::plain, partition.Q2(), solution, 1.0, w);
  }
  solve_lu(lu, pivots_.data(), b);
  multiply(-1.0, Op::plain, partition.Q2(), b, 1.0, w);
}

void Tangent::enforce(const Partition& partition, const double* b, double* w, Arena& arena) const {
  if (rank_ == 0) return;
  const Arena::Frame frame(arena);
  double* rest = arena.take(index(rank_));
  if (b != nullptr) gather(partition, b, rest);
  multiply(1.0, Op::plain, rows(), w, b != nullptr ? 1.0 : 0.0, rest);
  subtract(partition, rest, w);
}

// X^T for X = B Q2 (C Q2)^-1
void Tangent::relative_to_rows(const Partition& partition, ConstView B, View Xt, Arena& arena) const {
  const int r = rank_, n = T_.rows();
  const Arena::Frame frame(arena);
  const View independent = arena.matrix(r, n);
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < r; ++k) independent(k, j) = units_[index(k)] * B(partition.rows[index(k)], j);
  if (has_N_) {
    multiply(1.0, Op::transposed, N_.view().columns(0, r), Op::transposed, independent, 0.0, Xt);
  } else if (r <= most_explicit) {
    const View along = arena.matrix(r, r);
    multiply(1.0, Op::transposed, partition.Q2(), Op::transposed, independent, 0.0, along);
    multiply(1.0, Op::transposed, ConstView{lu_.data(), r, r, r}, Op::plain, along, 0.0, Xt);
  } else {
    multiply(1.0, Op::transposed, partition.Q2(), Op::transposed, independent, 0.0, Xt);
    solve_lu_transposed(ConstView{lu_.data(), r, r, r}, pivots_.data(), Xt);
  }
}

// The negative eigenvalues of X; there are none if its symmetric part is positive definite.
Tangent::ZeroCrossings Tangent::zero_crossings_from(const Partition& partition, ConstView B, Arena& arena) const {
  const int r = rank_;
  if (r == 0) return {};
  const Arena::Frame frame(arena);
  const View Xt = arena.matrix(r, r);
  relative_to_rows(partition, B, Xt, arena);
  if (has_positive_symmetric_part(Xt, arena)) return {};
  int most = 0;
  for (int k = 1; k < r; ++k)
    if (Xt(k, k) < Xt(most, most)) most = k;
  return {count_negative_eigenvalues(Xt, arena), partition.rows[index(most)]};
}

double Tangent::fastest_change(const Partition& partition, ConstView B, int& row, Arena& arena) const {
  const int r = rank_;
  if (r == 0) return 0.0;
  const Arena::Frame frame(arena);
  const View Xt = arena.matrix(r, r);
  relative_to_rows(partition, B, Xt, arena);
  int fastest = 0;
  for (int k = 1; k < r; ++k)
    if (std::fabs(Xt(k, k)) > std::fabs(Xt(fastest, fastest))) fastest = k;
  row = partition.rows[index(fastest)];
  return largest_real_eigenvalue(Xt, arena);
}

void Tangent::correction(const Partition& partition, const double* residuals, double* w, Arena& arena) const {
  std::fill_n(w, partition.Q.rows(), 0.0);
  if (rank_ == 0) return;
  const Arena::Frame frame(arena);
  double* b = arena.take(index(rank_));
  gather(partition, residuals, b);
  subtract(partition, b, w);
}

void Tangent::multipliers(const Partition& partition, const double* force, double* mu, Arena& arena) const {
  const int r = rank_;
  std::fill_n(mu, partition.rows.size(), 0.0);
  if (r == 0) return;
  const Arena::Frame frame(arena);
  double* b = arena.take(index(r));
  if (has_N_) {
    multiply(1.0, Op::transposed, N_.view().columns(0, r), force, 0.0, b);
  } else if (r <= most_explicit) {
    double along[most_explicit];
    multiply(1.0, Op::transposed, partition.Q2(), force, 0.0, along);
    multiply(1.0, Op::transposed, ConstView{lu_.data(), r, r, r}, along, 0.0, b);
  } else {
    multiply(1.0, Op::transposed, partition.Q2(), force, 0.0, b);
    solve_lu_transposed(ConstView{lu_.data(), r, r, r}, pivots_.data(), {b, r, 1, r});
  }
  for (int k = 0; k < r; ++k) mu[partition.rows[index(k)]] = units_[index(k)] * b[k];
}

}  // namespace sfdae::core
