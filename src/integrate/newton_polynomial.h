// Newton's interpolation polynomial p(t) = sum_i table[i] prod_{j<i} (t - times[j]), for vectors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "linalg/index.h"

namespace sfdae::core {

// Taylor coefficients p^(k)(t) / k!, k = 0..order, of the polynomial of the given degree: size x (order + 1).
template <class Table, class Times>
void newton_taylor(const Table& table, const Times& times, int degree, double t, int order, std::size_t size,
                   double* coefficients) {
  const auto column = [&](int k) { return coefficients + size * index(k); };
  std::fill_n(column(0), size * index(order + 1), 0.0);
  std::copy_n(table[index(degree)].data(), size, column(0));
  for (int i = degree - 1; i >= 0; --i) {
    const double gap = t - times[index(i)];
    for (int k = std::min(order, degree - i); k > 0; --k) {
      double* __restrict to = column(k);
      const double* __restrict lower = column(k - 1);
      for (std::size_t r = 0; r < size; ++r) to[r] = to[r] * gap + lower[r];
    }
    double* __restrict value = column(0);
    const double* __restrict d = table[index(i)].data();
    for (std::size_t r = 0; r < size; ++r) value[r] = value[r] * gap + d[r];
  }
}

// Replaces values by divided differences; entries 2i and 2i + 1 belong to one node, the slope of which stands in
// the latter.
template <class Table, class Times>
void divided_differences(Table& table, const Times& times, int count, std::size_t size) {
  for (int k = 1; k < count; ++k)
    for (int i = count - 1; i >= k; --i) {
      double* __restrict to = table[index(i)].data();
      // Slopes are divided differences of order 1 already, and stand where values of their nodes would.
      if (k == 1 && i % 2 == 1) continue;
      const double* __restrict from = table[index(k == 1 ? i - 2 : i - 1)].data();
      const double per_gap = 1.0 / (times[index(i)] - times[index(i - k)]);
      for (std::size_t r = 0; r < size; ++r) to[r] = (to[r] - from[r]) * per_gap;
    }
}

}  // namespace sfdae::core
