// Kronecker canonical forms N y' = M y, whose characteristic values are known.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006.
//
// Values of the blocks by the hypothesis of [KM06, section 3.2]; at level l the array holds l derivatives:
//
//   y' = J y, size k          mu = 0,   d = k.
//   N y' = y, one chain of k  mu = k-1, a = k: y_k at level 0, y_(k-1) needs one derivative of it, y_1 needs k-1.
//   L,   e rows, e+1 columns  y_i' = y_(i+1): N has full row rank, mu = 0, d = e, u = 1.
//   L^T, e+1 rows, e columns  y_1' = 0, y_(i+1)' = y_i, 0 = y_e: y_e at level 0, y_1 at level e-1, and y_1' = 0 is
//                             seen to be redundant one level later: mu = e, a = e, v = 1 (e = 0: a row of zeros).
//
// All add up over blocks, mu is the largest: a block that is below its own level has m - a - v - rank(E T2) = 1, one
// at or above it 0.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "dense_matrix.h"

namespace campaign {

struct CharacteristicValues {
  int mu = 0, d = 0, a = 0, u = 0, v = 0;
  bool operator==(const CharacteristicValues&) const = default;
};

struct KroneckerSizes {
  int differential = 0;           // size of the ODE block
  std::vector<int> nilpotent;     // sizes of the chains, >= 1
  std::vector<int> L;             // numbers of rows, >= 0
  std::vector<int> L_transposed;  // numbers of columns, >= 0

  int equations() const;
  int unknowns() const;
  CharacteristicValues values() const;
};

struct KroneckerForm {
  DenseMatrix N, M;
};

// What the entries of the blocks are.
struct KroneckerEntries {
  double stiffness = 1.0;  // largest eigenvalue of J
  bool integers = false;   // integers everywhere
};

KroneckerForm kronecker_form(const KroneckerSizes& sizes, const KroneckerEntries& entries, RandomNumbers& random);

// At most max_unknowns unknowns and equations, at least one of each, mu <= max_index.
KroneckerSizes random_sizes(int max_unknowns, int max_index, RandomNumbers& random);

}  // namespace campaign
