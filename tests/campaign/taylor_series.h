// Truncated Taylor series c[k] = f^(k)(s) / k! and matrices of them: exact derivatives of products by Leibniz' rule.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "dense_matrix.h"

namespace campaign {

inline constexpr int highest_taylor_order = 8;

using TaylorSeries = std::array<double, highest_taylor_order + 1>;
using TaylorMatrix = MatrixOf<TaylorSeries>;

inline double& coefficient(TaylorSeries& series, int k) { return series[static_cast<std::size_t>(k)]; }
inline double coefficient(const TaylorSeries& series, int k) { return series[static_cast<std::size_t>(k)]; }

// sum += factor * a * b up to the order given.
inline void add_product(TaylorSeries& sum, const TaylorSeries& a, const TaylorSeries& b, int order) {
  for (int i = 0; i <= order; ++i) {
    const double a_i = coefficient(a, i);
    if (a_i == 0.0) continue;
    for (int k = i; k <= order; ++k) coefficient(sum, k) += a_i * coefficient(b, k - i);
  }
}

inline void add_multiple(TaylorSeries& sum, double factor, const TaylorSeries& a, int order) {
  for (int k = 0; k <= order; ++k) coefficient(sum, k) += factor * coefficient(a, k);
}

// amplitude * sin(frequency * s + phase).
inline TaylorSeries sine(double amplitude, double frequency, double phase, double s) {
  const double angle = frequency * s + phase;
  const double sine = std::sin(angle), cosine = std::cos(angle);
  TaylorSeries result{};
  double scale = amplitude;
  for (int k = 0; k <= highest_taylor_order; ++k) {
    const double derivative = k % 2 == 0 ? sine : cosine;
    coefficient(result, k) = (k % 4 < 2 ? scale : -scale) * derivative;
    scale *= frequency / (k + 1);
  }
  return result;
}

// The polynomial sum c[k] s^k, seen from s.
inline TaylorSeries polynomial(const std::array<double, 4>& c, double s) {
  TaylorSeries result{};
  coefficient(result, 0) = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
  coefficient(result, 1) = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]);
  coefficient(result, 2) = c[2] + s * 3.0 * c[3];
  coefficient(result, 3) = c[3];
  return result;
}

// The derivative, of one order less.
inline TaylorSeries derivative(const TaylorSeries& series) {
  TaylorSeries result{};
  for (int k = 0; k < highest_taylor_order; ++k) coefficient(result, k) = (k + 1) * coefficient(series, k + 1);
  return result;
}

}  // namespace campaign
