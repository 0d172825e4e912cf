// The differential part of one point, factored: G = Z1^T E T2, which has full row rank.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/room.h"

namespace sfdae::core {

class DifferentialFactors {
 public:
  // Memory for up to n unknowns.
  void resize(int n);
  // R3: d x (d + u), upper triangular in its first d columns; column j of it is column pivots[j] of G.
  void factor(ConstView R3, const int* pivots, Arena& arena);
  // The factorization G P = Q3 R3 itself, d x d, u = 0.
  void keep(ConstView factors, const int* pivots, const double* tau);

  // Orthonormal basis of ker G, (d + u) x u.
  ConstView kernel() const { return {kernel_.data(), unknowns(), u_, std::max(unknowns(), 1)}; }
  // z of smallest norm with G z = q.
  void solve(const double* q, double* z, Arena& arena) const;
  // The smallest entry on the diagonal of R; d > 0.
  double smallest_kept() const;
  // Sign of det G, 0 if it vanishes; u = 0 only.
  int determinant_sign() const;

 private:
  int unknowns() const { return d_ + u_; }
  // Scalars of the reflections of Q3, behind R.
  const double* tau() const { return R_.data() + index(d_) * index(d_); }
  double* tau() { return R_.data() + index(d_) * index(d_); }

  int d_ = 0, u_ = 0;
  bool has_reflections_ = false;  // of Q3, below the diagonal of R
  Room R_;                        // u = 0: R3; u > 0: R of R3^T = Q R
  Room row_space_;                // u > 0: orthonormal basis of that of G
  Room kernel_;
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
