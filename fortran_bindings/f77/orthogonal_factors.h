// Orthogonal factors of matrices whose rows differ much in size.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/matrix.h"

namespace sfdae::f77 {

// The square factor Q of A P = Q R, |r_jj| decreasing: its first r columns span the range of A if A has rank r.
// Rounding errors of each row are relative to that row.
core::Matrix orthogonal_factor(core::ConstView a);

// Powers of two that bring the rows of [A B] to size 1. Rows of zeros get the largest of them: unit vectors in the
// left null space should stand out, not drown in rounding errors of others.
std::vector<double> row_factors(core::ConstView a, core::ConstView b);
// Gives rows of zeros of A the largest of the factors.
void raise_zero_rows(core::ConstView a, std::vector<double>& factors);

// diag(factors) A
core::Matrix scaled_rows(const std::vector<double>& factors, core::ConstView a);

// An orthogonal matrix: the last columns span the range of Z (of full rank, Z^T M = 0), the first ones are left
// singular vectors of M, by decreasing singular value.
core::Matrix left_factor(core::ConstView M, core::ConstView Z);

}  // namespace sfdae::f77
