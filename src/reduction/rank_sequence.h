// The ranks of a reduction, for stored eliminations, which take them as known.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "linalg/archive.h"
#include "linalg/arena.h"
#include "problem/taylor_data.h"
#include "reduction/index_analysis.h"
#include "reduction/judge.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"

namespace sfdae::core {

// Throws DamagedArchive.
void archive_ranks(Archive& archive, RankSequence& ranks);
// Their number is archived elsewhere. Throws DamagedArchive.
void archive_ranks(Archive& archive, RankSequence& ranks, int count);

struct RankResult {
  RankSequence list;
  PointRanks ranks;
};

// Reusable memory for results.
struct RankWorkspace {
  Arena& arena;
  NullSpaceForm& form;
};

// With the form for these ranks, for a right-hand side 0; or alone.
RankResult determine_ranks(const TaylorData& data, int level, const Judge::Settings& settings,
                           RankWorkspace workspace);
RankResult find_ranks(const TaylorData& data, int level, const Judge::Settings& settings, RankWorkspace workspace);

// Stage k + 1 is about derivatives of one order less, with the rows of one more level: rows that determine y_j at stage
// k do so, differentiated, for y_(j+1) then, so that ranks do not fall. Residuals mistaken for pivots make them fall.
// full_rank: min(m, n). If rows are left out of the array, ranks may fall.
bool stages_rise(const RankSequence& list, int level, int full_rank);

// Ranks that agree with the values known, by one noise model or another; level: mu, or above. matching_form leaves
// their form, for a right-hand side 0, in the workspace.
std::optional<RankSequence> matching_ranks(const TaylorData& data, int level, const IndexAnalysis& known,
                                           double rank_tol, RankWorkspace workspace);
bool matching_form(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                   RankWorkspace workspace);

// A stored elimination of the data with their f.
struct StoredReduction {
  StoredElimination& elimination;
  bool has_form = false;  // the form of its right-hand side is built as well
  int rank_E = 0;         // of E_0
  double kept = 1.0;      // the smallest relative value behind the constraints
};

// The same, stored during elimination: usually a single one. False if no noise model leads to the values known.
bool reduce_with_known_values(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                              RankWorkspace workspace, StoredReduction& reduction);

}  // namespace sfdae::core
