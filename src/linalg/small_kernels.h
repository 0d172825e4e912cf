// Hand-written loops for small matrices: inner loops run down columns, so compilers vectorize them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "linalg/matrix.h"

namespace sfdae::core::small {

// y += s x
inline void add_scaled(int count, double s, const double* __restrict x, double* __restrict y) {
  for (int i = 0; i < count; ++i) y[i] += s * x[i];
}

inline double dot(int count, const double* __restrict x, const double* __restrict y) {
  double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    s0 += x[i] * y[i];
    s1 += x[i + 1] * y[i + 1];
    s2 += x[i + 2] * y[i + 2];
    s3 += x[i + 3] * y[i + 3];
  }
  for (; i < count; ++i) s0 += x[i] * y[i];
  return (s0 + s1) + (s2 + s3);
}

// C += alpha A op(B) for a number of rows known to the compiler: a column of C stays in registers.
template <int rows, class Entry>
inline void multiply_short_columns(double alpha, ConstView a, View c, Entry b) {
  for (int j = 0; j < c.cols; ++j) {
    double sum[rows] = {};
    for (int k = 0; k < a.cols; ++k) {
      const double s = b(k, j);
      const double* x = a.column(k);
      for (int i = 0; i < rows; ++i) sum[i] += s * x[i];
    }
    double* y = c.column(j);
    for (int i = 0; i < rows; ++i) y[i] += alpha * sum[i];
  }
}

// C += alpha A op(B); four columns of A at a time, so that a column of C is read and written less often.
template <class Entry>
inline void multiply_columns(double alpha, ConstView a, View c, Entry b) {
  switch (c.rows) {
    case 1: return multiply_short_columns<1>(alpha, a, c, b);
    case 2: return multiply_short_columns<2>(alpha, a, c, b);
    case 3: return multiply_short_columns<3>(alpha, a, c, b);
    case 4: return multiply_short_columns<4>(alpha, a, c, b);
    case 6: return multiply_short_columns<6>(alpha, a, c, b);
    case 8: return multiply_short_columns<8>(alpha, a, c, b);
    default: break;
  }
  for (int j = 0; j < c.cols; ++j) {
    double* __restrict y = c.column(j);
    int k = 0;
    for (; k + 4 <= a.cols; k += 4) {
      const double s0 = alpha * b(k, j), s1 = alpha * b(k + 1, j), s2 = alpha * b(k + 2, j), s3 = alpha * b(k + 3, j);
      const double* __restrict x0 = a.column(k);
      const double* __restrict x1 = a.column(k + 1);
      const double* __restrict x2 = a.column(k + 2);
      const double* __restrict x3 = a.column(k + 3);
      for (int i = 0; i < c.rows; ++i) y[i] += (s0 * x0[i] + s1 * x1[i]) + (s2 * x2[i] + s3 * x3[i]);
    }
    for (; k < a.cols; ++k) add_scaled(c.rows, alpha * b(k, j), a.column(k), y);
  }
}

// C += alpha A^T B
inline void multiply_transposed(double alpha, ConstView a, ConstView b, View c) {
  for (int j = 0; j < c.cols; ++j)
    for (int i = 0; i < c.rows; ++i) c(i, j) += alpha * dot(a.rows, a.column(i), b.column(j));
}

// Householder reflection I - tau v v^T with v_0 = 1 that maps x to (beta, 0, ..., 0); x becomes (beta, v_1, ...).
inline double reflector(int count, double* x) {
  const double tail = dot(count - 1, x + 1, x + 1);
  if (tail == 0.0) return 0.0;
  const double norm = std::sqrt(x[0] * x[0] + tail);
  const double beta = x[0] > 0.0 ? -norm : norm;
  const double scale = 1.0 / (x[0] - beta);
  const double tau = (beta - x[0]) / beta;
  for (int i = 1; i < count; ++i) x[i] *= scale;
  x[0] = beta;
  return tau;
}

// C := (I - tau v v^T) C, v_0 = 1.
inline void apply_reflector(const double* v, double tau, View c) {
  if (tau == 0.0) return;
  for (int j = 0; j < c.cols; ++j) {
    double* column = c.column(j);
    const double s = tau * (column[0] + dot(c.rows - 1, v + 1, column + 1));
    column[0] -= s;
    add_scaled(c.rows - 1, -s, v + 1, column + 1);
  }
}

inline void factor_qr(View a, double* tau) {
  const int steps = std::min(a.rows, a.cols);
  for (int p = 0; p < steps; ++p) {
    tau[p] = reflector(a.rows - p, &a(p, p));
    if (p + 1 < a.cols) apply_reflector(&a(p, p), tau[p], a.block(p, p + 1, a.rows - p, a.cols - p - 1));
  }
}

