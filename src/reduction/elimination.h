// Staged elimination of the derivative array: all its consequences that are free of derivatives.
//
// With y_j = j x_j (x_j Taylor coefficients of the solution) the array reads, for i = 0..level,
//
//     sum_{j=1}^{i+1} ( E_{i+1-j} - A_{i-j}/j ) y_j  =  A_i x + f_i          (A_{-1} = 0),
//
// block lower triangular with E_0 in every diagonal block, except for rows that are left out at higher levels
// (TaylorData::differentiations). From the last block column to the first, rows without a pivot are carried on; the
// rows carried at the end are 0 = A^ x + f^. Only the rows that determine y_j leave at stage j, so the rows carried
// span the left null space of M applied to [N | g].
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "problem/taylor_data.h"
#include "reduction/judge.h"

namespace sfdae::core {

// Rows free of y_{last_stage}, ..., y_{level+1}; they live in the arena.
struct Carried {
  int rows = 0;
  int rank_E = 0;    // of E_0
  View y;            // rows x (last_stage - 1) n, empty if last_stage = 1
  View constraints;  // A^: rows x n
  View rhs;          // rows x rhs.cols
  // Orthogonal factorization of E_0: E_0 P = Q [R11 R12; 0 0].
  View R;  // m x n, R11 and R12 in the first rank_E rows
  const int* pivots = nullptr;
  // Level 0 only: the columns of Q that span range E_0, and the sign of det Q.
  ConstView Q1;
  int sign_of_Q = 0;
};

// Data of an elimination for later right-hand sides: see stored_elimination.h.
class StoredElimination;

// rhs: (level + 1) m rows, block i belongs to row block i of the array; its columns are transformed, too.
Carried eliminate(const TaylorData& data, int level, ConstView rhs, int last_stage, Judge& judge, Arena& arena,
                  StoredElimination* store = nullptr);

// Same result by one singular value decomposition of M, the classical way of [KM06]. Slow; y is empty, last_stage is 1.
Carried eliminate_by_svd(const TaylorData& data, int level, ConstView rhs, Judge& judge, Arena& arena);

// [M | N] in Taylor scaling as above, (level+1)m x (level+2)n; column block 0..level: y_1.., last: x.
Matrix taylor_array(const TaylorData& data, int level);

}  // namespace sfdae::core
