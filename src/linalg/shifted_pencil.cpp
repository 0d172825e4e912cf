// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/shifted_pencil.h"

#include <cmath>

#include "linalg/lapack_names.h"

namespace sfdae::core {

ShiftedPencil::Vector product(Op op, ConstView a, const ShiftedPencil::Vector& x) {
  ShiftedPencil::Vector y(index(op == Op::plain ? a.rows : a.cols));
  for (int j = 0; j < a.cols; ++j) {
    const double* const column = a.column(j);
    if (op == Op::plain) {
      for (int i = 0; i < a.rows; ++i) y[index(i)] += column[i] * x[index(j)];
    } else {
      for (int i = 0; i < a.rows; ++i) y[index(j)] += column[i] * x[index(i)];
    }
  }
  return y;
}

bool ShiftedPencil::scale() {
  const int n = size();
  const std::size_t count = index(n) * index(n);
  std::vector<double> sizes(count);
  std::vector<int> first(index(n + 1)), rows(count);
  const double size_of_s = std::abs(s_);
  for (int j = 0; j < n; ++j) {
    first[index(j + 1)] = (j + 1) * n;
    for (int i = 0; i < n; ++i) {
      const std::size_t k = index(j) * index(n) + index(i);
      rows[k] = i;
      sizes[k] = size_of_s * std::fabs(E_(i, j)) + std::fabs(A_(i, j));
    }
  }
  if (!units_.compute({n, n, first.data(), rows.data()}, sizes.data())) return false;
  scaled_E_ = Matrix(n, n);
  scaled_A_ = Matrix(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int exponent = row_exponents()[index(i)] + column_exponents()[index(j)];
      scaled_E_(i, j) = times_power_of_two(E_(i, j), exponent);
      scaled_A_(i, j) = times_power_of_two(A_(i, j), exponent);
    }
  return true;
}

bool ShiftedPencil::factor(Complex s) {
  s_ = s;
  if (!scale()) return false;
  const int n = size();
  lu_.resize(index(n) * index(n));
  pivots_.resize(index(n));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) lu_[index(j) * index(n) + index(i)] = s * scaled_E_(i, j) - scaled_A_(i, j);
  int info = 0;
  if (n > 0) lapack::getrf(&n, &n, lu_.data(), &n, pivots_.data(), &info);
  return info == 0;
}

void ShiftedPencil::solve(Op op, Vector& b) const {
  const int n = size(), one = 1;
  int info = 0;
  if (n > 0)
    lapack::getrs(op == Op::plain ? "N" : "T", &n, &one, lu_.data(), &n, pivots_.data(), b.data(), &n, &info);
}

ShiftedPencil::Vector ShiftedPencil::product(Op op, const Vector& x) const {
  Vector y = core::product(op, scaled_E_, x);
  const Vector Ax = core::product(op, scaled_A_, x);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = s_ * y[i] - Ax[i];
  return y;
}

}  // namespace sfdae::core
