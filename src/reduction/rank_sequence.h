// The ranks of a reduction, for eliminations that are kept: those take them as known.
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

// Memory that results use again.
struct RankWorkspace {
  Arena& arena;
  NullSpaceForm& form;
};

// With the form that belongs to them, for a right-hand side 0; or alone.
RankResult determine_ranks(const TaylorData& data, int level, const Judge::Settings& settings,
                           RankWorkspace workspace);
RankResult find_ranks(const TaylorData& data, int level, const Judge::Settings& settings, RankWorkspace workspace);

// Stage k + 1 is about derivatives of one order less, with the rows of one more level: what determines y_j at stage k
// does so, differentiated, for y_(j+1) then, so that ranks do not fall. Residuals mistaken for pivots make them.
// full_rank: min(m, n). Where rows are left out of the array, they may fall.
bool stages_rise(const RankSequence& list, int level, int full_rank);

// Ranks that agree with the values known, by one noise model or another; level: mu, or above. matching_form leaves the
// form that belongs to them, for a right-hand side 0, in the workspace.
std::optional<RankSequence> matching_ranks(const TaylorData& data, int level, const IndexAnalysis& known,
                                           double rank_tol, RankWorkspace workspace);
bool matching_form(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                   RankWorkspace workspace);

// An elimination of the data with their f that was stored.
struct StoredReduction {
  StoredElimination& elimination;
  bool has_form = false;  // that of its right-hand side is built as well
  int rank_E = 0;         // of E_0
  double kept = 1.0;      // the smallest relative value behind the constraints
};

// The same, stored on the way: a single elimination as a rule. False if no noise model leads to the values known.
bool reduce_with_known_values(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                              RankWorkspace workspace, StoredReduction& reduction);

}  // namespace sfdae::core
