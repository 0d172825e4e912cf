// Dense linear algebra on lanes: the same small systems at several points. A matrix is stored by rows.
//
// Pivots are common to all points. They are refused if they are not good for one of them: that point has to be treated
// alone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/lanes.h"
#include "linalg/matrix.h"

namespace sfdae::core::lane_algebra {

// P A = L U, its row i is row order[i] of the stored A.
struct Factors {
  int n;
  Lanes* A;
  Lanes* inverse;  // of the pivots
  int* order;
};

inline void set_abs(const Lanes& value, Lanes& result) { result = value < 0.0 ? -value : value; }

// The largest (|value_k| - noise_k) factor_k at any point, zero if none is positive.
inline double largest_above_noise(const Lanes* values, int count, const double* noise, const double* factors) {
  Lanes most{};
  for (int k = 0; k < count; ++k) {
    Lanes size;
    set_abs(values[k], size);
    size = (size - noise[k]) * factors[k];
    most = size > most ? size : most;
  }
  double largest = most[0];
  for (int l = 1; l < lane_count; ++l) largest = most[l] > largest ? most[l] : largest;
  return largest;
}

// False: no pivot of some column is good for all points.
inline bool choose_pivot(const Factors& lu, int p) {
  // A diagonal that is hardly less than the largest entry avoids the search; with less than a hundredth of it rounding
  // errors would grow.
  constexpr double good = 0.25, least = 0.01;
  const int n = lu.n;
  Lanes most, own, diagonal;
  set_abs(lu.A[lu.order[p] * n + p], diagonal);
  most = diagonal;
  for (int i = p + 1; i < n; ++i) {
    set_abs(lu.A[lu.order[i] * n + p], own);
    most = own > most ? own : most;
  }
  if (all(diagonal >= good * most)) return all(diagonal > 0.0);
  int best = p;
  double best_value = smallest(diagonal);
  for (int i = p + 1; i < n; ++i) {
    set_abs(lu.A[lu.order[i] * n + p], own);
    if (!(smallest(own) > best_value)) continue;
    best = i;
    best_value = smallest(own);
  }
  const int row = lu.order[best];
  lu.order[best] = lu.order[p];
  lu.order[p] = row;
  set_abs(lu.A[row * n + p], own);
  return all(own >= least * most) && all(own > 0.0);
}

// smallest_pivot, sign of the determinant: of each point.
inline bool factor(const Factors& lu, Lanes& smallest_pivot, Lanes& sign) {
  const int n = lu.n;
  smallest_pivot = Lanes{} + 1.0;
  sign = Lanes{} + 1.0;
  for (int i = 0; i < n; ++i) lu.order[i] = i;
  for (int p = 0; p < n; ++p) {
    const int before = lu.order[p];
    if (!choose_pivot(lu, p)) return false;
    if (lu.order[p] != before) sign = -sign;
    const Lanes* const row = lu.A + lu.order[p] * n;
    const Lanes pivot = row[p], inverse = 1.0 / pivot;
    Lanes size;
    set_abs(pivot, size);
    smallest_pivot = size < smallest_pivot ? size : smallest_pivot;
    sign = pivot < 0.0 ? -sign : sign;
    lu.inverse[p] = inverse;
    for (int i = p + 1; i < n; ++i) {
      Lanes* const to = lu.A + lu.order[i] * n;
      const Lanes multiplier = to[p] * inverse;
      to[p] = multiplier;
      for (int j = p + 1; j < n; ++j) to[j] -= multiplier * row[j];
    }
  }
  return true;
}

// x := A^-1 b, `columns` right-hand sides, row by row.
inline void solve(const Factors& lu, const Lanes* b, int columns, Lanes* x) {
  const int n = lu.n;
  for (int i = 0; i < n; ++i) {
    const Lanes* const row = lu.A + lu.order[i] * n;
    for (int c = 0; c < columns; ++c) {
      Lanes sum = b[lu.order[i] * columns + c];
      for (int j = 0; j < i; ++j) sum -= row[j] * x[j * columns + c];
      x[i * columns + c] = sum;
    }
  }
  for (int i = n - 1; i >= 0; --i) {
    const Lanes* const row = lu.A + lu.order[i] * n;
    for (int c = 0; c < columns; ++c) {
      Lanes sum = x[i * columns + c];
      for (int j = i + 1; j < n; ++j) sum -= row[j] * x[j * columns + c];
      x[i * columns + c] = sum * lu.inverse[i];
    }
  }
}

// x := A^-T b; b is overwritten.
inline void solve_transposed(const Factors& lu, Lanes* b, Lanes* x) {
  const int n = lu.n;
  for (int i = 0; i < n; ++i) {
    const Lanes* const row = lu.A + lu.order[i] * n;
    b[i] *= lu.inverse[i];
    for (int j = i + 1; j < n; ++j) b[j] -= row[j] * b[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    const Lanes* const row = lu.A + lu.order[i] * n;
    for (int j = 0; j < i; ++j) b[j] -= row[j] * b[i];
    x[lu.order[i]] = b[i];
  }
}

// A = L D L^T with the lower half of A given, d: inverses of D. False if A is not positive definite somewhere.
inline bool factor_symmetric(int n, Lanes* A, Lanes* d) {
  for (int k = 0; k < n; ++k) {
    const Lanes pivot = A[k * n + k];
    if (!all(pivot > 0.0)) return false;
    d[k] = 1.0 / pivot;
    for (int i = k + 1; i < n; ++i) {
      const Lanes multiplier = A[i * n + k] * d[k];
      for (int j = k + 1; j <= i; ++j) A[i * n + j] -= multiplier * A[j * n + k];
    }
    for (int i = k + 1; i < n; ++i) A[i * n + k] *= d[k];
  }
  return true;
}

inline void solve_symmetric(int n, const Lanes* A, const Lanes* d, Lanes* b) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) b[i] -= A[i * n + j] * b[j];
  for (int i = 0; i < n; ++i) b[i] *= d[i];
  for (int i = n - 1; i >= 0; --i)
    for (int j = i + 1; j < n; ++j) b[i] -= A[j * n + i] * b[j];
}

