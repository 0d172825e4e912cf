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

// A value and an estimate of its absolute error: rounding errors of the data and of what computed it, times the
// condition. Of a pair of complex ones, conjugate in every bit, that with the positive imaginary part comes first.
struct Eigenvalue {
  std::complex<double> value;
  double error = 0.0;
};

// All of them, by QZ: G and B are square, of one size, finite, G regular; where it is not, infinite ones with
// infinite errors. Empty for matrices without columns. The errors are those that normwise backward stability allows.
// Throws std::runtime_error where QZ does not converge.
std::vector<Eigenvalue> generalized_eigenvalues(ConstView G, ConstView B);

// By two-sided inverse iteration with a pencil lambda E - A, which may have infinite eigenvalues: errors are then
// those of relative errors of the entries, which small eigenvalues beside large ones feel less [HH98]. Values that
// this does not improve, as multiple ones, stay as they are, and so do those whose relative errors are small enough.
std::vector<Eigenvalue> refined(ConstView E, ConstView A, std::vector<Eigenvalue> known, double small_enough);

// By size, of the same size with positive imaginary parts first; pairs stay together.
void sort_by_size(std::vector<Eigenvalue>& eigenvalues);

}  // namespace sfdae::core
