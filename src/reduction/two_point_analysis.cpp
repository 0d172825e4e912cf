// The analysis at a point and at a second one nearby.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/two_point_analysis.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "problem/failure.h"

namespace sfdae::core {

namespace {

std::string describe_levels(const std::vector<CharacteristicValues>& levels, int m) {
  std::string text;
  for (std::size_t l = 0; l < levels.size(); ++l)
    text += format(" level %d: a = %d, rank(E T2) = %d of %d;", static_cast<int>(l), levels[l].a, levels[l].d,
                   m - levels[l].a - levels[l].v);
  return text;
}

IndexAnalysis to_analysis(const SearchTask& task, double t, const SearchResult& found) {
  IndexAnalysis analysis;
  analysis.values = found.values;
  analysis.t = t;
  analysis.time_scale = found.last.time_scale;
  analysis.v_hat = found.last.ranks.v_hat;
  analysis.rank_E = found.last.ranks.rank_E;
  analysis.noise = found.last.noise;
  analysis.rows = task.units != nullptr ? RowScaling::timed : task.settings.rows;
  if (task.certified) analysis.certified_ranks = found.last.known_ranks;
  return analysis;
}

AnalysisOutcome search_at(const SearchTask& task, double t) {
  IndexSearch upward(task, t);
  const SearchResult found = upward.search(task.settings.max_index);
  if (!task.certified && !found.last.clear)
    throw Failure(SFDAE_RANK_UNCLEAR,
                  describe(found.last.doubtful) +
                      (found.last.follows ? " is not clear." : " does not fit the ranks of the level below."));
  if (found.values.mu < 0)
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("no strangeness index up to max_index = %d at t = %.15g:", task.settings.max_index, t) +
                      describe_levels(found.levels, task.problem.m()) +
                      " raise max_index, or check that the problem is regular.");
  return {to_analysis(task, t, found), found.significance, found.is_clear};
}

// Far enough for a coefficient that vanishes at t to be seen (six digits above the rounding of t), near enough to
// stay on the same smooth piece, and no simple fraction of a period (docs/design/error_control.md).
double nearby_point(Place place, double time_scale) {
  const auto [t, toward] = place;
  constexpr double near = 0.7e-3, resolved_roundings = 1e6;
  const double distance = std::min(std::fabs(toward - t), time_scale) * near;
  const double resolvable = resolved_roundings * unit_roundoff * std::fabs(t);
  return t + std::copysign(std::min(std::max(distance, resolvable), std::fabs(toward - t)), toward - t);
}

[[noreturn]] void report_exceptional(const IndexAnalysis& here, const CharacteristicValues& there, double nearby) {
  throw Failure(SFDAE_CHARACTERISTICS_CHANGED, format("t = %.15g is an exceptional point: ", here.t) +
                                                   describe(here.values) + " there, but " + describe(there) +
                                                   format(" at t = %.15g. Start beside it.", nearby));
}

// At the level that counts both points must agree: E = [0 t; 0 0], A = I does at mu = 1.
void raise_to_level(const SearchTask& task, int mu, double nearby, AnalysisOutcome& here,
                    CharacteristicValues& there) {
  IndexAnalysis& analysis = here.analysis;
  const bool raise_here = analysis.values.mu < mu;
  IndexSearch again(task, raise_here ? analysis.t : nearby);
  const CharacteristicValues raised = again.values_at(mu);
  if (!raise_here) {
    there = raised;
    return;
  }
  const LevelResult found = again.determine_confirmed(mu);
  analysis.values = raised;
  analysis.time_scale = found.time_scale;
  analysis.v_hat = found.ranks.v_hat;
  analysis.noise = found.noise;
  if (task.certified) analysis.certified_ranks = found.known_ranks;
  here.significance.join(found.significance);
  here.is_clear = here.is_clear && found.clear;
}

// Result of level mu, found at t, at the nearby point if it is clear and the same; the levels below need not be
// examined there then: the larger index of the two points counts, and without redundant rows at level mu there are none
// below. Ranks along jets and redundant equations are followed from level to level as at t.
std::optional<AnalysisOutcome> same_at_level(const SearchTask& task, double nearby, const IndexAnalysis& here) {
  const CharacteristicValues& values = here.values;
  if (values.mu < 1 || values.v > 0 || here.v_hat > 0 || task.problem.is_along_jet()) return std::nullopt;
  std::vector<RankDecision> decisions;
  SearchTask alone = task;
  alone.log = task.log != nullptr ? &decisions : nullptr;
  const LevelResult found = IndexSearch(alone, nearby).determine_confirmed(values.mu);
  const PointRanks& ranks = found.ranks;
  if (!found.clear || ranks.a != values.a || ranks.d != values.d || ranks.v_hat != 0) return std::nullopt;
  if (task.log != nullptr) task.log->insert(task.log->end(), decisions.begin(), decisions.end());
  IndexAnalysis analysis = here;
  analysis.rank_E = ranks.rank_E;
  return AnalysisOutcome{analysis, found.significance, true};
}

}  // namespace

std::optional<IndexAnalysis> analyze_by_precedent(const SearchTask& task, Place place) {
  const Precedent& precedent = task.settings.precedent;
  if (precedent.values.mu < 0) return std::nullopt;
  try {
    IndexAnalysis found = search_at(task, place.t).analysis;
    if (!(found.values == precedent.values) || found.rank_E != precedent.rank_E) return std::nullopt;
    found.rank_E_constant = precedent.rank_E_constant;
    found.by_precedent = true;
    return found;
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_RANK_UNCLEAR && failure.status() != SFDAE_INDEX_TOO_HIGH) throw;
    return std::nullopt;
  }
}

AnalysisOutcome analyze_at_two_points(const SearchTask& task, Place place) {
  AnalysisOutcome here = search_at(task, place.t);
  if (task.problem.is_constant()) return here;
  const double nearby = nearby_point(place, here.analysis.time_scale);
  const std::optional<AnalysisOutcome> same = same_at_level(task, nearby, here.analysis);
  const AnalysisOutcome at_nearby = same ? *same : search_at(task, nearby);
  CharacteristicValues there = at_nearby.analysis.values;
  here.significance.join(at_nearby.significance);
  here.is_clear = here.is_clear && at_nearby.is_clear;
  here.analysis.rank_E_constant = here.analysis.rank_E == at_nearby.analysis.rank_E;
  if (here.analysis.values.mu != there.mu)
    raise_to_level(task, std::max(here.analysis.values.mu, there.mu), nearby, here, there);
  if (!(here.analysis.values == there)) report_exceptional(here.analysis, there, nearby);
  return here;
}

}  // namespace sfdae::core
