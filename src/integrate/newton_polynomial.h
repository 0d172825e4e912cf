// Newton's interpolation polynomial p(t) = sum_i table[i] prod_{j<i} (t - times[j]) for vectors, its table of divided
// differences and its Taylor coefficients.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "linalg/divided_differences.h"
#include "linalg/index.h"

namespace sfdae::core {

// The polynomial through entries 0..degree of a table of vectors, with their first `size` components.
template <class Table, class Times>
struct NewtonPolynomial {
  NewtonPolynomial(const Table& its_table, const Times& its_times, int its_degree, std::size_t its_size)
      : table(its_table), times(its_times), degree(its_degree), size(its_size) {}

  // p(t) and, unless slope is null, p'(t).
  void evaluate(double t, double* value, double* slope) const {
    horner(t, slope != nullptr ? 1 : 0, [=](int k) { return k == 0 ? value : slope; });
  }
  // p^(k)(t) / k!, k = 0..order: size x (order + 1).
  void taylor(double t, int order, double* coefficients) const {
    horner(t, order, [=, n = size](int k) { return coefficients + n * index(k); });
  }

  const Table& table;
  const Times& times;
  int degree;
  std::size_t size;

 private:
  // Horner's scheme for coefficients 0..order; column(k): destination of coefficient k.
  template <class Column>
  void horner(double t, int order, Column column) const {
    std::copy_n(table[index(degree)].data(), size, column(0));
    for (int k = 1; k <= order; ++k) std::fill_n(column(k), size, 0.0);
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
};

// Divided differences for Hermite interpolation, which replace values and slopes: columns 2i and 2i + 1 belong to one
// node; the latter has its slope.
template <class Times, class Column>
void hermite_differences(const Times& times, int count, std::size_t size, Column column) {
  // Slopes are divided differences of order 1 already, in place of second values of their nodes.
  for (int i = (count - 1) / 2 * 2; i >= 2; i -= 2)
    take_difference(column(i), column(i - 2), times[index(i)] - times[index(i - 1)], size);
  for (int k = 2; k < count; ++k)
    for (int i = count - 1; i >= k; --i)
      take_difference(column(i), column(i - 1), times[index(i)] - times[index(i - k)], size);
}

// differences[i] := divided difference of values[0..i], which are unchanged, over times[0..i], the newest first. The
// older one is subtracted from the newer one, so that differences of constants are +0 forward in time.
template <class Times, class Values>
void differences_of_history(const Times& times, const Values& values, int count, Values& differences) {
  const std::size_t size = values[0].size();
  for (int i = 0; i < count; ++i) std::copy_n(values[index(i)].data(), size, differences[index(i)].data());
  for (int j = 1; j < count; ++j)
    for (int i = count - 1; i >= j; --i) {
      const double per_gap = 1.0 / (times[index(i - j)] - times[index(i)]);
      double* __restrict to = differences[index(i)].data();
      const double* __restrict newer = differences[index(i - 1)].data();
      for (std::size_t r = 0; r < size; ++r) to[r] = (newer[r] - to[r]) * per_gap;
    }
}

}  // namespace sfdae::core