// A matrix of numbers, the same at all points: entry (i, j) at data[i row + j column].
struct Numbers {
  const double* data;
  int rows, columns;
  std::ptrdiff_t row, column;
};
inline Numbers plain(ConstView A) { return {A.data, A.rows, A.cols, 1, A.ld}; }
inline Numbers transposed(ConstView A) { return {A.data, A.cols, A.rows, A.ld, 1}; }

// y += sign A x; four rows at a time, so that an entry of x is read once for them.
inline void add_product(double sign, const Numbers& A, const Lanes* x, Lanes* y) {
  int i = 0;
  for (; i + 4 <= A.rows; i += 4) {
    const double* a = A.data + i * A.row;
    Lanes s0{}, s1{}, s2{}, s3{};
    for (int j = 0; j < A.columns; ++j, a += A.column) {
      s0 += a[0] * x[j];
      s1 += a[A.row] * x[j];
      s2 += a[2 * A.row] * x[j];
      s3 += a[3 * A.row] * x[j];
    }
    y[i] += sign * s0;
    y[i + 1] += sign * s1;
    y[i + 2] += sign * s2;
    y[i + 3] += sign * s3;
  }
  for (; i < A.rows; ++i) {
    const double* a = A.data + i * A.row;
    Lanes sum{};
    for (int j = 0; j < A.columns; ++j, a += A.column) sum += *a * x[j];
    y[i] += sign * sum;
  }
}

// c := (I - tau v v^T) c, v_0 = 1, for `count` entries.
inline void reflect(const double* v, double tau, int count, Lanes* c) {
  if (tau == 0.0) return;
  Lanes sum = c[0], other{};
  int i = 1;
  for (; i + 2 <= count; i += 2) {
    sum += v[i] * c[i];
    other += v[i + 1] * c[i + 1];
  }
  if (i < count) sum += v[i] * c[i];
  sum = tau * (sum + other);
  c[0] -= sum;
  for (i = 1; i < count; ++i) c[i] -= v[i] * sum;
}

// c := Q^T c or Q c, Q from the first count reflections of a factorization (dense.h).
inline void apply_q_transposed(ConstView factors, int count, const double* tau, Lanes* c) {
  for (int p = 0; p < count; ++p) reflect(&factors(p, p), tau[p], factors.rows - p, c + p);
}
inline void apply_q(ConstView factors, int count, const double* tau, Lanes* c) {
  for (int p = count - 1; p >= 0; --p) reflect(&factors(p, p), tau[p], factors.rows - p, c + p);
}

// b := R^-1 b or R^-T b, R the upper triangle of order `order` in r.
inline void solve_upper(ConstView r, int order, Lanes* b) {
  for (int j = order - 1; j >= 0; --j) {
    b[j] = b[j] / r(j, j);
    for (int i = 0; i < j; ++i) b[i] -= r(i, j) * b[j];
  }
}
inline void solve_upper_transposed(ConstView r, int order, Lanes* b) {
  for (int j = 0; j < order; ++j) {
    Lanes sum = b[j];
    for (int i = 0; i < j; ++i) sum -= r(i, j) * b[i];
    b[j] = sum / r(j, j);
  }
}

}  // namespace sfdae::core::lane_algebra
