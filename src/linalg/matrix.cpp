// Column-major matrices: copying, norms, finiteness.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/kernels_in_use.h"

namespace sfdae::core {

void copy(ConstView from, View to) {
  for (int j = 0; j < from.cols; ++j) std::copy_n(from.column(j), from.rows, to.column(j));
}

void fill(View a, double value) {
  for (int j = 0; j < a.cols; ++j) std::fill_n(a.column(j), a.rows, value);
}

Matrix to_matrix(ConstView a) {
  Matrix result(a.rows, a.cols);
  copy(a, result);
  return result;
}

Matrix transpose(ConstView a) {
  Matrix result(a.cols, a.rows);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) result(j, i) = a(i, j);
  return result;
}

Matrix identity(int n) {
  Matrix result(n, n);
  for (int i = 0; i < n; ++i) result(i, i) = 1.0;
  return result;
}

void copy_multiple(double factor, ConstView from, View to) {
  for (int j = 0; j < to.cols; ++j)
    for (int i = 0; i < to.rows; ++i) to(i, j) = factor * from(i, j);
}

void multiply_all(double factor, double* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= factor;
}

double max_abs(const double* values, int count) {
  constexpr int few = 8;
  if (count >= few) return kernels::loops().arrays.largest_size(values, count);
  double largest = 0.0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::fabs(values[i]));
  return largest;
}

double max_abs(ConstView a) {
  if (a.ld == a.rows && a.cols <= std::numeric_limits<int>::max() / std::max(a.rows, 1))
    return max_abs(a.data, a.rows * a.cols);
  double largest = 0.0;
  for (int j = 0; j < a.cols; ++j) largest = std::max(largest, max_abs(a.column(j), a.rows));
  return largest;
}

bool all_finite(const double* values, std::size_t count) { return kernels::loops().arrays.all_finite(values, count); }

}  // namespace sfdae::core
