// Routines of LAPACK under one name for real and complex matrices. Included by src/linalg/*.cpp only.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "linalg/lapack.h"

namespace sfdae::core::lapack {

using Complex = std::complex<double>;

inline void getrf(const int* m, const int* n, double* a, const int* lda, int* pivots, int* info) {
  dgetrf_(m, n, a, lda, pivots, info);
}
inline void getrf(const int* m, const int* n, Complex* a, const int* lda, int* pivots, int* info) {
  zgetrf_(m, n, a, lda, pivots, info);
}
inline void getrs(const char* trans, const int* n, const int* nrhs, const double* a, const int* lda,
                  const int* pivots, double* b, const int* ldb, int* info) {
  dgetrs_(trans, n, nrhs, a, lda, pivots, b, ldb, info);
}
inline void getrs(const char* trans, const int* n, const int* nrhs, const Complex* a, const int* lda,
                  const int* pivots, Complex* b, const int* ldb, int* info) {
  zgetrs_(trans, n, nrhs, a, lda, pivots, b, ldb, info);
}
inline void gbtrf(const int* n, const int* kl, const int* ku, double* ab, const int* ldab, int* pivots, int* info) {
  dgbtrf_(n, n, kl, ku, ab, ldab, pivots, info);
}
inline void gbtrf(const int* n, const int* kl, const int* ku, Complex* ab, const int* ldab, int* pivots, int* info) {
  zgbtrf_(n, n, kl, ku, ab, ldab, pivots, info);
}
inline void gbtrs(const char* trans, const int* n, const int* kl, const int* ku, const int* nrhs, const double* ab,
                  const int* ldab, const int* pivots, double* b, const int* ldb, int* info) {
  dgbtrs_(trans, n, kl, ku, nrhs, ab, ldab, pivots, b, ldb, info);
}
inline void gbtrs(const char* trans, const int* n, const int* kl, const int* ku, const int* nrhs, const Complex* ab,
                  const int* ldab, const int* pivots, Complex* b, const int* ldb, int* info) {
  zgbtrs_(trans, n, kl, ku, nrhs, ab, ldab, pivots, b, ldb, info);
}

}  // namespace sfdae::core::lapack
