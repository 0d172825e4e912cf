// Descriptor systems E x' = A x + B u, y = C x + D u with constant matrices: poles, zeros, transfer function.
//
// [DA89] L. Dai: Singular Control Systems. Springer, 1989.
// [VD81] P. Van Dooren: The generalized eigenstructure problem in linear system theory. IEEE Trans. Automat. Control 26
//        (1981) 111-129.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "linalg/matrix.h"
#include "linalg/shifted_pencil.h"
#include "linear/pencil_reduction.h"

namespace sfdae::core {

struct DescriptorSystem {
  Matrix E, A, B, C, D;  // m x n, m x n, m x q, p x n, p x q
  int equations() const { return E.rows(); }
  int unknowns() const { return E.cols(); }
  int inputs() const { return B.cols(); }
  int outputs() const { return C.rows(); }
};

// Finite eigenvalues of (E, A). Throws Failure, SFDAE_SINGULAR for a singular pencil.
PencilSpectrum poles(const DescriptorSystem& system, double rank_tol);
// Invariant zeros: the finite eigenvalues of the system pencil [s E - A, -B; C, D], or of its regular part if it is
// singular [VD81]. Throws Failure.
PencilSpectrum invariant_zeros(const DescriptorSystem& system, double rank_tol);

// H(s) = C (s E - A)^-1 B + D at one number after another.
class TransferFunction {
 public:
  // Throws Failure if s E - A is not square. The caller keeps the system alive as long as this object.
  explicit TransferFunction(const DescriptorSystem& system);
  // H: p x q, column-major. Throws Failure SFDAE_SINGULAR if s is a pole to machine precision.
  void evaluate(std::complex<double> s, std::complex<double>* H);

 private:
  using Vector = ShiftedPencil::Vector;
  // A column of B into x, in the units of the pencil.
  Vector solve(int input);

  const DescriptorSystem& system_;
  ShiftedPencil pencil_;
};

}  // namespace sfdae::core
