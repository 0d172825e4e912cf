// Loops over whole vectors of numbers, compiled for several instruction sets; the set is selected at run time.
//
// They work on padded matrices: columns aligned to 64 bytes, leading dimension a multiple of 8, zeros in the rows from
// `rows` to the next multiple of 8, and room for spare columns, so that no loop has a remainder. dense.h uses them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stddef.h>

#include "linalg/instruction_set.h"

namespace sfdae::core::kernels {

// Row counts are rounded up to this: the longest vector, and a cache line.
inline constexpr int lanes = 8;
// Columns behind the last one that loops over groups of columns may read and write; zeros.
inline constexpr int spare_columns = 8;

// i rounded to a multiple of `lanes`. Static: each file has its own, compiled for its processors.
static constexpr int round_down(int i) { return i & ~(lanes - 1); }
static constexpr int round_up(int i) { return round_down(i + lanes - 1); }

// Squared norms, and references, of columns that a pivoted factorization is done with, and of spare ones: they are
// never chosen, and their updates never seem to lose digits.
inline constexpr double done_norm = -1.0;
inline constexpr double done_reference = -1e300;

// An array with the properties above.
struct Padded {
  double* data;
  int ld;
  int rows, cols;
};

// A factorization A P = Q R in progress: R and the Householder vectors in A as in LAPACK.
struct QrWork {
  Padded a;
  double* v;    // the Householder vector at work, with its zeros and 1: ld entries
  double* row;  // the row at work: as many entries as there are columns, rounded up, and spare ones
  double* tau;
  // With column pivoting; nullptr: without. Squared norms of the remaining part of each column, and their values when
  // last computed instead of updated; of the length of `row`.
  int* pivots;
  double* norms;
  double* reference;
  // If no square is larger, the rest is negligible; < 0: continue to the end.
  double negligible;
  // For a panel: A = A - V F^T applies its reflections to the columns behind it. Length of `row` times the width of a
  // panel, and as many coefficients as the panel is wide, and spare ones.
  Padded F;
  double* coefficients;
};

// For arrays of any alignment and length.
struct ArrayLoops {
  // max |x_i|
  double (*largest_size)(const double* x, int count);
  // Neither NaN nor infinite; raises no floating-point exception.
  bool (*all_finite)(const double* x, size_t count);
  // x_i := x_i factor_i; returns the largest resulting size.
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
// Upper limit if A is transposed: it is copied, a few rows at a time.
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
  // that was not made because the rest is negligible.
  int (*factor_columns)(const QrWork& work, int first, int last, int end);
  // Reflections first, ..., first + count - 1 at most, pivoted: the columns behind the panel get their pivot rows, the
  // rest of them is left unchanged, for one product with F. Returns how many were made: fewer if norms have to be
  // recomputed before the next pivot can be chosen, or the rest is negligible.
  int (*factor_panel)(const QrWork& work, int first, int count);
  // Norms of the columns from `first` on, in the rows from there on, recomputed if updates have lost their digits.
  void (*renew_norms)(const QrWork& work, int first);
  // C := Q^T C or Q C, reflection by reflection. V: Householder vectors with zeros and 1.
  void (*apply_reflections)(Padded V, const double* tau, Order order, Padded C);
  // T of Q = I - V T V^T from S = V^T V, upper triangular; zeros below.
  void (*triangular_factor)(Padded S, const double* tau, Padded T);
  // nullptr: BLAS is as fast.
  void (*multiply)(const Product& product);
};

// nullptr if the processor, or this build, does not have it.
const Loops* loops_for(InstructionSet set);
// Loops in the parts of the build; called by loops_for().
const Loops* portable_loops();
const Loops* avx2_loops();
const Loops* avx512_loops();

}  // namespace sfdae::core::kernels
