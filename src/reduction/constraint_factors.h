// The constraints 0 = A^ x + f^ of one point, factored: A^^T P = Q [R11 R12; 0 R22 ~ 0], R11 of order a.
//
// The first a columns of Q span the row space of A2, the others are T2; A^ has further rows if some are redundant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/room.h"
#include "reduction/elimination.h"
#include "reduction/judge.h"

namespace sfdae::core {

class ConstraintFactors {
 public:
  // Memory for n unknowns and this many rows.
  void resize(int n, int rows);
  // Factors A^ and decides its rank.
  void factor(const Carried& carried, Judge& judge, Arena& arena);

  int rank() const { return rank_; }  // a
  // |r_aa| of R11, the smallest value kept; a > 0.
  double smallest_kept() const { return std::fabs(factors()(rank_ - 1, rank_ - 1)); }
  int rows() const { return rows_; }
  // Factors of A^^T, the scalars of its reflections, and the rows of A^ that its columns are.
  ConstView factors() const { return {factors_.data(), n_, rows_, n_}; }
  const double* tau() const { return tau_.data(); }
  const int* pivots() const { return pivots_.data(); }
  // Sign of det [V T2] det(A2 V), V the basis of the row space of A2 = A^: no row is redundant.
  int orientation() const;
  // T2: n x (n - rank).
  void write_T2(View T2, Arena& arena) const;
  // xp = -A2^+ f2 of smallest norm. norm_f: of the data of f^. Returns the contradiction of redundant rows: the largest
  // entry of their residual relative to its terms.
  double solve(const double* f_hat, double norm_f, double* xp, Arena& arena) const;
  // Maps weights of xp to weights of f^: weights_of_f^T f^ = weights^T xp.
  void solve_transposed(const double* weights, double* weights_of_f, Arena& arena) const;

 private:
  int n_ = 0, rows_ = 0, rank_ = 0;
  Room factors_, tau_;  // n x rows
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