// norms: workspace of 2 a.cols, squared norms of the remaining columns at the end. Ends when none of them is above
// `negligible`; returns the number of reflections.
struct Pivoting {
  int* pivots;
  double* tau;
  double* norms;
  double negligible;
};
inline int factor_qr_pivoted(View a, const Pivoting& to) {
  const auto& [pivots, tau, norms, negligible] = to;
  double* reference = norms + a.cols;
  for (int j = 0; j < a.cols; ++j) {
    pivots[j] = j;
    norms[j] = reference[j] = dot(a.rows, a.column(j), a.column(j));
  }
  const int steps = std::min(a.rows, a.cols);
  for (int p = 0; p < steps; ++p) {
    const int best = static_cast<int>(std::max_element(norms + p, norms + a.cols) - norms);
    if (norms[best] <= negligible) return p;
    if (best != p) {
      std::swap(pivots[best], pivots[p]);
      std::swap_ranges(a.column(best), a.column(best) + a.rows, a.column(p));
      norms[best] = norms[p];
      reference[best] = reference[p];
    }
    tau[p] = reflector(a.rows - p, &a(p, p));
    if (p + 1 == a.cols) break;
    apply_reflector(&a(p, p), tau[p], a.block(p, p + 1, a.rows - p, a.cols - p - 1));
    // Squared norms of the remaining columns, updated; recomputed when cancellation has lost half of the digits.
    for (int j = p + 1; j < a.cols; ++j) {
      norms[j] -= a(p, j) * a(p, j);
      if (norms[j] < 1e-8 * reference[j])
        norms[j] = reference[j] = p + 1 < a.rows ? dot(a.rows - p - 1, &a(p + 1, j), &a(p + 1, j)) : 0.0;
    }
  }
  return steps;
}

inline bool factor_lu(View a, int* pivots) {
  for (int k = 0; k < a.cols; ++k) {
    double* x = a.column(k);
    int best = k;
    for (int i = k + 1; i < a.rows; ++i)
      if (std::fabs(x[i]) > std::fabs(x[best])) best = i;
    pivots[k] = best + 1;
    if (x[best] == 0.0) return false;
    if (best != k)
      for (int j = 0; j < a.cols; ++j) std::swap(a(k, j), a(best, j));
    const double scale = 1.0 / x[k];
    for (int i = k + 1; i < a.rows; ++i) x[i] *= scale;
    for (int j = k + 1; j < a.cols; ++j) add_scaled(a.rows - k - 1, -a(k, j), x + k + 1, &a(k, j) + 1);
  }
  return true;
}

// Complex product without the checks for infinite parts.
inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

inline std::complex<double> quotient(std::complex<double> a, std::complex<double> b) {
  const double square = b.real() * b.real() + b.imag() * b.imag();
  const bool in_range = square > 1e-290 && square < 1e290;  // as are c and the quotient by it, with all digits
  if (!in_range) return a / b;
  const std::complex<double> c = product(a, std::conj(b));
  return {c.real() / square, c.imag() / square};
}

inline bool factor_lu(ComplexView a, int* pivots) {
  const auto size = [](std::complex<double> z) { return std::fabs(z.real()) + std::fabs(z.imag()); };
  for (int k = 0; k < a.cols; ++k) {
    std::complex<double>* x = a.column(k);
    int best = k;
    for (int i = k + 1; i < a.rows; ++i)
      if (size(x[i]) > size(x[best])) best = i;
    pivots[k] = best + 1;
    if (x[best] == 0.0) return false;
    if (best != k)
      for (int j = 0; j < a.cols; ++j) std::swap(a(k, j), a(best, j));
    for (int i = k + 1; i < a.rows; ++i) x[i] = quotient(x[i], x[k]);
    for (int j = k + 1; j < a.cols; ++j)
      for (int i = k + 1; i < a.rows; ++i) a(i, j) -= product(x[i], a(k, j));
  }
  return true;
}

inline void solve_lu(ComplexView lu, const int* pivots, std::complex<double>* x) {
  const int order = lu.cols;
  for (int k = 0; k < order; ++k) std::swap(x[k], x[pivots[k] - 1]);
  for (int k = 0; k < order; ++k)
    for (int i = k + 1; i < order; ++i) x[i] -= product(lu(i, k), x[k]);
  for (int k = order - 1; k >= 0; --k) {
    x[k] = quotient(x[k], lu(k, k));
    for (int i = 0; i < k; ++i) x[i] -= product(lu(i, k), x[k]);
  }
}

// y := alpha A x + beta y for few entries of A.
inline void multiply_few(double alpha, ConstView a, const double* x, double beta, double* y) {
  for (int i = 0; i < a.rows; ++i) {
    double sum = 0.0;
    for (int k = 0; k < a.cols; ++k) sum += a(i, k) * x[k];
    y[i] = beta == 0.0 ? alpha * sum : alpha * sum + beta * y[i];
  }
}

// A := A^-1 by Gauss-Jordan elimination with pivoting, for well-conditioned matrices; the pivots are returned, and
// the exchanges of rows (counted from 0). False if a pivot vanishes, or products of its inverse would overflow.
inline bool invert(View a, double* pivots, int* exchanges) {
  constexpr double smallest_pivot = 1e-150;
  const int n = a.cols;
  for (int k = 0; k < n; ++k) {
    double* x = a.column(k);
    int best = k;
    for (int i = k + 1; i < n; ++i)
      if (std::fabs(x[i]) > std::fabs(x[best])) best = i;
    exchanges[k] = best;
    pivots[k] = x[best];
    if (std::isless(std::fabs(x[best]), smallest_pivot)) return false;
    if (best != k)
      for (int j = 0; j < n; ++j) std::swap(a(k, j), a(best, j));
    const double inverse = 1.0 / x[k];
    for (int j = 0; j < n; ++j) {
      if (j == k) continue;
      double* y = a.column(j);
      const double s = y[k] * inverse;
      add_scaled(n, -s, x, y);
      y[k] = s;
    }
    for (int i = 0; i < n; ++i) x[i] *= -inverse;
    x[k] = inverse;
  }
  for (int k = n - 1; k >= 0; --k)
    if (exchanges[k] != k) std::swap_ranges(a.column(k), a.column(k) + n, a.column(exchanges[k]));
  return true;
}

}  // namespace sfdae::core::small
