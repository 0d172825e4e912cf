// Estimate of |A^-1|, the 1-norm, from a few solutions.
//
// [H88] N. J. Higham: FORTRAN codes for estimating the one-norm of a real or complex matrix, with applications to
// condition
//       estimation. ACM Trans. Math. Software 14 (1988), 381-396, algorithm 4.1.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "linalg/index.h"

namespace sfdae::core {

namespace condition {

inline double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }
inline std::complex<double> sign(std::complex<double> x) {
  const double size = std::abs(x);
  return size > 0.0 ? x / size : 1.0;
}
inline double conjugate(double x) { return x; }
inline std::complex<double> conjugate(std::complex<double> x) { return std::conj(x); }

template <class Number>
double sum_of_sizes(const std::vector<Number>& x) {
  double sum = 0.0;
  for (const Number& value : x) sum += std::abs(value);
  return sum;
}

template <class Number>
std::size_t largest_entry(const std::vector<Number>& x) {
  std::size_t largest = 0;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (std::abs(x[i]) > std::abs(x[largest])) largest = i;
  return largest;
}

// Estimate with an alternating vector, for cases in which the signs are hard to find.
template <class Number>
double alternating_estimate(std::vector<Number>& x, auto&& solve) {
  const double n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = (i % 2 == 0 ? 1.0 : -1.0) * (1.0 + static_cast<double>(i) / (n - 1.0));
  solve(x.data());
  return 2.0 * sum_of_sizes(x) / (3.0 * n);
}

}  // namespace condition

// solve(x): x := A^-1 x; solve_transposed(x): x := A^-T x, not conjugated; size >= 1.
template <class Number>
double estimate_inverse_norm(int size, auto&& solve, auto&& solve_transposed) {
  constexpr int most_steps = 5;  // [H88]: more are needed almost never
  std::vector<Number> x(index(size), Number(1.0 / size));
  solve(x.data());
  double estimate = condition::sum_of_sizes(x);
  if (size == 1) return estimate;
  std::size_t previous = x.size();
  for (int step = 1; step < most_steps; ++step) {
    // x := A^-H sign(x), a subgradient: its largest entry names the column of A^-1 to be taken next.
    for (Number& value : x) value = condition::conjugate(condition::sign(value));
    solve_transposed(x.data());
    const std::size_t column = condition::largest_entry(x);
    if (column == previous) break;
    previous = column;
    std::fill(x.begin(), x.end(), Number(0));
    x[column] = Number(1);
    solve(x.data());
    const double next = condition::sum_of_sizes(x);
    if (!(next > estimate)) break;
    estimate = next;
  }
  const double alternating = condition::alternating_estimate(x, solve);
  return alternating > estimate ? alternating : estimate;
}

}  // namespace sfdae::core
