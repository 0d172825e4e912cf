// The loops of kernels.h for vectors `Lanes`, which the file that includes this defines before.
//
// Everything here is local to that file, and nothing of the standard library is used: a template that two files compile
// for different processors would be linked only once.
//
// [DB08] Z. Drmac, Z. Bujanovic: On the failure of rank-revealing QR factorization software. ACM TOMS 35, 2008.
// [QSB98] G. Quintana-Orti, X. Sun, C. H. Bischof: A BLAS-3 version of the QR factorization with column pivoting. SIAM J.
//         Sci. Comput. 19, 1998.
// SPDX-License-Identifier: BSD-3-Clause

#include <math.h>
#include <stddef.h>

#include "linalg/kernels.h"

namespace sfdae::core::kernels {

namespace {

using V = Lanes::V;
constexpr int width = Lanes::width;

// An updated square that is left with less than this of what it was has lost half of its digits [DB08].
constexpr double cancellation = 1e-8;
// Squares below lose digits to underflow.
constexpr double least_square = 1e-280;

int round_down(int i) { return i & ~(lanes - 1); }
int round_up(int i) { return round_down(i + lanes - 1); }

double* column(const Padded& a, int j) { return a.data + static_cast<ptrdiff_t>(j) * a.ld; }

// sums[q] = v^T c_q, q = 0..3 or 0..7, c_q one column behind the other.
void four_dots(const double* v, const double* c, ptrdiff_t ld, int from, int to, double* sums) {
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

void eight_dots(const double* v, const double* c, ptrdiff_t ld, int from, int to, double* sums) {
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
void subtract_from_four(const double* v, const double* s, double* c, ptrdiff_t ld, int from, int to) {
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
  four_dots(h.v, c, ld, h.from, h.to, s);
  for (double& value : s) value *= h.tau;
  subtract_from_four(h.v, s, c, ld, h.from, h.to);
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
  eight_dots(h.v, c, ld, h.from, h.to, s);
  for (double& value : s) value *= h.tau;
  subtract_from_four(h.v, s, c, ld, h.from, h.to);
  subtract_from_four(h.v, s + 4, c + 4 * ld, ld, h.from, h.to);
}

// Columns first, ..., end - 1 and, if `is_padded`, up to three more.
void reflect(const Reflection& h, const Padded& c, int first, int end, bool is_padded) {
  int j = first;
  for (; j + 8 <= end || (is_padded && j + 4 < end); j += 8) reflect_eight(h, column(c, j), c.ld);
  for (; j + 4 <= end || (is_padded && j < end); j += 4) reflect_four(h, column(c, j), c.ld);
  for (; j < end; ++j) reflect_one(h, column(c, j));
}

// sums[j] = v^T c_j for j in [first, end), and up to three more.
void all_dots(const double* v, const Padded& c, int first, int end, int from, double* sums) {
  const int to = round_up(c.rows);
  int j = first;
  for (; j + 4 < end; j += 8) eight_dots(v, column(c, j), c.ld, from, to, sums + j);
  if (j < end) four_dots(v, column(c, j), c.ld, from, to, sums + j);
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

// (beta, tau) of the reflection that maps (alpha, x) to (beta, 0), where squares of x underflow: x *= scale is done.
double reflect_tiny(double* x, int first, int rows, double& alpha) {
  constexpr double up = 0x1p500;
  double sum = alpha * up * (alpha * up);
  bool all_zero = true;
  for (int i = first; i < rows; ++i) {
    sum += x[i] * up * (x[i] * up);
    all_zero = all_zero && x[i] == 0.0;
  }
  if (all_zero || sum < least_square) return 0.0;
  const double beta = -copysign(sqrt(sum), alpha), a = alpha * up;
  for (int i = first; i < rows; ++i) x[i] = x[i] * up / (a - beta);
  const double tau = (beta - a) / beta;
  alpha = beta / up;
  return tau;
}

// The reflection that maps column p to a multiple of e_p, in the rows from p on.
double make_reflection(const QrWork& work, int p) {
  const int rows = work.a.rows, from = round_down(p), whole = from + lanes, to = round_up(rows);
  double *x = column(work.a, p), *v = work.v;
  V squares = Lanes::zero();
  for (int i = from; i < whole; i += width) {
    const V below = Lanes::behind(Lanes::load(x + i), p - i);
    Lanes::store(v + i, below);
    squares = Lanes::add_product(below, below, squares);
  }
  for (int i = whole; i < to; i += width)
    squares = Lanes::add_product(Lanes::load(x + i), Lanes::load(x + i), squares);
  double alpha = x[p], tau = 0.0, scale = 0.0;
  const double tail = Lanes::total(squares), sum = alpha * alpha + tail;
  if (sum < least_square) {
    for (int i = whole; i < rows; ++i) v[i] = x[i];
    tau = reflect_tiny(v, p + 1, rows, alpha);
    for (int i = p + 1; i < rows; ++i) x[i] = v[i];
    scale = 1.0;
  } else if (tail > 0.0) {
    const double beta = -copysign(sqrt(sum), alpha);
    scale = 1.0 / (alpha - beta);
    tau = (beta - alpha) / beta;
    alpha = beta;
  }
  const V factor = Lanes::all(scale);
  for (int i = from; i < whole; i += width) {
    const V below = Lanes::product(Lanes::load(v + i), factor);
    Lanes::store(v + i, Lanes::with(below, p - i, 1.0));
    const V above = Lanes::load(x + i);
    Lanes::store(x + i, Lanes::with(Lanes::sum(Lanes::up_to(above, p - i), below), p - i, alpha));
  }
  for (int i = whole; i < to; i += width) {
    const V below = Lanes::product(Lanes::load(x + i), factor);
    Lanes::store(v + i, below);
    Lanes::store(x + i, below);
  }
  return work.tau[p] = tau;
}

// ---- Pivoting ---------------------------------------------------------------------------------------------------

// Columns that are done, and spare ones, are never chosen, and their updates never look as if they had lost digits.
constexpr double done_norm = -1.0;
constexpr double done_reference = -1e300;

void mark_done(const QrWork& work, int j) {
  work.norms[j] = done_norm;
  work.reference[j] = done_reference;
}

// p where nothing can be compared: norms that are NaN are passed over.
int largest_norm(const QrWork& work, int p) {
  V best = Lanes::all(done_norm);
  for (int j = round_down(p); j < round_up(work.a.cols); j += width)
    best = Lanes::larger(Lanes::load(work.norms + j), best);
  const double most = Lanes::largest(best);
  for (int j = round_down(p); j < round_up(work.a.cols); j += width) {
    const int lane = Lanes::find(Lanes::load(work.norms + j), most);
    if (lane < width) return j + lane < p || j + lane >= work.a.cols ? p : j + lane;
  }
  return p;
}

// Brings the column of largest norm to place p.
void choose_pivot(const QrWork& work, int p, int F_columns) {
  const int best = largest_norm(work, p);
  if (best != p) {
    double *x = column(work.a, p), *y = column(work.a, best);
    for (int i = 0; i < round_up(work.a.rows); i += width) {
      const V kept = Lanes::load(x + i);
      Lanes::store(x + i, Lanes::load(y + i));
      Lanes::store(y + i, kept);
    }
    const int pivot = work.pivots[best];
    work.pivots[best] = work.pivots[p];
    work.pivots[p] = pivot;
    work.norms[best] = work.norms[p];
    work.reference[best] = work.reference[p];
    for (int q = 0; q < F_columns; ++q) {
      double* f = column(work.F, q);
      const double kept = f[p];
      f[p] = f[best];
      f[best] = kept;
    }
  }
  mark_done(work, p);
}

// Squares without row p, which is in work.row; false if one of them has lost too many digits.
bool update_norms(const QrWork& work, int p) {
  V worst = Lanes::zero();
  const V part = Lanes::all(cancellation);
  for (int j = round_down(p + 1); j < round_up(work.a.cols); j += width) {
    const V r = Lanes::load(work.row + j);
    const V norm = Lanes::subtract_product(r, r, Lanes::load(work.norms + j));
    Lanes::store(work.norms + j, norm);
    worst = Lanes::smaller(worst, Lanes::subtract_product(part, Lanes::load(work.reference + j), norm));
  }
  return Lanes::smallest(worst) >= 0.0;
}

void renew_norms(const QrWork& work, int first) {
  for (int j = first; j < work.a.cols; ++j)
    if (work.norms[j] < cancellation * work.reference[j])
      work.norms[j] = work.reference[j] = square(column(work.a, j), first, work.a.rows);
}

void factor_columns(const QrWork& work, int first, int last, int end) {
  for (int p = first; p < last; ++p) {
    if (work.pivots != nullptr) choose_pivot(work, p, 0);
    const double tau = make_reflection(work, p);
    const Reflection h{work.v, tau, round_down(p), round_up(work.a.rows)};
    if (tau != 0.0) reflect(h, work.a, p + 1, end, end == work.a.cols);
    if (work.pivots == nullptr || p + 1 >= work.a.cols) continue;
    for (int j = p + 1; j < end; ++j) work.row[j] = column(work.a, j)[p];
    if (!update_norms(work, p)) renew_norms(work, p + 1);
  }
}

// ---- Panels [QSB98] ---------------------------------------------------------------------------------------------

// What the reflections first, ..., p - 1 do to column p, in the rows from p on.
void catch_up(const QrWork& work, int first, int p) {
  const int from = round_down(p), count = p - first, to = round_up(work.a.rows);
  double *x = column(work.a, p), *y = work.v;
  for (int i = from; i < to; i += width) Lanes::store(y + i, Lanes::load(x + i));
  for (int q = 0; q < count; ++q) work.coefficients[q] = -column(work.F, q)[p];
  add_combination({column(work.a, first), work.a.ld, count, work.coefficients}, from, to, y);
  // Rows above are finished. No vector is read of which parts have just been written: that would wait for them.
  for (int i = from; i < from + lanes; i += width) {
    const V above = Lanes::up_to(Lanes::load(x + i), p - 1 - i), below = Lanes::behind(Lanes::load(y + i), p - 1 - i);
    Lanes::store(x + i, Lanes::sum(above, below));
  }
  for (int i = from + lanes; i < to; i += width) Lanes::store(x + i, Lanes::load(y + i));
}

// Column p - first of F: tau A^T v, less what the reflections before have made of A.
void extend_F(const QrWork& work, int first, int p, double tau) {
  const int k = p - first, cols = work.a.cols, to = round_up(work.a.rows);
  double* f = column(work.F, k);
  for (int j = round_down(first); j <= p; ++j) f[j] = 0.0;
  all_dots(work.v, work.a, p + 1, cols, round_down(p), f);
  for (int j = p + 1; j < cols; ++j) f[j] *= tau;
  for (int j = cols; j < round_up(cols); ++j) f[j] = 0.0;
  for (int q = 0; q < k; q += 4)
    four_dots(work.v, column(work.a, first + q), work.a.ld, round_down(p), to, work.coefficients + q);
  for (int q = 0; q < k; ++q) work.coefficients[q] *= -tau;
  add_combination({work.F.data, work.F.ld, k, work.coefficients}, round_down(p + 1), round_up(cols), f);
}

// Row p of the columns behind p, which the next pivot depends on.
void finish_row(const QrWork& work, int first, int p) {
  const int count = p - first + 1, cols = work.a.cols;
  for (int j = p + 1; j < cols; ++j) work.row[j] = column(work.a, j)[p];
  for (int q = 0; q + 1 < count; ++q) work.coefficients[q] = -column(work.a, first + q)[p];
  work.coefficients[count - 1] = -1.0;
  add_combination({work.F.data, work.F.ld, count, work.coefficients}, round_down(p + 1), round_up(cols), work.row);
  for (int j = p + 1; j < cols; ++j) column(work.a, j)[p] = work.row[j];
}

int factor_panel(const QrWork& work, int first, int count) {
  for (int k = 0; k < count; ++k) {
    const int p = first + k;
    choose_pivot(work, p, k);
    if (k > 0) catch_up(work, first, p);
    const double tau = make_reflection(work, p);
    extend_F(work, first, p, tau);
    finish_row(work, first, p);
    if (!update_norms(work, p)) return k + 1;
  }
  return count;
}

// ---- Applying ---------------------------------------------------------------------------------------------------

void apply_reflections(Padded vectors, const double* tau, Order order, Padded C) {
  const int count = vectors.cols, to = round_up(vectors.rows);
  for (int step = 0; step < count; ++step) {
    const int p = order == Order::first_to_last ? step : count - 1 - step;
    const int first = order == Order::to_identity ? p : 0;
    reflect({column(vectors, p), tau[p], round_down(p), to}, C, first, C.cols, true);
  }
}

// T_i = -tau_i T_{0..i-1} S_i above the diagonal, tau_i on it.
void triangular_factor(Padded S, const double* tau, Padded T) {
  for (int i = 0; i < T.cols; ++i) {
    double *t = column(T, i), *c = column(S, i);
    for (int r = 0; r < round_up(T.rows); r += width) Lanes::store(t + r, Lanes::zero());
    for (int q = 0; q < i; ++q) c[q] *= -tau[i];
    add_combination({T.data, T.ld, i, c}, 0, round_up(i), t);
    t[i] = tau[i];
  }
}

// ---- Arrays -----------------------------------------------------------------------------------------------------

double size_of(double x) { return x < 0.0 ? -x : x; }
double larger_of(double a, double b) { return a > b ? a : b; }

double largest_size(const double* x, int count) {
  // Two maxima: one alone would wait for itself.
  V first = Lanes::zero(), second = first;
  int i = 0;
  for (; i + 2 * width <= count; i += 2 * width) {
    first = Lanes::larger(Lanes::size(Lanes::load_anywhere(x + i)), first);
    second = Lanes::larger(Lanes::size(Lanes::load_anywhere(x + i + width)), second);
  }
  double largest = Lanes::largest(Lanes::larger(first, second));
  for (; i < count; ++i) largest = larger_of(size_of(x[i]), largest);
  return largest;
}

bool all_finite(const double* x, size_t count) {
  Lanes::Carries carries = Lanes::no_carries();
  size_t i = 0;
  for (; i + width <= count; i += width) carries = Lanes::add_carries(x + i, carries);
  double last[width] = {};
  for (int k = 0; i < count; ++i, ++k) last[k] = x[i];
  return !Lanes::has_carry(Lanes::add_carries(last, carries));
}

double scale_entries(double* x, const double* factors, int count) {
  V most = Lanes::zero();
  int i = 0;
  for (; i + width <= count; i += width) {
    const V scaled = Lanes::product(Lanes::load_anywhere(x + i), Lanes::load_anywhere(factors + i));
    Lanes::store_anywhere(x + i, scaled);
    most = Lanes::larger(Lanes::size(scaled), most);
  }
  double largest = Lanes::largest(most);
  for (; i < count; ++i) {
    x[i] *= factors[i];
    largest = larger_of(size_of(x[i]), largest);
  }
  return largest;
}

void raise_sizes(const double* x, double unit, int count, double* sizes) {
  const V units = Lanes::all(unit);
  int i = 0;
  for (; i + width <= count; i += width) {
    const V size = Lanes::product(units, Lanes::size(Lanes::load_anywhere(x + i)));
    Lanes::store_anywhere(sizes + i, Lanes::larger(size, Lanes::load_anywhere(sizes + i)));
  }
  for (; i < count; ++i) sizes[i] = larger_of(unit * size_of(x[i]), sizes[i]);
}

constexpr Loops made{Lanes::name,
                     {largest_size, all_finite, scale_entries, raise_sizes},
                     pad,
                     factor_columns,
                     factor_panel,
                     renew_norms,
                     apply_reflections,
                     triangular_factor};

}  // namespace

}  // namespace sfdae::core::kernels
