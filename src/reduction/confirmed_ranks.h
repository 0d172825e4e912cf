// Confirmation, by certificates in the same units, of ranks found by norms.
//
// If entries decay over many decades, such as those of products of rotations, large problems cannot be judged in
// balanced units (docs/design/rank_decisions.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "reduction/index_search.h"

namespace sfdae::core {

// decisions: of complete levels at one point or several, in the order in which they were made, with v^ = 0. All small
// entries are values. None if a certificate is not clear with exactly these ranks. Throws Failure: errors of callbacks.
std::optional<Significance> confirmed_ranks(SearchTask task, const std::vector<RankDecision>& decisions);

}  // namespace sfdae::core
