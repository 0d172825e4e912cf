// QR factorizations: small loops, vector loops up to medium sizes, blocks of reflections.
//
// A block of reflections is I - V T V^T with V their vectors and T upper triangular [SVL89]. LAPACK's pivoted
// factorization is unblocked below 128 columns, and its blocks cost more than they save up to 100
// (docs/design/kernels.md).
//
// [SVL89] R. Schreiber, C. Van Loan: A storage-efficient WY representation for products of Householder transformations.
//         SIAM J. Sci. Stat. Comput. 10, 1989.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/kernels_in_use.h"
#include "linalg/small_kernels.h"

namespace sfdae::core {

namespace {

using kernels::lanes;
using kernels::Order;
using kernels::Padded;
using kernels::round_up;

// Measured crossovers, docs/design/kernels.md.
// Up to this many rows plain loops are fastest.
constexpr int tiny_rows = 12;
// Fewer columns do not pay for blocks of up to most_at_once reflections, nor, with few rows, for vectors.
constexpr int few_columns = 8;
constexpr int most_at_once = 16;
// Reflections in a panel of a pivoted factorization, where the first pass over the matrix is as long as all others
// together.
constexpr int panel = 8;
// A smaller remainder of a pivoted factorization does not pay for a panel.
constexpr int unblocked = 40;

// Reflections in a block; fewer pay where small products are fast (docs/design/kernels.md).
int block_for(int rows) {
  constexpr int most_rows_of_small_blocks = 128;
  return rows <= most_rows_of_small_blocks && kernels::loops().multiply != nullptr ? 8 : 16;
}

int leading_dimension(int rows) {
  const int rounded = std::max(round_up(rows), lanes);
  return rounded % 64 == 0 ? rounded + lanes : rounded;  // powers of two alias in the cache
}

Padded padded(int rows, int cols, Arena& arena) {
  const int ld = leading_dimension(rows);
  return {arena.take(index(ld) * index(cols + kernels::spare_columns)), ld, rows, cols};
}

View view(const Padded& a) { return {a.data, a.rows, a.cols, a.ld}; }

kernels::QrWork work_for(ConstView a, double* tau, Arena& arena) {
  const int length = round_up(a.cols) + kernels::spare_columns;
  kernels::QrWork work{};
  work.a = padded(a.rows, a.cols, arena);
  work.v = arena.take(index(work.a.ld));
  work.row = arena.zeros(index(length));
  work.tau = tau;
  return work;
}

void add_pivoting(kernels::QrWork& work, int* pivots, Arena& arena) {
  const int cols = work.a.cols, length = round_up(cols) + kernels::spare_columns;
  work.pivots = pivots;
  for (int j = 0; j < cols; ++j) pivots[j] = j;
  work.norms = arena.take(index(length));
  work.reference = arena.take(index(length));
  std::fill(work.norms + cols, work.norms + length, kernels::done_norm);
  std::fill(work.reference + cols, work.reference + length, kernels::done_reference);
  work.F = {arena.take(index(length) * index(panel)), length, cols, panel};
  work.coefficients = arena.take(index(panel + kernels::spare_columns));
}

// Largest length, given the squares.
double largest_length(const double* squares, int count) {
  return count > 0 ? std::sqrt(std::max(*std::max_element(squares, squares + count), 0.0)) : 0.0;
}

// C -= V F^T
void subtract_product(ConstView V, ConstView F, View C) { multiply(-1.0, Op::plain, V, Op::transposed, F, 1.0, C); }

// Reflections first, ..., first + count - 1 of a factorization.
struct Reflections {
  ConstView factors;
  const double* tau;
  int first, count;
};

// A block of reflections, in the rows from `first` on.
struct Block {
  View V;   // with zeros and ones
  View Yt;  // T V^T, or T^T V^T for the transposed block, which is I - V Yt
};

Block make_block(const Reflections& of, Op op, Arena& arena) {
  const auto& [factors, tau, first, count] = of;
  const int rows = factors.rows - first;
  const Padded V = padded(rows, count, arena), Yt = padded(count, rows, arena);
  const Arena::Frame frame(arena);
  const Padded S = padded(count, count, arena), T = padded(count, count, arena);
  for (int q = 0; q < count; ++q) {
    double* to = view(V).column(q);
    std::fill_n(to, q, 0.0);
    to[q] = 1.0;
    std::copy_n(&factors(first, first + q) + q + 1, rows - q - 1, to + q + 1);
  }
  for (int q = 0; q < count; ++q) std::fill(view(S).column(q) + count, view(S).column(q) + S.ld, 0.0);
  multiply(1.0, Op::transposed, view(V), Op::plain, view(V), 0.0, view(S));
  kernels::loops().triangular_factor(S, tau + first, T);
  multiply(1.0, op, view(T), Op::transposed, view(V), 0.0, view(Yt));
  return {view(V), view(Yt)};
}

void apply_block(const Block& of, View C, Arena& arena) {
  const Arena::Frame frame(arena);
  const View W = arena.matrix(of.V.cols, C.cols);
  multiply(1.0, Op::plain, of.Yt, Op::plain, C, 0.0, W);
  multiply(-1.0, Op::plain, of.V, Op::plain, W, 1.0, C);
}

// One reflection after the other.
void apply_unblocked(Order order, const Reflections& of, View C, Arena& arena) {
  const int count = of.count;
  const Arena::Frame frame(arena);
  const Padded V = padded(C.rows, count, arena), work = padded(C.rows, C.cols, arena);
  kernels::loops().pad(of.factors.data, of.factors.ld, V, nullptr);
  for (int q = 0; q < count; ++q) {
    std::fill_n(view(V).column(q), q, 0.0);
    view(V)(q, q) = 1.0;
  }
  kernels::loops().pad(C.data, C.ld, work, nullptr);
  kernels::loops().apply_reflections(V, of.tau, order, work);
  copy(view(work), C);
}

// Squares of entries of other sizes over- or underflow: these matrices are scaled, which causes no relevant rounding.
// 1: no need.
double scale_for_squares(ConstView a) {
  const double size = max_abs(a);
  return size > 1e140 && std::isfinite(size) ? 0x1p-600 : size < 1e-140 && size > 0.0 ? 0x1p+600 : 1.0;
}

void multiply_entries(View a, double factor) {
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i) a(i, j) *= factor;
}

void multiply_upper_triangle(View a, double factor) {
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i <= std::min(j, a.rows - 1); ++i) a(i, j) *= factor;
}

