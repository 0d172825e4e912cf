// What is said where the ranks of a problem are not clear.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reduction/index_search.h"

namespace sfdae::core {

// The smallest level at t alone, by norms or, where they are given, by rank_tol: mu = -1 if no level up to max_index
// holds or a decision is unclear. Throws Failure if the user stops.
CharacteristicValues local_values(const SearchTask& task, double t);

// "rank_tol = 1.0e-16 keeps it (mu = 0, d = 3, ...), rank_tol = 1.0e-08 drops it (...)": tolerances that were tried, in
// balanced units, and what they lead to. certain: the values that one of them ought to give.
std::string rank_tolerances(const SearchTask& task, double t, const CharacteristicValues& certain);

}  // namespace sfdae::core
