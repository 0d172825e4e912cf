// Confirmation, by certificates, of ranks found by norms.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/confirmed_ranks.h"

namespace sfdae::core {

namespace {

// Ranks found by norms at one level and point.
struct SuggestedRanks {
  double t;
  int level;
  RankSequence list;
};

std::vector<SuggestedRanks> suggested_ranks(const std::vector<RankDecision>& decisions) {
  std::vector<SuggestedRanks> all;
  for (const RankDecision& decision : decisions) {
    if (all.empty() || all.back().t != decision.t || all.back().level != decision.level)
      all.push_back({decision.t, decision.level, {}});
    RankSequence& list = all.back().list;
    if (list.count < list.rank.size()) list.add(decision.rank);
  }
  return all;
}

}  // namespace

std::optional<Significance> confirmed_ranks(SearchTask task, const std::vector<RankDecision>& decisions) {
  task.certified = true;
  Significance significance;
  for (const SuggestedRanks& ranks : suggested_ranks(decisions)) {
    task.suggested = &ranks.list;
    const LevelResult found = IndexSearch(task, ranks.t).determine_confirmed(ranks.level);
    if (!found.clear || !(found.known_ranks == ranks.list)) return std::nullopt;
    significance.join(found.significance);
  }
  return significance;
}

}  // namespace sfdae::core
