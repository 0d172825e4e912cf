// The loops of kernels.h for vectors `Lanes`, which the file that includes this defines before.
//
// Everything here is local to that file, and nothing of the standard library is used: a template that two files compile
// for different processors would be linked only once.
// SPDX-License-Identifier: BSD-3-Clause

#include <math.h>
#include <stddef.h>

#include "linalg/kernels.h"

namespace sfdae::core::kernels {

namespace {

using V = Lanes::V;
constexpr int width = Lanes::width;

double* column(const Padded& a, int j) { return a.data + static_cast<ptrdiff_t>(j) * a.ld; }

// Rows of a group of columns, one behind the other.
struct Group {
  double* first;
  ptrdiff_t ld;
  int from, to;
};

// sums[q] = v^T c_q, q = 0..3 or 0..7.
void four_dots(const double* v, const Group& group, double* sums) {
  const auto& [c, ld, from, to] = group;
  const double *c1 = c + ld, *c2 = c + 2 * ld, *c3 = c + 3 * ld;
  V s0 = Lanes::zero(), s1 = s0, s2 = s0, s3 = s0;
  for (int i = from; i < to; i += width) {
    const V x = Lanes::load(v + i);
    s0 = Lanes::add_product(x, Lanes::load(c + i), s0);
    s1 = Lanes::add_product(x, Lanes::load(c1 + i), s1);
    s2 = Lanes::add_product(x, Lanes::load(c2 + i), s2);
    s3 = Lanes::add_product(x, Lanes::load(c3 + i), s3);
  }
  Lanes::sums(s0, s1, s2, s3, sums);
}

void eight_dots(const double* v, const Group& group, double* sums) {
  const auto& [c, ld, from, to] = group;
  const double *c1 = c + ld, *c2 = c + 2 * ld, *c3 = c + 3 * ld;
  const double *c4 = c + 4 * ld, *c5 = c + 5 * ld, *c6 = c + 6 * ld, *c7 = c + 7 * ld;
  V s0 = Lanes::zero(), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0;
  for (int i = from; i < to; i += width) {
    const V x = Lanes::load(v + i);
    s0 = Lanes::add_product(x, Lanes::load(c + i), s0);
    s1 = Lanes::add_product(x, Lanes::load(c1 + i), s1);
    s2 = Lanes::add_product(x, Lanes::load(c2 + i), s2);
    s3 = Lanes::add_product(x, Lanes::load(c3 + i), s3);
    s4 = Lanes::add_product(x, Lanes::load(c4 + i), s4);
    s5 = Lanes::add_product(x, Lanes::load(c5 + i), s5);
    s6 = Lanes::add_product(x, Lanes::load(c6 + i), s6);
    s7 = Lanes::add_product(x, Lanes::load(c7 + i), s7);
  }
  Lanes::sums(s0, s1, s2, s3, sums);
  Lanes::sums(s4, s5, s6, s7, sums + 4);
}

// c_q -= s[q] v
void subtract_from_four(const double* v, const double* s, const Group& group) {
  const auto& [c, ld, from, to] = group;
  double *c1 = c + ld, *c2 = c + 2 * ld, *c3 = c + 3 * ld;
  const V s0 = Lanes::all(s[0]), s1 = Lanes::all(s[1]), s2 = Lanes::all(s[2]), s3 = Lanes::all(s[3]);
  for (int i = from; i < to; i += width) {
    const V x = Lanes::load(v + i);
    Lanes::store(c + i, Lanes::subtract_product(x, s0, Lanes::load(c + i)));
    Lanes::store(c1 + i, Lanes::subtract_product(x, s1, Lanes::load(c1 + i)));
    Lanes::store(c2 + i, Lanes::subtract_product(x, s2, Lanes::load(c2 + i)));
    Lanes::store(c3 + i, Lanes::subtract_product(x, s3, Lanes::load(c3 + i)));
  }
}

// Columns of C := (I - tau v v^T) C, v = 0 outside of the rows given.
struct Reflection {
  const double* v;
  double tau;
  int from, to;
};

void reflect_four(const Reflection& h, double* c, ptrdiff_t ld) {
  double s[4];
  four_dots(h.v, {c, ld, h.from, h.to}, s);
  for (double& value : s) value *= h.tau;
  subtract_from_four(h.v, s, {c, ld, h.from, h.to});
}

void reflect_one(const Reflection& h, double* c) {
  V s = Lanes::zero();
  for (int i = h.from; i < h.to; i += width) s = Lanes::add_product(Lanes::load(h.v + i), Lanes::load(c + i), s);
  s = Lanes::all(h.tau * Lanes::total(s));
  for (int i = h.from; i < h.to; i += width)
    Lanes::store(c + i, Lanes::subtract_product(Lanes::load(h.v + i), s, Lanes::load(c + i)));
}

void reflect_eight(const Reflection& h, double* c, ptrdiff_t ld) {
  double s[8];
  eight_dots(h.v, {c, ld, h.from, h.to}, s);
  for (double& value : s) value *= h.tau;
  subtract_from_four(h.v, s, {c, ld, h.from, h.to});
  subtract_from_four(h.v, s + 4, {c + 4 * ld, ld, h.from, h.to});
}

// Columns first, ..., end - 1 and, if `is_padded`, up to three more.
void reflect(const Reflection& h, const Padded& c, int first, int end, bool is_padded) {
  int j = first;
  for (; j + 8 <= end || (is_padded && j + 4 < end); j += 8) reflect_eight(h, column(c, j), c.ld);
  for (; j + 4 <= end || (is_padded && j < end); j += 4) reflect_four(h, column(c, j), c.ld);
  for (; j < end; ++j) reflect_one(h, column(c, j));
}

// sums[j] = v^T c_j for j >= first, and up to three more; v = 0 above row `from`.
void all_dots(const double* v, int from, const Padded& c, int first, double* sums) {
  const int to = round_up(c.rows), end = c.cols;
  int j = first;
  for (; j + 4 < end; j += 8) eight_dots(v, {column(c, j), c.ld, from, to}, sums + j);
  if (j < end) four_dots(v, {column(c, j), c.ld, from, to}, sums + j);
}

// y += X c, X with `count` columns.
struct Combination {
  const double* X;
  ptrdiff_t ld;
  int count;
  const double* c;
};

void add_combination(const Combination& of, int from, int to, double* y) {
  int q = 0;
  for (; q + 4 <= of.count; q += 4) {
    const double* x0 = of.X + q * of.ld;
    const double *x1 = x0 + of.ld, *x2 = x1 + of.ld, *x3 = x2 + of.ld;
    const V c0 = Lanes::all(of.c[q]), c1 = Lanes::all(of.c[q + 1]);
    const V c2 = Lanes::all(of.c[q + 2]), c3 = Lanes::all(of.c[q + 3]);
    for (int i = from; i < to; i += width) {
      const V even = Lanes::add_product(Lanes::load(x2 + i), c2,
                                        Lanes::add_product(Lanes::load(x0 + i), c0, Lanes::load(y + i)));
      const V odd = Lanes::add_product(Lanes::load(x3 + i), c3, Lanes::product(Lanes::load(x1 + i), c1));
      Lanes::store(y + i, Lanes::sum(even, odd));
    }
  }
  for (; q < of.count; ++q) {
    const double* x = of.X + q * of.ld;
    const V c = Lanes::all(of.c[q]);
    for (int i = from; i < to; i += width)
      Lanes::store(y + i, Lanes::add_product(Lanes::load(x + i), c, Lanes::load(y + i)));
  }
}

// Sum of squares of the rows from `first` on; what is below `rows` is zero.
double square(const double* x, int first, int rows) {
  const int from = round_up(first), to = round_up(rows);
  V s = Lanes::zero();
  for (int i = from; i < to; i += width) s = Lanes::add_product(Lanes::load(x + i), Lanes::load(x + i), s);
  double result = Lanes::total(s);
  for (int i = first; i < from && i < rows; ++i) result += x[i] * x[i];
  return result;
}

// Copies a column and pads it; with `measured` its squared norm, else 0.
template <bool measured>
double pad_column(const double* a, int rows, double* y) {
  const int whole = rows & ~(width - 1), end = round_up(rows);
  V s = Lanes::zero();
  for (int i = 0; i < whole; i += width) {
    const V x = Lanes::load_anywhere(a + i);
    Lanes::store(y + i, x);
    if (measured) s = Lanes::add_product(x, x, s);
  }
  double sum = measured ? Lanes::total(s) : 0.0;
  for (int i = whole; i < rows; ++i) {
    y[i] = a[i];
    if (measured) sum += a[i] * a[i];
  }
  for (int i = rows; i < end; ++i) y[i] = 0.0;
  return sum;
}

void pad(const double* a, int lda, Padded to, double* squares) {
  for (int j = 0; j < to.cols; ++j, a += lda) {
    if (squares != nullptr) squares[j] = pad_column<true>(a, to.rows, column(to, j));
    else pad_column<false>(a, to.rows, column(to, j));
  }
  for (int j = to.cols; j < to.cols + spare_columns; ++j)
    for (int i = 0; i < round_up(to.rows); i += width) Lanes::store(column(to, j) + i, Lanes::zero());
}

}  // namespace

}  // namespace sfdae::core::kernels

#include "linalg/kernel_arrays.h"
#include "linalg/kernel_products.h"
#include "linalg/kernel_qr.h"

namespace sfdae::core::kernels {

namespace {

constexpr Loops made{Lanes::name,
                     {largest_size, all_finite, scale_entries, raise_sizes, subtract},
                     pad,
                     factor_columns,
                     factor_panel,
                     renew_norms,
                     apply_reflections,
                     triangular_factor,
                     Lanes::multiplies ? multiply : nullptr};

}  // namespace

}  // namespace sfdae::core::kernels
