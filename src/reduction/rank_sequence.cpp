// The ranks of a reduction.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/rank_sequence.h"

#include <algorithm>
#include <array>

#include "linalg/index.h"
#include "reduction/elimination.h"

namespace sfdae::core {

void archive_ranks(Archive& archive, RankSequence& ranks) {
  int count = static_cast<int>(ranks.count);
  archive.small(count);
  archive_ranks(archive, ranks, count);
}

void archive_ranks(Archive& archive, RankSequence& ranks, int count) {
  if (count < 0 || count > static_cast<int>(ranks.rank.size())) throw DamagedArchive();
  ranks.count = index(count);
  archive.small(ranks.rank.data(), ranks.count);
  if (std::any_of(ranks.rank.begin(), ranks.rank.begin() + count, [](int rank) { return rank < 0; }))
    throw DamagedArchive();
}

namespace {

// build: builds the form from the result of an elimination.
template <class Build>
RankResult eliminate_for_ranks(const TaylorData& data, int level, const Judge::Settings& settings,
                               RankWorkspace workspace, Build build) {
  Arena& arena = workspace.arena;
  Judge judge(data, level, settings, nullptr);
  const Arena::Frame frame(arena);
  const View rhs = arena.matrix((level + 1) * data.m, 1);
  fill(rhs, 0.0);
  const Carried carried = eliminate(data, level, rhs, 1, judge, arena);
  workspace.form.resize(data.m, data.n, 0, carried.rows);
  RankResult found;
  found.ranks = build(carried, judge);
  found.list = judge.ranks();
  return found;
}

}  // namespace

RankResult determine_ranks(const TaylorData& data, int level, const Judge::Settings& settings,
                           RankWorkspace workspace) {
  return eliminate_for_ranks(data, level, settings, workspace, [&](const Carried& carried, Judge& judge) {
    return workspace.form.build(data, carried, {}, LeadingTerm::identity, judge, workspace.arena);
  });
}

RankResult find_ranks(const TaylorData& data, int level, const Judge::Settings& settings, RankWorkspace workspace) {
  return eliminate_for_ranks(data, level, settings, workspace, [&](const Carried& carried, Judge& judge) {
    return workspace.form.find_ranks(data, carried, judge, workspace.arena);
  });
}

bool stages_rise(const RankSequence& list, int level, int full_rank) {
  if (list.rank[0] == full_rank) return true;  // no rank is left for later stages
  for (std::size_t k = 2; k <= index(level); ++k)
    if (list.rank[k] < list.rank[k - 1]) return false;
  return true;
}

namespace {

bool has_known_values(const RankResult& found, const TaylorData& data, int level, const IndexAnalysis& known) {
  const CharacteristicValues& values = known.values;
  const int v_hat = known.v_hat + (level - values.mu) * values.v;
  return found.ranks.a == values.a && found.ranks.d == values.d && found.ranks.v_hat == v_hat &&
         (!data.differentiations.empty() || stages_rise(found.list, level, std::min(data.m, data.n)));
}

// find: ranks by a noise model. If the analysis had to use the errors of the data alone, the others would find the
// values changed at every point.
template <class Find>
std::optional<RankSequence> first_match(const TaylorData& data, int level, const IndexAnalysis& known, Find find) {
  constexpr std::array usual = {NoiseModel::pivots, NoiseModel::carried, NoiseModel::data};
  constexpr std::array least = {NoiseModel::data, NoiseModel::pivots, NoiseModel::carried};
  for (NoiseModel noise : known.noise == NoiseModel::data ? least : usual) {
    const RankResult found = find(noise);
    if (has_known_values(found, data, level, known)) return found.list;
  }
  return std::nullopt;
}

}  // namespace

std::optional<RankSequence> matching_ranks(const TaylorData& data, int level, const IndexAnalysis& known,
                                           double rank_tol, RankWorkspace workspace) {
  return first_match(data, level, known, [&](NoiseModel noise) {
    return find_ranks(data, level, {rank_tol, false, noise, nullptr}, workspace);
  });
}

bool matching_form(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                   RankWorkspace workspace) {
  return first_match(data, level, known,
                     [&](NoiseModel noise) {
                       return determine_ranks(data, level, {rank_tol, false, noise, nullptr}, workspace);
                     })
      .has_value();
}

bool reduce_with_known_values(const TaylorData& data, int level, const IndexAnalysis& known, double rank_tol,
                              RankWorkspace workspace, StoredReduction& reduction) {
  Arena& arena = workspace.arena;
  NullSpaceForm& form = workspace.form;
  const auto reduce = [&](const RankSequence* ranks) {
    const Judge::Settings settings{rank_tol, false, NoiseModel::pivots, ranks};
    Judge judge(data, level, settings, nullptr);
    const Arena::Frame frame(arena);
    const Carried carried = eliminate(data, level, data.f_stack(level), 1, judge, arena, &reduction.elimination);
    form.resize(data.m, data.n, 0, carried.rows);
    RankResult found;
    found.ranks = reduction.has_form ? form.build(data, carried, {}, LeadingTerm::identity, judge, arena)
                                     : form.find_ranks(data, carried, judge, arena);
    found.list = judge.ranks();
    reduction.rank_E = carried.rank_E;
    reduction.kept = judge.kept_constraints() * judge.smallest_pivot();
    return found;
  };
  if (has_known_values(reduce(nullptr), data, level, known)) return true;
  const std::optional<RankSequence> ranks = matching_ranks(data, level, known, rank_tol, workspace);
  if (ranks) reduce(&*ranks);
  return ranks.has_value();
}

}  // namespace sfdae::core
