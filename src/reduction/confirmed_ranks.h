// Ranks that norms have found, confirmed by certificates in the units that they were found in.
//
// Where entries decay over many decades, as those of products of rotations do, balanced units are none in which large
// problems could be judged (docs/design/rank_decisions.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "reduction/index_search.h"

namespace sfdae::core {

// decisions: of whole levels at one point or several, in the order in which they were made, with v^ = 0. All small
// entries are values. None if a certificate is not clear with exactly these ranks. Throws Failure: errors of callbacks.
std::optional<Significance> confirmed_ranks(SearchTask task, const std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
