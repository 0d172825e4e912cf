// Loops over whole vectors of numbers, compiled for several instruction sets; which one is taken is decided at run
// time.
//
// They work on padded matrices: columns aligned to 64 bytes, leading dimension a multiple of 8, zeros in the rows from
// `rows` to the next multiple of 8, and room for spare columns, so that no loop has a remainder. dense.h uses them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stddef.h>

#include "linalg/instruction_set.h"

namespace sfdae::core::kernels {

// What rows are rounded up to: the longest vector, and a cache line.
inline constexpr int lanes = 8;
// Columns behind the last one that loops over groups of columns may read and write; zeros.
inline constexpr int spare_columns = 8;

// i rounded to a multiple of `lanes`. Static: each file has its own, compiled for its processors.
static constexpr int round_down(int i) { return i & ~(lanes - 1); }
static constexpr int round_up(int i) { return round_down(i + lanes - 1); }

// Squared norms, and references, of columns that a pivoted factorization is done with, and of spare ones: they are
// never chosen, and their updates never look as if they had lost digits.
inline constexpr double done_norm = -1.0;
inline constexpr double done_reference = -1e300;

// An array with the properties above.
struct Padded {
  double* data;
  int ld;
  int rows, cols;
};

// A factorization A P = Q R under way: R and the Householder vectors in A as LAPACK has them.
struct QrWork {
  Padded a;
  double* v;    // the Householder vector at work, with its zeros and 1: ld entries
  double* row;  // the row at work: as many entries as there are columns, rounded up, and spare ones
  double* tau;
  // With column pivoting; nullptr: without. Squared norms of what is left of each column, and what these were when they
  // were last computed and not only updated; of the length of `row`.
  int* pivots;
  double* norms;
  double* reference;
  // Once no square is larger, nothing is left that counts; < 0: go on to the end.
  double negligible;
  // Of a panel: A = A - V F^T is what its reflections do to the columns behind it. Of the length of `row` times the
  // width of a panel, and as many coefficients as that is wide, and spare ones.
  Padded F;
  double* coefficients;
};

// For arrays of any alignment and length.
struct ArrayLoops {
  // max |x_i|
  double (*largest_size)(const double* x, int count);
  // Neither NaN nor infinite; raises no floating-point exception.
  bool (*all_finite)(const double* x, size_t count);
  // x_i := x_i factor_i; returns the largest size that there is then.
  double (*scale_entries)(double* x, const double* factors, int count);
  // sizes_i := max(sizes_i, unit |x_i|)
  void (*raise_sizes)(const double* x, double unit, int count, double* sizes);
  // difference_i := x_i - s y_i
  void (*subtract)(const double* x, double s, const double* y, int count, double* difference);
};

// op(A): a matrix of any alignment, or its transpose.
struct Operand {
  const double* data;
  ptrdiff_t ld;
  bool is_transposed;
};

// C := alpha op(A) op(B) + beta C, C rows x cols, the sums of `inner` products in their order.
struct Product {
  double alpha;
  Operand a, b;
  int inner;
  double beta;
  double* c;
  ptrdiff_t ldc;
  int rows, cols;
};
// So many at most where A is transposed: it is copied, a few rows at a time.
inline constexpr int most_transposed = 128;

// Q^T C takes the first reflection first, Q C the last; to_identity: Q C where C begins with the identity, whose
// first p columns reflection p leaves alone.
enum class Order { first_to_last, last_to_first, to_identity };

struct Loops {
  const char* name;
  ArrayLoops arrays;
  // Copies a into `to` and pads it; squares, if not nullptr: the squared norms of the columns.
  void (*pad)(const double* a, int lda, Padded to, double* squares);
  // Reflections first, ..., last - 1, each applied to all columns up to end at once. Returns last, or the first one
  // that was not made because nothing is left that counts.
  int (*factor_columns)(const QrWork& work, int first, int last, int end);
  // Reflections first, ..., first + count - 1 at most, pivoted: the columns behind the panel get their pivot rows, the
  // rest of them is left as it was, for one product with F. Returns how many were made: fewer where norms have to be
  // computed anew before the next pivot can be chosen, or nothing is left.
  int (*factor_panel)(const QrWork& work, int first, int count);
  // Norms of the columns from `first` on, in the rows from there on, computed anew where updates have lost them.
  void (*renew_norms)(const QrWork& work, int first);
  // C := Q^T C or Q C, reflection by reflection. V: Householder vectors with zeros and 1.
  void (*apply_reflections)(Padded V, const double* tau, Order order, Padded C);
  // T of Q = I - V T V^T from S = V^T V, upper triangular; zeros below.
  void (*triangular_factor)(Padded S, const double* tau, Padded T);
  // nullptr: BLAS is as fast.
  void (*multiply)(const Product& product);
};

// nullptr where the processor, or this build, does not have it.
const Loops* loops_for(InstructionSet set);
// What the parts of the build have; called by loops_for().
const Loops* portable_loops();
const Loops* avx2_loops();
const Loops* avx512_loops();

}  // namespace sfdae::core::kernels
