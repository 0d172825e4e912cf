// SPDX-License-Identifier: BSD-3-Clause
// Rank decisions: thresholds, gaps, verdicts.
#include "linalg/rank.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "linalg/kept_decisions.h"

namespace sfdae::core {

namespace {

constexpr double noise = 1e-12;

// Threshold = 10 dimension noise, the factor stated in design and source.
constexpr double threshold(int dimension) { return 10.0 * dimension * noise; }

RankDecision decide(const std::vector<double>& values, const RankScale& scale) {
  return decide_rank(values.data(), static_cast<int>(values.size()), 1, scale);
}

}  // namespace

TEST(UnitRoundoff, IsHalfTheSpacingOfNumbersAtOne) {
  EXPECT_EQ(unit_roundoff, std::numeric_limits<double>::epsilon() / 2.0);
}

TEST(DecideRank, KeepsValuesAboveTheThresholdAndDropsOthers) {
  for (int dimension : {1, 4, 50}) {
    const double at = threshold(dimension);
    EXPECT_EQ(decide({1.0, 1.001 * at}, {noise, 1.0, dimension, 0.0}).rank, 2) << dimension;
    EXPECT_EQ(decide({1.0, 0.999 * at}, {noise, 1.0, dimension, 0.0}).rank, 1) << dimension;
  }
}

TEST(DecideRank, CountsMagnitudesAndStopsAtTheFirstThatIsSmall) {
  const RankDecision decision = decide({-2.0, 1.0, -1e-20, 1e-21}, {noise, 1.0, 4, 0.0});
  EXPECT_EQ(decision.rank, 2);
  EXPECT_EQ(decision.kept, 1.0);
  EXPECT_EQ(decision.dropped, 1e-20);
}

TEST(DecideRank, ReadsEveryStrideThValue) {
  // The diagonal of a 2 x 2 matrix stored with leading dimension 3.
  const std::vector<double> entries{3.0, 7.0, 7.0, 7.0, 1e-20};
  const RankDecision decision = decide_rank(entries.data(), 2, 4, {noise, 1.0, 2, 0.0});
  EXPECT_EQ(decision.rank, 1);
  EXPECT_EQ(decision.kept, 3.0);
  EXPECT_EQ(decision.dropped, 1e-20);
}

TEST(DecideRank, RecordsValuesRelativeToTheNorm) {
  const RankDecision decision = decide({8.0, 1e-12}, {2e-12, 4.0, 3, 0.0});
  EXPECT_DOUBLE_EQ(decision.kept, 2.0);
  EXPECT_DOUBLE_EQ(decision.dropped, 0.25e-12);
  EXPECT_DOUBLE_EQ(decision.noise, 0.5e-12);
  EXPECT_DOUBLE_EQ(decision.threshold, 10.0 * 3 * 0.5e-12);
  EXPECT_DOUBLE_EQ(decision.gap, 8.0 / 2e-12);  // the noise is above what was dropped
}

// A gap of 1e3 between what is kept and the larger of what is dropped and the noise is clear, less is not.
TEST(DecideRank, IsClearFromAGapOfAThousandOn) {
  const RankScale scale{noise, 1.0, 1, 0.0};
  EXPECT_EQ(decide({1.0, 1001.0 * noise}, scale).verdict, Verdict::clear);
  EXPECT_EQ(decide({1.0, 999.0 * noise}, scale).verdict, Verdict::unclear);
  const double dropped = 5.0 * noise;  // below the threshold of 10 noise, above the noise
  EXPECT_EQ(decide({1.0, 1001.0 * dropped, dropped}, scale).verdict, Verdict::clear);
  EXPECT_EQ(decide({1.0, 999.0 * dropped, dropped}, scale).verdict, Verdict::unclear);
}

// For matrices of a thousand rows the threshold itself, 1e4 noise, is above 1e3 noise.
TEST(DecideRank, OfLargeMatricesNeedsDistanceFromTheThreshold) {
  const RankScale scale{noise, 1.0, 1000, 0.0};
  EXPECT_EQ(decide({1.0, 2.9 * threshold(1000)}, scale).verdict, Verdict::unclear);
  EXPECT_EQ(decide({1.0, 3.1 * threshold(1000)}, scale).verdict, Verdict::clear);
}

TEST(DecideRank, OfValuesThatAreAllKeptIsJudgedByTheNoise) {
  EXPECT_EQ(decide({1.0, 0.5}, {noise, 1.0, 2, 0.0}).verdict, Verdict::clear);
  EXPECT_DOUBLE_EQ(decide({1.0, 0.5}, {noise, 1.0, 2, 0.0}).gap, 0.5 / noise);
}

TEST(DecideRank, OfZeroMatricesIsZeroAndClear) {
  for (const std::vector<double>& values : {std::vector<double>{}, {0.0}, {0.0, 0.0}, {1e-13}})
    for (double norm : {0.0, 1.0}) {
      const RankDecision decision = decide(values, {norm * noise, norm, 1, 0.0});
      if (!values.empty() && values[0] > norm * threshold(1)) continue;
      EXPECT_EQ(decision.rank, 0);
      EXPECT_EQ(decision.kept, 0.0);
      EXPECT_EQ(decision.verdict, Verdict::clear);
      EXPECT_GE(decision.gap, clear_gap);
    }
}

TEST(DecideRank, WithoutAnyNoiseKeepsEverythingButZero) {
  const RankDecision decision = decide({1.0, 1e-300, 0.0}, {0.0, 1.0, 3, 0.0});
  EXPECT_EQ(decision.rank, 2);
  EXPECT_EQ(decision.verdict, Verdict::clear);
  EXPECT_GE(decision.gap, clear_gap);
}

// rank_tol is relative to the norm, and the word of the user is final.
TEST(DecideRank, FollowsTheToleranceOfTheUser) {
  const RankScale scale{noise, 100.0, 5, 1e-3};
  EXPECT_EQ(decide({1.0, 0.1001}, scale).rank, 2);
  EXPECT_EQ(decide({1.0, 0.0999}, scale).rank, 1);
  EXPECT_EQ(decide({1.0, 0.0999}, scale).verdict, Verdict::user);
  EXPECT_EQ(decide({0.0}, scale).verdict, Verdict::user);
  // Also below the noise.
  EXPECT_EQ(decide({1.0, 1e-14}, {noise, 1.0, 5, 1e-15}).rank, 2);
}

// Thousands that differ by the number of their block alone take the place of one.
TEST(KeptDecisions, AreThoseThatWereMade) {
  std::vector<RankDecision> decisions;
  for (int stage = 0; stage < 1000; ++stage) {
    decisions.push_back({.t = 1.0, .stage = stage, .subject = Subject::block, .rows = 1, .cols = 1, .rank = 1});
    decisions.back().kept = stage == 500 ? 0.5 : 1.0;
  }
  decisions.push_back(decisions.back());  // of the same stage
  decisions.push_back({.level = 1, .verdict = Verdict::unclear});
  const KeptDecisions kept(decisions);
  EXPECT_EQ(kept.size(), decisions.size());
  EXPECT_EQ(kept.all(), decisions);
  for (std::size_t i : {0, 499, 500, 501, 999, 1000, 1001}) EXPECT_EQ(kept[i], decisions[i]) << i;
  EXPECT_EQ(kept.different().size(), 5u);
  EXPECT_EQ(smallest_kept(kept.different()), smallest_kept(decisions));
  EXPECT_TRUE(KeptDecisions().empty());
  EXPECT_TRUE(KeptDecisions(std::vector<RankDecision>()).all().empty());
}

}  // namespace sfdae::core
