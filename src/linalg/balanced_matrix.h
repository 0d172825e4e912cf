// Matrices in units that make their entries similar in size.
//
// A bar of a microsystem has a mass of 1e-9 kg and a moment of inertia of 1e-20 kg m2: compared with the entries of its
// joints, 1 and 1e-5, the latter looks like a rounding error in its row and in its column, whatever powers of two scale
// their largest entries to one. If there are units of equations and unknowns in which all entries are of similar size
// (unit_fit.h), no entry is negligible by its size, and the matrix is judged in these units.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/matrix.h"
#include "linalg/rank.h"

namespace sfdae::core {

// Scales J by powers of two; `changes`, of the same shape, is scaled with it. without_suspects: J, with zeros in place
// of entries so small relative to the others that they may be rounding errors of zeros: cos(pi / 2) = 6e-17. False, and
// nothing has changed: no such units exist.
bool balance(Matrix& J, Matrix& changes, Matrix& without_suspects);

// True if J, square, is nonsingular in such units, with its suspects and without: then `decision` is updated, else
// unchanged. J is balanced where that is possible. changes: bounds for the effect of rounding errors of the data on
// each entry. An entry alone in its row and column counts as one whatever its size.
bool is_regular_in_balanced_units(Matrix& J, Matrix changes, RankDecision& decision);

}  // namespace sfdae::core
