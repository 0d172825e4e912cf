// Messages about problems whose ranks are not clear.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "reduction/index_search.h"

namespace sfdae::core {

// "rank_tol = 1.0e-16 keeps it (mu = 0, d = 3, ...), rank_tol = 1.0e-08 drops it (...)": tolerances that were tried, in
// balanced units, and their results. certain: the values that one of them ought to give.
std::string rank_tolerances(const SearchTask& task, double t, const CharacteristicValues& certain);

// " With rank 3 (rank_tol = 1.0e-09) the characteristic values are mu = 1, .... With rank 2 ...": for the doubtful
// decision at the end of the log of the task, in the units of the source; two searches.
std::string neighbouring_ranks(const SearchTask& task);

}  // namespace sfdae::core
