// SPDX-License-Identifier: BSD-3-Clause
// Ranks that are read once serve the elimination that is kept.
#include "reduction/rank_sequence.h"

#include <gtest/gtest.h>

#include <memory>

#include "c_api/problems.h"
#include "family_problem.h"
#include "linear_family.h"
#include "matrix_checks.h"
#include "problem/linear_problem.h"
#include "reduction/elimination.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using Family = std::shared_ptr<const sfdae_test::LinearFamily>;

std::vector<Family> families() {
  std::vector<Family> all;
  for (int mu = 0; mu <= 3; ++mu) all.emplace_back(sfdae_test::kron(8, mu));
  all.emplace_back(sfdae_test::kron(8, 1, 0.5, 2));
  all.emplace_back(sfdae_test::chain(6, 2));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) all.emplace_back(sfdae_test::random_family(seed));
  return all;
}

struct Analyzed {
  sfdae_test::FamilyProblem callbacks;
  LinearProblem problem;
  Arena arena;
  NullSpaceForm form;
  AnalysisSettings settings;
  std::vector<RankDecision> decisions;
  IndexAnalysis analysis;
  explicit Analyzed(const Family& family)
      : callbacks(family),
        problem(functions_of(callbacks.problem)),
        analysis(analyze_index(problem, 0.2, 1.0, settings, arena, decisions)) {}
  TaylorData data_at(double t, int level) {
    TaylorData data;
    EXPECT_EQ(problem.evaluate(t, {level, level, level}, analysis.time_scale, data).status, SFDAE_OK);
    return data;
  }
};

}  // namespace

TEST(RankResult, AgreesWithTheValuesOfTheFamily) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    Analyzed p(family);
    const auto expected = family->values();
    for (NoiseModel noise : {NoiseModel::carried, NoiseModel::pivots}) {
      const RankResult found =
          determine_ranks(p.data_at(0.4, expected.mu), expected.mu, {0.0, false, noise, nullptr}, {p.arena, p.form});
      EXPECT_EQ(found.ranks.a, expected.a);
      EXPECT_EQ(found.ranks.d, expected.d);
    }
  }
}

// Level mu + 1 has v more redundant rows, and the same a and d.
TEST(RankResult, MatchesKnownValuesAtTheirLevelAndAbove) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    Analyzed p(family);
    const CharacteristicValues& values = p.analysis.values;
    for (int level = values.mu; level <= values.mu + 1; ++level) {
      const TaylorData data = p.data_at(0.4, level);
      const auto ranks = matching_ranks(data, level, p.analysis, 0.0, {p.arena, p.form});
      ASSERT_TRUE(ranks.has_value()) << level;
      const Judge::Settings settings{0.0, false, NoiseModel::pivots, &*ranks};
      Judge judge(data, level, settings, nullptr);
      const Arena::Frame frame(p.arena);
      const Carried carried = eliminate(data, level, data.f_stack(level), 1, judge, p.arena);
      EXPECT_TRUE(judge.fits_known_ranks());
      EXPECT_EQ(carried.rows, values.a + p.analysis.v_hat + (level - values.mu) * values.v);
    }
  }
}

// Coupled chains of a differential-algebraic system of index 4: 4 pivots in E_0 and none later but those of the
// shorter one.
TEST(RankResult, StagesRiseUnlessResidualsArePivots) {
  const auto list_of = [](std::initializer_list<int> ranks) {
    RankSequence list;
    for (const int rank : ranks) list.add(rank);
    return list;
  };
  EXPECT_TRUE(stages_rise(list_of({4, 0, 1, 1, 6}), 3, 6));
  EXPECT_FALSE(stages_rise(list_of({4, 1, 0, 1, 6}), 3, 6));
  EXPECT_TRUE(stages_rise(list_of({6, 4, 2}), 4, 6));
}

TEST(RankResult, MatchesNoOtherValues) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family->name());
    Analyzed p(family);
    const TaylorData data = p.data_at(0.4, p.analysis.values.mu);
    for (int change = 0; change < 3; ++change) {
      IndexAnalysis other = p.analysis;
      (change == 0 ? other.values.a : change == 1 ? other.values.d : other.v_hat) += 1;
      EXPECT_FALSE(matching_ranks(data, other.values.mu, other, 0.0, {p.arena, p.form}).has_value()) << change;
    }
  }
}

}  // namespace sfdae::core
