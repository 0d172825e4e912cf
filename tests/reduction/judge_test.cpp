// SPDX-License-Identifier: BSD-3-Clause
// Noise is carried from stage to stage, decisions are recorded, doubtful ones read again.
#include "reduction/judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sfdae::core {

namespace {

// 2 x 2 data with |E_0| = e, |A_0| = a, |E_1| = e1; the noise of level 1 is `error` or rounding.
TaylorData data_of(double e, double a, double e1 = 0.0, double error = 0.0) {
  TaylorData data;
  data.resize(2, 2, {1, 1, 0});
  for (int k = 0; k <= 1; ++k) {
    fill(data.E(k), 0.0);
    fill(data.A(k), 0.0);
  }
  data.E(0)(0, 0) = e;
  data.A(0)(0, 0) = a;
  data.E(1)(0, 0) = e1;
  data.measure();
  std::fill(data.row_scale.begin(), data.row_scale.end(), 1.0);
  data.errors('E', 1)[0] = error * e;
  data.t = 0.75;
  return data;
}

Matrix diagonal(double first, double second) {
  Matrix r(2, 2);
  r(0, 0) = first;
  r(1, 1) = second;
  return r;
}

}  // namespace

// A known rank does not fit where its last pivot has vanished: nothing can be solved with that.
TEST(Judge, TakesNoKnownRankWithVanishedPivots) {
  const TaylorData data = data_of(1.0, 1.0);
  RankSequence known;
  known.add(2);
  Judge::Settings settings;
  settings.known_ranks = &known;
  Judge vanished(data, 1, settings, nullptr), tiny(data, 1, settings, nullptr);
  EXPECT_EQ(vanished.decide_diagonal_block(diagonal(1.0, 0.0), {}), 1);
  EXPECT_FALSE(vanished.fits_known_ranks());
  EXPECT_EQ(tiny.decide_diagonal_block(diagonal(1.0, 1e-200), {}), 2);
  EXPECT_TRUE(tiny.fits_known_ranks());
  Judge of_array(data, 1, settings, nullptr), of_singular_array(data, 1, settings, nullptr);
  EXPECT_EQ(of_array.decide_array({3.0, 2.0, 0.0}, 4, 6), 2);
  EXPECT_TRUE(of_array.fits_known_ranks());
  EXPECT_EQ(of_singular_array.decide_array({3.0, 0.0, 0.0}, 4, 6), 1);
  EXPECT_FALSE(of_singular_array.fits_known_ranks());
}

TEST(Judge, RecordsWhatItDecidedAndWhere) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 1, settings, &log);
  EXPECT_EQ(judge.decide_diagonal_block(diagonal(1.0, 0.0), {}), 1);
  EXPECT_EQ(judge.decide_constraints(diagonal(1.0, 0.5), {}), 2);
  EXPECT_EQ(judge.decide_differential(diagonal(0.0, 0.0), {}), 0);
  ASSERT_EQ(log.size(), 3u);
  const Subject subjects[] = {Subject::stage, Subject::constraints, Subject::differential};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(log[k].subject, subjects[k]);
    EXPECT_EQ(log[k].t, 0.75);
    EXPECT_EQ(log[k].level, 1);
    EXPECT_EQ(log[k].rows, 2);
    EXPECT_EQ(log[k].cols, 2);
  }
  EXPECT_EQ(log[0].stage, 2);  // the diagonal block is met first at stage level + 1
  EXPECT_TRUE(judge.all_clear());
}

// E_0: rounding alone. Later stages: eps / p relative to the norm of the stage, eps that of the derivatives and p the
// smallest pivot so far.
TEST(Judge, NoiseOfStagesGrowsWithTheInverseOfTheSmallestPivot) {
  const TaylorData data = data_of(4.0, 1.0, 2.0, 1e-9);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 1, settings, &log);
  judge.decide_diagonal_block(diagonal(4.0, 0.4), {});
  EXPECT_DOUBLE_EQ(log[0].noise, unit_roundoff);
  EXPECT_DOUBLE_EQ(judge.smallest_pivot(), 0.1);
  judge.decide_stage(1, diagonal(2.0, 1.0), {}, 4.0);
  EXPECT_DOUBLE_EQ(log[1].noise, 1e-9 / 0.1);
  EXPECT_DOUBLE_EQ(judge.smallest_pivot(), 0.1);  // 1/4 is larger
}

