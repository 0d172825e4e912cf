// Orthogonal factors of matrices whose rows differ much in size.
//
// [CH98] A. J. Cox, N. J. Higham: Stability of Householder QR factorization for weighted least squares problems.
//        In: Numerical Analysis 1997, Longman, 1998.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/orthogonal_factors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::f77 {

using namespace core;

namespace {

std::vector<double> row_sizes(ConstView a) {
  std::vector<double> size(core::index(a.rows), 0.0);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) size[core::index(i)] = std::max(size[core::index(i)], std::fabs(a(i, j)));
  return size;
}

// To [1, 2).
double factor_to_one(double size) {
  return size > 0.0 ? std::ldexp(1.0, std::clamp(-std::ilogb(size), -1000, 1000)) : 1.0;
}

// Indices of the rows, the largest first.
std::vector<int> rows_by_size(ConstView a) {
  const std::vector<double> size = row_sizes(a);
  std::vector<int> order(size.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int i, int k) { return size[core::index(i)] > size[core::index(k)]; });
  return order;
}

}  // namespace

std::vector<double> row_factors(ConstView a, ConstView b) {
  const std::vector<double> of_a = row_sizes(a), of_b = row_sizes(b);
  std::vector<double> factors(of_a.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double size = std::max(of_a[i], of_b[i]);
    factors[i] = size > 0.0 ? factor_to_one(size) : 0.0;
    largest = std::max(largest, factors[i]);
  }
  for (double& factor : factors)
    if (factor == 0.0) factor = largest > 0.0 ? largest : 1.0;
  return factors;
}

void raise_zero_rows(ConstView a, std::vector<double>& factors) {
  const std::vector<double> size = row_sizes(a);
  const double largest = *std::max_element(factors.begin(), factors.end());
  for (std::size_t i = 0; i < factors.size(); ++i)
    if (size[i] == 0.0) factors[i] = largest;
}

Matrix scaled_rows(const std::vector<double>& factors, ConstView a) {
  Matrix result = to_matrix(a);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) result(i, j) *= factors[core::index(i)];
  return result;
}

Matrix orthogonal_factor(ConstView a) {
  if (a.cols == 0) return identity(a.rows);
  // Rows sorted and columns pivoted: then the backward error is small by rows [CH98].
  const std::vector<int> order = rows_by_size(a);
  const double unit = factor_to_one(max_abs(a));
  Matrix factors(a.rows, a.cols);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) factors(i, j) = unit * a(order[core::index(i)], j);
  Arena arena;
  const int count = std::min(a.rows, a.cols);
  std::vector<int> pivots(core::index(a.cols));
  std::vector<double> tau(core::index(count) + 1);
  factor_qr_pivoted(factors, pivots.data(), tau.data(), arena);
  Matrix sorted(a.rows, a.rows), Q(a.rows, a.rows);
  form_q(factors, count, tau.data(), sorted, arena);
  for (int j = 0; j < a.rows; ++j)
    for (int i = 0; i < a.rows; ++i) Q(order[core::index(i)], j) = sorted(i, j);
  return Q;
}

Matrix left_factor(ConstView M, ConstView Z) {
  const int rows = Z.rows, kernel = Z.cols, rank = rows - kernel;
  const Matrix Q = orthogonal_factor(Z);
  const ConstView complement = Q.view().columns(kernel, rank);
  Matrix result(rows, rows);
  if (rank > 0) {
    // Of size 1, for products not to overflow.
    const std::vector<double> unit(core::index(rows), factor_to_one(max_abs(M)));
    const Svd rest = svd(transpose_product(complement, scaled_rows(unit, M)));
    multiply(1.0, Op::plain, complement, Op::plain, rest.U, 0.0, result.view().columns(0, rank));
  }
  copy(Q.view().columns(0, kernel), result.view().columns(rank, kernel));
  return result;
}

}  // namespace sfdae::f77
