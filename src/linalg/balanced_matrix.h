// Matrices whose largest entries do not tell in which units they are.
//
// A bar of a microsystem has a mass of 1e-9 kg and a moment of inertia of 1e-20 kg m2: beside the entries of its
// joints, 1 and 1e-5, the latter looks like a rounding error in its row and in its column, whatever powers of two
// these are multiplied by so that their largest entries are one. Where equations and unknowns have units in which all
// entries are of similar size (unit_fit.h), sizes say nothing against any of them, and the matrix is judged in these.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/matrix.h"
#include "linalg/rank.h"

namespace sfdae::core {

// In powers of two; `changes`, of the same shape, goes along. without_suspects: J, with zeros in place of entries
// that are so small beside what all others suggest that they may be rounding errors of zeros: cos(pi / 2) = 6e-17.
// False, and nothing has changed: there are no such units.
bool balance(Matrix& J, Matrix& changes, Matrix& without_suspects);

// Whether J, square, is regular in such units, with its suspects and without: then `decision` says so, else it stays.
// J is balanced where that is possible. changes: how far rounding errors of the data may have moved each entry. An
// entry alone in its row and column is as large as one whatever its size.
bool is_regular_in_balanced_units(Matrix& J, Matrix changes, RankDecision& decision);

}  // namespace sfdae::core