// Rows carried may be rounding errors of E_0 alone: a stage is never measured by less than E_0.
TEST(Judge, StagesSmallerThanEAreMeasuredByE) {
  const TaylorData data = data_of(4.0, 1.0);
  const Judge::Settings settings;
  Judge judge(data, 1, settings, nullptr);
  EXPECT_EQ(judge.decide_stage(1, diagonal(1e-17, 0.0), {}, 1e-17), 0);
  EXPECT_EQ(judge.decide_stage(1, diagonal(1e-10, 0.0), {}, 1e-10), 1);
}

// A^: eps |A| / p relative to |A|.  E T2: eps |E_0| max(1, |A| / (p sigma_a)) relative to |E_0|.
TEST(Judge, NoiseOfConstraintsAndOfET2IsPropagated) {
  const TaylorData data = data_of(4.0, 8.0);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  judge.decide_diagonal_block(diagonal(4.0, 0.04), {});
  EXPECT_DOUBLE_EQ(judge.smallest_pivot(), 0.01);
  judge.decide_constraints(diagonal(8.0, 0.8), {});  // sigma_a = 0.1 |A|
  EXPECT_DOUBLE_EQ(log[1].noise, unit_roundoff / 0.01);
  EXPECT_DOUBLE_EQ(log[1].kept, 0.1);
  EXPECT_DOUBLE_EQ(judge.kept_constraints(), 0.1);
  judge.decide_differential(diagonal(2.0, 0.0), {});
  EXPECT_DOUBLE_EQ(log[2].noise, unit_roundoff / (0.01 * 0.1));
  EXPECT_DOUBLE_EQ(judge.kept_differential(), 0.5);
}

// T2 is the identity then: E T2 = E carries no errors but its own.
TEST(Judge, WithoutConstraintsET2HasTheNoiseOfE) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  judge.decide_diagonal_block(diagonal(1.0, 1e-6), {});
  judge.decide_differential(diagonal(1.0, 1e-6), {});
  EXPECT_DOUBLE_EQ(log[1].noise, unit_roundoff);
}

TEST(Judge, WhereNoiseIsMeasuredItIsNotPropagated) {
  const TaylorData data = data_of(1.0, 1.0);
  Judge::Settings settings;
  settings.noise = NoiseModel::data;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  judge.decide_diagonal_block(diagonal(1.0, 1e-6), {});
  judge.decide_constraints(diagonal(1.0, 1e-6), {});
  judge.decide_differential(diagonal(1.0, 1e-6), {});
  EXPECT_DOUBLE_EQ(log[1].noise, unit_roundoff);
  EXPECT_DOUBLE_EQ(log[2].noise, unit_roundoff);
}

// E T2 = rounding errors of size 1e-13: noise propagated through p sigma_a = 1e-3 calls it zero, which judging
// against |E| alone would not.
TEST(Judge, RoundingErrorsInET2AreZero) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  judge.decide_diagonal_block(diagonal(1.0, 1e-2), {});
  judge.decide_constraints(diagonal(1.0, 1e-1), {});
  EXPECT_EQ(judge.decide_differential(diagonal(1e-13, 1e-14), {}), 0);
}

TEST(Judge, WithoutLogDecidesTheSameAndKeepsNoOriginals) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  Judge judge(data, 0, settings, nullptr);
  EXPECT_FALSE(judge.keeps_originals());
  EXPECT_EQ(judge.decide_diagonal_block(diagonal(1.0, 1e-20), {}), 1);
  EXPECT_EQ(judge.decide_diagonal_block(diagonal(1.0, 1e-13), {}), 2);
  EXPECT_FALSE(judge.all_clear());
}

// Pivots 1 and 1e-13 are 900 roundings apart: not clear. The matrix they come from decides by its singular values.
TEST(Judge, ReadsDoubtfulPivotsAgainBySingularValues) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  for (double second : {1e-13, 1e-3, 0.0}) {
    std::vector<RankDecision> log;
    Judge judge(data, 0, settings, &log);
    EXPECT_TRUE(judge.keeps_originals());
    const Matrix original = diagonal(1.0, second);
    EXPECT_EQ(judge.decide_diagonal_block(diagonal(1.0, 1e-13), original), second == 0.0 ? 1 : 2);
    EXPECT_EQ(log[0].verdict, second == 1e-13 ? Verdict::unclear : Verdict::confirmed);
    EXPECT_EQ(judge.all_clear(), second != 1e-13);
  }
}

TEST(Judge, BySingularValuesIgnoresThePivots) {
  const TaylorData data = data_of(1.0, 1.0);
  Judge::Settings settings;
  settings.by_singular_values = true;
  Judge judge(data, 0, settings, nullptr);
  EXPECT_TRUE(judge.keeps_originals());
  EXPECT_EQ(judge.decide_constraints(diagonal(1.0, 1.0), diagonal(1.0, 0.0)), 1);
}

