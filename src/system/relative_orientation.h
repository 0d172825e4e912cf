// Relative orientation of a basis at two points.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Sign of det(then^T now), orthonormal columns of the same number.
//
// Bases of nearby points differ little except for signs s_j of their columns: with |now S - then|_F^2 < 2, then^T now S
// has a positive definite symmetric part, as x^T then^T now S x >= 1 - |now S - then|^2 / 2 for |x| = 1. So det S is
// the sign, without a determinant. Otherwise the determinant is computed.
int relative_orientation(ConstView then, ConstView now, Arena& arena);
// The cosine of the largest angle between the spaces spanned by such columns, or, by the same inequality, a lower bound
// that is at least `enough`. May allocate if these spaces are far apart.
double cosine_between(ConstView then, ConstView now, double enough, Arena& arena);
// Reserves the arena for bases of d columns, although few of them turn far enough to need it.
void reserve_orientation(int d, Arena& arena);

}  // namespace sfdae::core
