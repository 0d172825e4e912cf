// Small dense matrices of the generators, column-major.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "random_numbers.h"

namespace campaign {

template <class Entry>
struct MatrixOf {
  int rows = 0, columns = 0;
  std::vector<Entry> entries;

  MatrixOf() = default;
  MatrixOf(int m, int n) : rows(m), columns(n), entries(static_cast<std::size_t>(m) * static_cast<std::size_t>(n)) {}
  Entry& operator()(int i, int j) { return entries[index(i, j)]; }
  const Entry& operator()(int i, int j) const { return entries[index(i, j)]; }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(rows);
  }
};

using DenseMatrix = MatrixOf<double>;

inline DenseMatrix identity(int n) {
  DenseMatrix result(n, n);
  for (int i = 0; i < n; ++i) result(i, i) = 1.0;
  return result;
}

inline DenseMatrix product(const DenseMatrix& a, const DenseMatrix& b) {
  DenseMatrix result(a.rows, b.columns);
  for (int j = 0; j < b.columns; ++j)
    for (int k = 0; k < a.columns; ++k)
      for (int i = 0; i < a.rows; ++i) result(i, j) += a(i, k) * b(k, j);
  return result;
}

// A product of n reflections at random hyperplanes.
inline DenseMatrix random_orthogonal(int n, RandomNumbers& random) {
  DenseMatrix result = identity(n);
  std::vector<double> normal(static_cast<std::size_t>(n)), image(static_cast<std::size_t>(n));
  for (int reflection = 0; reflection < n; ++reflection) {
    double square = 0.0;
    for (double& entry : normal) {
      entry = random.normal();
      square += entry * entry;
    }
    for (int j = 0; j < n; ++j) {
      double along = 0.0;
      for (int i = 0; i < n; ++i) along += normal[static_cast<std::size_t>(i)] * result(i, j);
      for (int i = 0; i < n; ++i) result(i, j) -= 2.0 * along / square * normal[static_cast<std::size_t>(i)];
    }
  }
  return result;
}

}  // namespace campaign