TEST(Judge, RankTolOverridesTheNoise) {
  const TaylorData data = data_of(1.0, 4.0);
  Judge::Settings settings;
  settings.rank_tol = 1e-3;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  EXPECT_EQ(judge.decide_stage(1, diagonal(1.0, 0.0039), {}, 4.0), 1);  // |stage| = 4
  EXPECT_EQ(judge.decide_stage(1, diagonal(1.0, 0.0041), {}, 4.0), 2);
  EXPECT_EQ(judge.decide_differential(diagonal(1.0, 0.0011), {}), 2);  // |E_0| = 1
  EXPECT_EQ(judge.decide_array({4.0, 0.0041, 0.0039}, 3, 3), 2);
  for (const RankDecision& decision : log) EXPECT_EQ(decision.verdict, Verdict::user);
}

TEST(Judge, OfTheWholeArrayUsesItsLargerDimension) {
  const TaylorData data = data_of(1.0, 1.0);
  const Judge::Settings settings;
  std::vector<RankDecision> log;
  Judge judge(data, 0, settings, &log);
  EXPECT_EQ(judge.decide_array({1.0, 1e-20}, 3, 40), 1);
  EXPECT_DOUBLE_EQ(log[0].threshold, 10.0 * 40 * unit_roundoff);
  EXPECT_EQ(log[0].subject, Subject::array);
  EXPECT_DOUBLE_EQ(judge.smallest_pivot(), 1.0);
}

// Whatever the values are: those near the point that the ranks are from tell nothing.
TEST(Judge, TakesKnownRanksInTheirOrder) {
  const TaylorData data = data_of(1.0, 2.0);
  RankSequence known;
  for (int rank : {1, 0, 2, 1}) known.add(rank);
  const Judge::Settings settings{0.0, false, NoiseModel::carried, &known};
  Judge judge(data, 1, settings, nullptr);
  EXPECT_EQ(judge.decide_diagonal_block(diagonal(0.25, 1.0), {}), 1);
  EXPECT_EQ(judge.decide_stage(1, diagonal(1.0, 1.0), {}, 1.0), 0);
  EXPECT_EQ(judge.decide_constraints(diagonal(1.0, 1e-30), {}), 2);
  EXPECT_EQ(judge.decide_differential(diagonal(0.5, 0.5), {}), 1);
  EXPECT_TRUE(judge.fits_known_ranks());
  EXPECT_EQ(judge.ranks().count, known.count);
  for (std::size_t k = 0; k < known.count; ++k) EXPECT_EQ(judge.ranks().rank[k], known.rank[k]) << k;
  EXPECT_EQ(judge.smallest_pivot(), 0.25);
  EXPECT_EQ(judge.kept_constraints(), 1e-30 / 2.0);
  EXPECT_EQ(judge.kept_differential(), 0.5);
}

TEST(Judge, TellsThatKnownRanksAreThoseOfOtherDecisions) {
  const TaylorData data = data_of(1.0, 1.0);
  RankSequence too_few, too_large;
  too_few.add(1);
  too_large.add(3);
  for (const RankSequence* known : {&too_few, &too_large}) {
    const Judge::Settings settings{0.0, false, NoiseModel::pivots, known};
    Judge judge(data, 1, settings, nullptr);
    EXPECT_LE(judge.decide_diagonal_block(diagonal(1.0, 1.0), {}), 2);
    EXPECT_LE(judge.decide_constraints(diagonal(1.0, 1.0), {}), 2);
    EXPECT_FALSE(judge.fits_known_ranks());
  }
}

// Along a jet with residuals an E_0 of their size may be nothing: |E_0| itself is no measure of its errors.
TEST(Judge, TakesAnEOfTheSizeOfResidualsForZero) {
  for (double residual : {0.0, 1e-9}) {
    TaylorData data = data_of(1e-9, 1.0);
    data.residual_noise = residual;
    const Judge::Settings settings{0.0, false, NoiseModel::pivots, nullptr};
    Judge judge(data, 0, settings, nullptr);
    EXPECT_EQ(judge.decide_diagonal_block(diagonal(1e-9, 0.0), {}), residual > 0.0 ? 0 : 1);
    EXPECT_EQ(judge.decide_constraints(diagonal(1.0, 0.0), {}), 1);
    EXPECT_EQ(judge.decide_differential(diagonal(1e-9, 0.0), {}), residual > 0.0 ? 0 : 1);
  }
}

}  // namespace sfdae::core