int last_block(int count, int block) { return (count - 1) / block * block; }

}  // namespace

void factor_qr(View a, double* tau, Arena& arena) {
  if (a.rows == 0 || a.cols == 0) return;
  if (a.rows <= tiny_rows) return small::factor_qr(a, tau);
  if (const double scale = scale_for_squares(a); scale != 1.0) {
    multiply_entries(a, scale);
    factor_qr(a, tau, arena);
    return multiply_upper_triangle(a, 1.0 / scale);
  }
  const Arena::Frame frame(arena);
  const kernels::QrWork work = work_for(a, tau, arena);
  const kernels::Loops& loops = kernels::loops();
  loops.pad(a.data, a.ld, work.a, nullptr);
  const int steps = std::min(a.rows, a.cols), block = block_for(a.rows);
  const View factors = view(work.a);
  for (int first = 0; first < steps;) {
    const bool is_last = a.cols - first <= unblocked;
    const int next = is_last ? steps : std::min(first + block, steps);
    loops.factor_columns(work, first, next, is_last ? a.cols : next);
    if (!is_last && next < a.cols) {
      const Arena::Frame inner(arena);
      const Block of = make_block({factors, tau, first, next - first}, Op::transposed, arena);
      apply_block(of, factors.block(first, next, a.rows - first, a.cols - next), arena);
    }
    first = next;
  }
  copy(factors, a);
}

namespace {

// All reflections that are not negligible; returns their number.
int factor_pivoted(const kernels::QrWork& work) {
  const kernels::Loops& loops = kernels::loops();
  const View factors = view(work.a);
  const int steps = std::min(factors.rows, factors.cols);
  for (int first = 0; first < steps;) {
    const int columns = factors.cols - first;
    if (columns <= unblocked || steps - first <= panel) return loops.factor_columns(work, first, steps, factors.cols);
    const int done = loops.factor_panel(work, first, panel), next = first + done;
    if (done == 0) return first;
    subtract_product(factors.block(next, first, factors.rows - next, done),
                     view(work.F).block(next, 0, factors.cols - next, done),
                     factors.block(next, next, factors.rows - next, factors.cols - next));
    loops.renew_norms(work, next);
    first = next;
  }
  return steps;
}

// No length is below a negative one.
double square_of(double length) { return length < 0.0 ? -1.0 : length * length; }

// Sets the part that was not factored to zero, except for its size.
void leave_out_rest(View factors, int done, double size, double* tau) {
  const int steps = std::min(factors.rows, factors.cols);
  if (done == steps) return;
  fill(factors.block(done, done, factors.rows - done, factors.cols - done), 0.0);
  std::fill(tau + done, tau + steps, 0.0);
  factors(done, done) = size;
}

}  // namespace

