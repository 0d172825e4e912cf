// SPDX-License-Identifier: BSD-3-Clause
// Matrices for tests, and the measures by which tests judge them. Products are formed by plain sums: nothing here
// uses the kernels under test.
#ifndef SFDAE_TESTS_MATRIX_CHECKS_H
#define SFDAE_TESTS_MATRIX_CHECKS_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "linalg/matrix.h"
#include "random_family.h"

namespace sfdae_test {

inline constexpr double unit_roundoff = 0.5 * std::numeric_limits<double>::epsilon();

// Rounding errors of orthogonal transformations and sums of n terms of size 1, with room for a few in a row.
inline double rounding(int n) { return 100.0 * std::max(n, 1) * unit_roundoff; }

inline std::size_t size(int i) { return static_cast<std::size_t>(i); }

// Entries uniform in [-1, 1).
inline sfdae::core::Matrix random_matrix(int rows, int cols, std::uint64_t seed) {
  RandomNumbers numbers(seed);
  sfdae::core::Matrix a(rows, cols);
  for (int j = 0; j < cols; ++j)
    for (int i = 0; i < rows; ++i) a(i, j) = numbers.uniform(-1.0, 1.0);
  return a;
}

inline std::vector<double> random_vector(int n, std::uint64_t seed) {
  const sfdae::core::Matrix column = random_matrix(n, 1, seed);
  return {column.data(), column.data() + n};
}

// A B by plain sums.
inline sfdae::core::Matrix times(sfdae::core::ConstView a, sfdae::core::ConstView b) {
  sfdae::core::Matrix c(a.rows, b.cols);
  for (int j = 0; j < b.cols; ++j)
    for (int k = 0; k < a.cols; ++k) {
      double* const sum = c.view().column(j);
      const double* const column = a.column(k);
      const double factor = b(k, j);
      for (int i = 0; i < a.rows; ++i) sum[i] += column[i] * factor;
    }
  return c;
}

inline sfdae::core::Matrix transposed(sfdae::core::ConstView a) {
  sfdae::core::Matrix t(a.cols, a.rows);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) t(j, i) = a(i, j);
  return t;
}

inline sfdae::core::Matrix column(const std::vector<double>& x) {
  sfdae::core::Matrix a(static_cast<int>(x.size()), 1);
  std::copy(x.begin(), x.end(), a.data());
  return a;
}

inline std::vector<double> times(sfdae::core::ConstView a, const double* x) {
  std::vector<double> y(size(a.rows), 0.0);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) y[size(i)] += a(i, j) * x[j];
  return y;
}

// alpha A + beta B
inline sfdae::core::Matrix sum(double alpha, sfdae::core::ConstView a, double beta, sfdae::core::ConstView b) {
  sfdae::core::Matrix c(a.rows, a.cols);
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) c(i, j) = alpha * a(i, j) + beta * b(i, j);
  return c;
}

inline sfdae::core::Matrix unit_matrix(int n) {
  sfdae::core::Matrix one(n, n);
  for (int i = 0; i < n; ++i) one(i, i) = 1.0;
  return one;
}

// max |a_ij|, infinite if an entry is NaN.
inline double largest(sfdae::core::ConstView a) {
  double result = 0.0;
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) result = std::max(result, std::isnan(a(i, j)) ? INFINITY : std::fabs(a(i, j)));
  return result;
}
inline double largest(const std::vector<double>& x) {
  double result = 0.0;
  for (double value : x) result = std::max(result, std::isnan(value) ? INFINITY : std::fabs(value));
  return result;
}

inline double distance(sfdae::core::ConstView a, sfdae::core::ConstView b) {
  return a.rows == b.rows && a.cols == b.cols ? largest(sum(1.0, a, -1.0, b)) : INFINITY;
}
inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() ? distance(column(a), column(b)) : INFINITY;
}

// max |Q^T Q - I|
inline double orthonormality_defect(sfdae::core::ConstView q) {
  return distance(times(transposed(q), q), unit_matrix(q.cols));
}

// max |(I - Q Q^T) A|, Q with orthonormal columns: how far the range of A reaches out of that of Q.
inline double outside_range(sfdae::core::ConstView q, sfdae::core::ConstView a) {
  return distance(times(q, times(transposed(q), a)), a);
}

}  // namespace sfdae_test

#endif
