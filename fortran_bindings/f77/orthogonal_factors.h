// Orthogonal factors of matrices whose rows differ much in size.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/matrix.h"

namespace sfdae::f77 {

// The square factor Q of A P = Q R, |r_jj| decreasing: its first r columns span the range of A if A has rank r. Rounding
// errors of each row are relative to that row.
core::Matrix orthogonal_factor(core::ConstView a);

// [S Z^]: an orthogonal matrix of which the last `Z.cols` columns span the range of Z (of full rank), Z^T M = 0, and
// the first ones are left singular vectors of M, by decreasing singular value. Z is scaled by `row_factors` first.
core::Matrix left_factor(core::ConstView M, core::Matrix Z, const double* row_factors);

}  // namespace sfdae::f77
