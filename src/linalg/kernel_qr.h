// Pivoted and plain QR factorizations in the vector loops of kernel_loops.h, which includes this.
//
// [DB08] Z. Drmac, Z. Bujanovic: On the failure of rank-revealing QR factorization software. ACM TOMS 35, 2008.
// [QSB98] G. Quintana-Orti, X. Sun, C. H. Bischof: A BLAS-3 version of the QR factorization with column pivoting.
// SIAM J.
//         Sci. Comput. 19, 1998.
// SPDX-License-Identifier: BSD-3-Clause

namespace sfdae::core::kernels {

namespace {

// An updated square that falls below this part of its old value has lost half of its digits [DB08].
constexpr double cancellation = 1e-8;
// Squares below lose digits to underflow.
constexpr double least_square = 1e-280;

// The reflection of column p where squares of its entries underflow: x becomes the vector, alpha what it maps to;
// returns tau.
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

void mark_done(const QrWork& work, int j) {
  work.norms[j] = done_norm;
  work.reference[j] = done_reference;
}

// Returns p if nothing can be compared: norms that are NaN are skipped.
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

// Brings the column of largest norm to place p. False if that is negligible: everything stays then.
bool choose_pivot(const QrWork& work, int p, int F_columns) {
  const int best = largest_norm(work, p);
  if (work.norms[best] <= work.negligible) return false;
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
  return true;
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

int factor_columns(const QrWork& work, int first, int last, int end) {
  for (int p = first; p < last; ++p) {
    if (work.pivots != nullptr && !choose_pivot(work, p, 0)) return p;
    const double tau = make_reflection(work, p);
    const Reflection h{work.v, tau, round_down(p), round_up(work.a.rows)};
    if (tau != 0.0) reflect(h, work.a, p + 1, end, end == work.a.cols);
    if (work.pivots == nullptr || p + 1 >= work.a.cols) continue;
    for (int j = p + 1; j < end; ++j) work.row[j] = column(work.a, j)[p];
    if (!update_norms(work, p)) renew_norms(work, p + 1);
  }
  return last;
}

// ---- Panels [QSB98] ---------------------------------------------------------------------------------------------

// Applies the reflections first, ..., p - 1 to column p, in the rows from p on.
void catch_up(const QrWork& work, int first, int p) {
  const int from = round_down(p), count = p - first, to = round_up(work.a.rows);
  double *x = column(work.a, p), *y = work.v;
  for (int i = from; i < to; i += width) Lanes::store(y + i, Lanes::load(x + i));
  for (int q = 0; q < count; ++q) work.coefficients[q] = -column(work.F, q)[p];
  add_combination({column(work.a, first), work.a.ld, count, work.coefficients}, from, to, y);
  // Rows above are finished. No vector is read whose parts have just been written, as that would stall.
  for (int i = from; i < from + lanes; i += width) {
    const V above = Lanes::up_to(Lanes::load(x + i), p - 1 - i), below = Lanes::behind(Lanes::load(y + i), p - 1 - i);
    Lanes::store(x + i, Lanes::sum(above, below));
  }
  for (int i = from + lanes; i < to; i += width) Lanes::store(x + i, Lanes::load(y + i));
}

// Column p - first of F: tau A^T v, corrected for the earlier reflections.
void extend_F(const QrWork& work, int first, int p, double tau) {
  const int k = p - first, cols = work.a.cols, to = round_up(work.a.rows);
  double* f = column(work.F, k);
  for (int j = round_down(first); j <= p; ++j) f[j] = 0.0;
  all_dots(work.v, round_down(p), work.a, p + 1, f);
  for (int j = p + 1; j < cols; ++j) f[j] *= tau;
  for (int j = cols; j < round_up(cols); ++j) f[j] = 0.0;
  for (int q = 0; q < k; q += 4)
    four_dots(work.v, {column(work.a, first + q), work.a.ld, round_down(p), to}, work.coefficients + q);
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
    if (!choose_pivot(work, p, k)) return k;
    if (k > 0) catch_up(work, first, p);
    const double tau = make_reflection(work, p);
    extend_F(work, first, p, tau);
    finish_row(work, first, p);
    if (!update_norms(work, p)) return k + 1;
  }
  return count;
}

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

}  // namespace

}  // namespace sfdae::core::kernels
