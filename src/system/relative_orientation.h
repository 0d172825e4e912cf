// Whether a basis has kept its orientation from one point to another.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Sign of det(then^T now), orthonormal columns of the same number.
//
// Bases of points nearby differ little but for signs s_j of their columns: with |now S - then|_F^2 < 2, then^T now S
// has a positive definite symmetric part, as x^T then^T now S x >= 1 - |now S - then|^2 / 2 for |x| = 1. So det S is
// the sign, without a determinant. Others are computed.
int relative_orientation(ConstView then, ConstView now, Arena& arena);
// The cosine of the largest angle between the spaces that such columns span, or, by the same inequality, a bound
// below that which is at least `enough`. May allocate where these spaces are far apart.
double cosine_between(ConstView then, ConstView now, double enough, Arena& arena);
// For bases of d columns: the arena has what that takes, though few of them turn far enough to need it.
void reserve_orientation(int d, Arena& arena);

}  // namespace sfdae::core
