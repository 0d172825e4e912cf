// Determinants of small full matrices, where a call of LAPACK costs more than the arithmetic.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/determinant.h"

namespace sfdae::core {

constexpr int largest_small_determinant = 8;

// Determinant of A, column-major, at most largest_small_determinant rows and columns; A is overwritten. False: A is
// singular to working precision (a pivot vanishes), or an entry is not finite. Rows are scaled by powers of two, so
// that nothing overflows.
bool small_determinant(double* a, int size, Determinant<double>& determinant);

}  // namespace sfdae::core
