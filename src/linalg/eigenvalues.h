// Eigenvalues of regular matrix pencils lambda G - B, with errors.
//
// [MS73] C. B. Moler, G. W. Stewart: An algorithm for generalized matrix eigenvalue problems. SIAM J. Numer. Anal. 10
// (1973)
//        241-256.
// [HH98] D. J. Higham, N. J. Higham: Structured backward error and condition of generalized eigenvalue problems. SIAM
// J.
//        Matrix Anal. Appl. 20 (1998) 493-512.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "linalg/matrix.h"

namespace sfdae::core {

// A value and an estimate of its absolute error: rounding errors of the data and of the algorithm, times the condition.
// In a complex pair, conjugate in every bit, the one with the positive imaginary part comes first.
struct Eigenvalue {
  std::complex<double> value;
  double error = 0.0;
};

// All eigenvalues, by QZ: G and B are square, of one size, finite, G nonsingular; otherwise some are infinite, with
// infinite errors. Empty for matrices without columns. The errors are those of normwise backward stability. Throws
// std::runtime_error if QZ does not converge.
std::vector<Eigenvalue> generalized_eigenvalues(ConstView G, ConstView B);

// Refinement by two-sided inverse iteration with a pencil lambda E - A, which may have infinite eigenvalues: errors are
// then those of relative errors of the entries, to which eigenvalues much smaller than others are less sensitive
// [HH98]. Values that this does not improve, such as multiple ones, are unchanged, and so are those with small relative
// errors.
std::vector<Eigenvalue> refined(ConstView E, ConstView A, std::vector<Eigenvalue> known, double small_enough);

// Sorted by size; of equal sizes, positive imaginary parts come first; pairs stay together.
void sort_by_size(std::vector<Eigenvalue>& eigenvalues);

}  // namespace sfdae::core
