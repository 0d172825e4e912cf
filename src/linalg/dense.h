// Dense linear algebra of the core: the only place that calls BLAS and LAPACK.
//
// Matrices up to a few columns wide go through hand-written loops (small_kernels.h), where the overhead of
// LAPACK dominates, QR factorizations of all larger ones through vector loops (qr.cpp, kernels.h), the rest through
// BLAS and LAPACK. All inputs must be finite: LAPACK does not report NaN reliably.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"

namespace sfdae::core {

enum class Op { plain, transposed };

// C := alpha op(A) op(B) + beta C.
void multiply(double alpha, Op op_a, ConstView a, Op op_b, ConstView b, double beta, View c);
// y := alpha op(A) x + beta y.
void multiply(double alpha, Op op_a, ConstView a, const double* x, double beta, double* y);

Matrix product(ConstView a, ConstView b);            // A B
Matrix transpose_product(ConstView a, ConstView b);  // A^T B

// A = Q R in place: R on and above the diagonal, Householder vectors below, min(rows, cols) factors in tau.
void factor_qr(View a, double* tau, Arena& arena);
// A P = Q R in place, with column pivoting: column j of R belongs to column pivots[j] of A, |r_jj| decreasing.
// Once no remaining column is longer than `negligible` (< 0: never), the rest is taken for zero: the next r_jj is the
// length of the longest one.
void factor_qr_pivoted(View a, int* pivots, double* tau, Arena& arena, double negligible = -1.0);
// C := Q^T C (transposed) or Q C (plain), Q from the first count Householder vectors of a factorization.
void apply_q(Op op, ConstView factors, int count, const double* tau, View c, Arena& arena);
// q := the first q.cols columns of Q; q.rows = factors.rows, count <= q.cols.
void form_q(ConstView factors, int count, const double* tau, View q, Arena& arena);
// q := the last q.cols columns of Q, none of which belongs to R: q.rows = factors.rows, count <= q.rows - q.cols.
void form_last_q(ConstView factors, int count, const double* tau, View q, Arena& arena);

// R upper triangular, of order r.cols, stored in the upper triangle of r.
void solve_upper(Op op, ConstView r, View b);  // B := op(R)^-1 B
void solve_upper_right(ConstView r, View b);   // B := B R^-1

// P A = L U in place; false if a pivot vanishes (nothing may be solved then).
bool factor_lu(View a, int* pivots);
void solve_lu(ConstView lu, const int* pivots, double* x);
void solve_lu(ConstView lu, const int* pivots, View b);             // B := A^-1 B
void solve_lu_transposed(ConstView lu, const int* pivots, View b);  // B := A^-T B
// A := A^-1 for a well-conditioned matrix with few columns, with the pivots and the sign of its determinant; false if
// a pivot vanishes.
bool invert_small(View a, double* pivots, int& sign);
// LU factorization and solution for complex matrices.
bool factor_lu(ComplexView a, int* pivots);
void solve_lu(ComplexView lu, const int* pivots, std::complex<double>* x);

// A = U diag(s) V^T with full square U, V; s decreasing. For analysis, not for steps.
struct Svd {
  Matrix U;
  std::vector<double> s;
  Matrix V;
};
Svd svd(ConstView a);
std::vector<double> singular_values(ConstView a);

// Orthonormal basis of the range of A (of known rank), rows x rank.
Matrix range_basis(ConstView a, int rank);
// The solution of smallest 2-norm of A x = b in the least squares sense, singular values <= threshold dropped.
std::vector<double> least_squares(ConstView a, const std::vector<double>& b, double threshold);
// Sign of the permutation that takes column pivots[j] to place j.
int permutation_sign(const int* pivots, int count);
// Sign of det Q, Q from the first count Householder vectors of a factorization.
int reflections_sign(const double* tau, int count);
// sign of det A, 0 if a pivot vanishes; A is destroyed.
int determinant_sign(View a, Arena& arena);
// Number of negative eigenvalues whose imaginary parts may be roundoff; A is destroyed.
int count_negative_eigenvalues(View a, Arena& arena);
// Largest in size of the eigenvalues whose imaginary parts may be roundoff, 0 if there is none; A is destroyed.
double largest_real_eigenvalue(View a, Arena& arena);

}  // namespace sfdae::core
