// The matrix s E - A of a pencil at a complex number s, scaled and factored.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "linalg/dense.h"
#include "linalg/equilibration.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Powers of two R, C make the largest entry of each row and column of R (|s| |E| + |A|) C about 1: results do not
// depend on the units of equations and unknowns. Everything below refers to R E C and R A C.
class ShiftedPencil {
 public:
  using Complex = std::complex<double>;
  using Vector = std::vector<Complex>;

  // E and A are square, finite and outlive this.
  ShiftedPencil(ConstView E, ConstView A) : E_(E), A_(A) {}
  // False if s E - A is singular.
  bool factor(Complex s);

  int size() const { return E_.cols; }
  Complex s() const { return s_; }
  // R and C; valid after factor().
  const std::vector<int>& row_exponents() const { return units_.of_crossings(); }
  const std::vector<int>& column_exponents() const { return units_.of_lines(); }
  ConstView E() const { return scaled_E_; }
  ConstView A() const { return scaled_A_; }

  void solve(Op op, Vector& b) const;
  // op(s E - A) x
  Vector product(Op op, const Vector& x) const;

 private:
  bool scale();

  ConstView E_, A_;
  Complex s_;
  Equilibration units_;
  Matrix scaled_E_, scaled_A_;
  Vector lu_;
  std::vector<int> pivots_;
};

// op(A) x of a real matrix.
ShiftedPencil::Vector product(Op op, ConstView a, const ShiftedPencil::Vector& x);

}  // namespace sfdae::core
