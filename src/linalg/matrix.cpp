// Column-major matrices: copying, norms, finiteness.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/matrix.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

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

double max_abs(const double* values, int count) {
  // Independent maxima: one alone would wait for itself.
  double m0 = 0.0, m1 = 0.0, m2 = 0.0, m3 = 0.0;
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    m0 = std::max(m0, std::fabs(values[i]));
    m1 = std::max(m1, std::fabs(values[i + 1]));
    m2 = std::max(m2, std::fabs(values[i + 2]));
    m3 = std::max(m3, std::fabs(values[i + 3]));
  }
  for (; i < count; ++i) m0 = std::max(m0, std::fabs(values[i]));
  return std::max(std::max(m0, m1), std::max(m2, m3));
}

double max_abs(ConstView a) {
  double largest = 0.0;
  for (int j = 0; j < a.cols; ++j) largest = std::max(largest, max_abs(a.column(j), a.rows));
  return largest;
}

bool all_finite(const double* values, std::size_t count) {
  // An exponent of all ones carries into the sign bit when one is added to it.
  constexpr std::uint64_t exponent = 0x7ff0000000000000u;
  constexpr std::uint64_t one = 0x0010000000000000u;
  std::uint64_t carries = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, values + i, sizeof bits);
    carries |= (bits & exponent) + one;
  }
  return (carries >> 63) == 0;
}

}  // namespace sfdae::core