void factor_qr_pivoted(View a, int* pivots, double* tau, Arena& arena, double negligible) {
  if (a.cols == 0) return;
  const Arena::Frame frame(arena);
  if (a.rows <= tiny_rows) {
    double* norms = arena.take(2 * index(a.cols));
    const int done = small::factor_qr_pivoted(a, {pivots, tau, norms, square_of(negligible)});
    return leave_out_rest(a, done, largest_length(norms + done, a.cols - done), tau);
  }
  if (const double scale = scale_for_squares(a); scale != 1.0) {
    multiply_entries(a, scale);
    factor_qr_pivoted(a, pivots, tau, arena, negligible * scale);
    return multiply_upper_triangle(a, 1.0 / scale);
  }
  kernels::QrWork work = work_for(a, tau, arena);
  add_pivoting(work, pivots, arena);
  work.negligible = square_of(negligible);
  kernels::loops().pad(a.data, a.ld, work.a, work.norms);
  std::copy_n(work.norms, a.cols, work.reference);
  const int done = factor_pivoted(work);
  copy(view(work.a), a);
  leave_out_rest(a, done, largest_length(work.norms + done, a.cols - done), tau);
}

void apply_q(Op op, ConstView factors, int count, const double* tau, View c, Arena& arena) {
  if (c.rows == 0 || c.cols == 0 || count == 0) return;
  if (c.cols == 1 || (c.rows <= tiny_rows && c.cols < few_columns)) {
    for (int step = 0; step < count; ++step) {
      const int p = op == Op::transposed ? step : count - 1 - step;
      small::apply_reflector(&factors(p, p), tau[p], c.block(p, 0, c.rows - p, c.cols));
    }
    return;
  }
  const int block = block_for(c.rows);
  if (count <= block || (count <= most_at_once && c.cols < few_columns))
    return apply_unblocked(op == Op::plain ? Order::last_to_first : Order::first_to_last, {factors, tau, 0, count}, c,
                           arena);
  const int last = last_block(count, block);
  for (int step = 0; step <= last; step += block) {
    const int first = op == Op::transposed ? step : last - step;
    const Arena::Frame frame(arena);
    const Block of = make_block({factors, tau, first, std::min(block, count - first)}, op, arena);
    apply_block(of, c.block(first, 0, c.rows - first, c.cols), arena);
  }
}

void form_last_q(ConstView factors, int count, const double* tau, View q, Arena& arena) {
  fill(q, 0.0);
  for (int j = 0; j < q.cols; ++j) q(q.rows - q.cols + j, j) = 1.0;
  const int block = block_for(q.rows);
  if (q.rows <= tiny_rows || count <= block || (count <= most_at_once && q.cols < few_columns))
    return apply_q(Op::plain, factors, count, tau, q, arena);
  for (int first = last_block(count, block); first >= 0; first -= block) {
    const int width = std::min(block, count - first), below = q.rows - first - width;
    const Arena::Frame frame(arena);
    const Block of = make_block({factors, tau, first, width}, Op::plain, arena);
    // Rows of the block, and those above, are still zero; below the last block the identity stands.
    const View W = arena.matrix(width, q.cols);
    const ConstView Yt = of.Yt.columns(width, below);
    if (first + width == count) copy(Yt.columns(below - q.cols, q.cols), W);
    else multiply(1.0, Op::plain, Yt, Op::plain, q.block(first + width, 0, below, q.cols), 0.0, W);
    multiply(-1.0, Op::plain, of.V, Op::plain, W, 1.0, q.block(first, 0, q.rows - first, q.cols));
  }
}

void form_q(ConstView factors, int count, const double* tau, View q, Arena& arena) {
  if (q.rows == 0 || q.cols == 0) return;
  fill(q, 0.0);
  for (int j = 0; j < q.cols; ++j) q(j, j) = 1.0;
  if (count == 0) return;
  if (q.rows <= tiny_rows) {
    // Reflection p leaves the first p columns of the identity alone.
    for (int p = count - 1; p >= 0; --p)
      small::apply_reflector(&factors(p, p), tau[p], q.block(p, p, q.rows - p, q.cols - p));
    return;
  }
  const int block = block_for(q.rows);
  if (count <= block) return apply_unblocked(Order::to_identity, {factors, tau, 0, count}, q, arena);
  for (int first = last_block(count, block); first >= 0; first -= block) {
    const Arena::Frame frame(arena);
    const int width = std::min(block, count - first);
    const Block of = make_block({factors, tau, first, width}, Op::plain, arena);
    const View C = q.block(first, first, q.rows - first, q.cols - first);
    const View W = arena.matrix(width, C.cols);
    // C begins with columns of the identity, which are zero elsewhere.
    const bool is_identity = first + width >= count;
    const int columns = is_identity ? C.cols : width, below = C.rows - width;
    copy(of.Yt.columns(0, columns), W.columns(0, columns));
    multiply(1.0, Op::plain, of.Yt.columns(width, below), Op::plain, C.block(width, columns, below, C.cols - columns),
             0.0, W.columns(columns, C.cols - columns));
    multiply(-1.0, Op::plain, of.V, Op::plain, W, 1.0, C);
  }
}

}  // namespace sfdae::core
