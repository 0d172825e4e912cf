// Rank decisions for a report, in little memory if many are the same: those on blocks of one equation, by thousands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "linalg/rank.h"

namespace sfdae::core {

class KeptDecisions {
 public:
  KeptDecisions() = default;
  explicit KeptDecisions(const std::vector<RankDecision>& decisions) : size_(decisions.size()) {
    for (std::size_t i = 0; i < size_; ++i)
      if (runs_.empty() || !(at(runs_.back(), i) == decisions[i])) runs_.push_back({i, decisions[i]});
    runs_.shrink_to_fit();
  }

  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  RankDecision operator[](std::size_t i) const {
    const auto after = std::upper_bound(runs_.begin(), runs_.end(), i,
                                        [](std::size_t wanted, const Run& run) { return wanted < run.first; });
    return at(*(after - 1), i);
  }
  // Decisions in order; of those that differ only by the number of the stage, the first.
  std::vector<RankDecision> different() const {
    std::vector<RankDecision> result;
    for (const Run& run : runs_) result.push_back(run.decision);
    return result;
  }
  std::vector<RankDecision> all() const {
    std::vector<RankDecision> result;
    for (std::size_t i = 0; i < size_; ++i) result.push_back((*this)[i]);
    return result;
  }

 private:
  // A decision and its repetitions in the following stages.
  struct Run {
    std::size_t first;
    RankDecision decision;
  };
  static RankDecision at(const Run& run, std::size_t i) {
    RankDecision decision = run.decision;
    decision.stage += static_cast<int>(i - run.first);
    return decision;
  }

  std::size_t size_ = 0;
  std::vector<Run> runs_;
};

}  // namespace sfdae::core
