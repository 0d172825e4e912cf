// The analysis along a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/jet_analysis.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "problem/failure.h"
#include "reduction/balanced_units.h"
#include "reduction/certificate.h"
#include "reduction/fast_units.h"
#include "reduction/unclear_ranks.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

// Limit on rows of the array: six copies of more would take longer than all the rest. (Chosen.)
constexpr int most_array_rows = 300;

// True if one matrix, without a chain of decisions, shows that nothing is redundant although an analysis found
// redundancy: the rows of the array of its level, in balanced units. The source keeps these units.
bool is_redundancy_refuted(CoefficientSource& source, Place place, const IndexAnalysis& analysis) {
  if (analysis.v_hat == 0 || (analysis.values.mu + 1) * source.m() > most_array_rows) return false;
  const UsualUnits usual = usual_units(source, place.t);
  const BalancedUnits balanced = balanced_units(data_in_units(source, place.t, usual.units), usual.units);
  source.set_units(balanced.unknowns);
  TaylorData data;
  const int level = analysis.values.mu;
  const CallbackError error = source.evaluate(place.t, {level, level, -1}, balanced.time, data, RowScaling::timed);
  if (error.status != SFDAE_OK) error.raise();
  return has_independent_rows(data, level, balanced);
}

// Analyzes the source in faster and faster units of time (1, 1/8, ... 1.5e-11), the units of the unknowns balanced for
// each (docs/design/scaling_and_units.md, with the figures behind the constants). A result clear by far in two of them,
// supported by a third, and contradicted in none, counts: the one with the largest gap. Units that are much too fast
// shrink every value by the same factor from level to level: if the smallest one kept is small, the next one would be
// lost among rounding errors, and ranks agree in being wrong.
struct UnitsResult {
  IndexAnalysis analysis;
  std::vector<RankDecision> decisions;
  Units units;
};

std::optional<UnitsResult> analyze_in_other_units(CoefficientSource& source, Place place,
                                                  const AnalysisSettings& settings, Arena& arena) {
  constexpr double clear_by_far = 1e6, supporting = 1e4, ratio = 1.0 / 8.0, least_kept = 1e-6;
  constexpr int num_units = 13;
  std::optional<UnitsResult> best;
  int agreeing = 0, clear = 0;
  double tau = 1.0;
  const auto counts = [&] {
    return best && agreeing >= 3 && clear >= 2 && smallest_kept(best->decisions) >= least_kept;
  };
  for (int attempt = 0; attempt < num_units; ++attempt, tau *= ratio) {
    UnitsResult found;
    AnalysisSettings scaled = settings;
    scaled.precedent = {};
    scaled.time_scale = tau;
    try {
      found.units = fast_units(source, place.t, tau);
      source.set_units(found.units);
      found.analysis = analyze_at_two_points({source, scaled, arena, &found.decisions}, place).analysis;
    } catch (const Failure& failure) {
      if (ends_everything(failure.status())) throw;
      continue;
    }
    const bool is_clear = std::all_of(found.decisions.begin(), found.decisions.end(),
                                      [](const RankDecision& d) { return d.verdict == Verdict::clear; });
    const double gap = smallest_gap(found.decisions);
    if (!is_clear || gap < supporting || is_redundancy_refuted(source, place, found.analysis)) continue;
    if (best && !(best->analysis.values == found.analysis.values)) return std::nullopt;
    ++agreeing;
    if (gap >= clear_by_far) ++clear;
    const bool is_best = !best || gap > smallest_gap(best->decisions);
    if (is_best) best = std::move(found);
    // After the clearest one faster units have nothing to add.
    if (counts() && !is_best) return best;
  }
  return counts() ? best : std::nullopt;
}

}  // namespace

IndexAnalysis analyze_along_jet(CoefficientSource& source, Place place, const AnalysisSettings& settings,
                                Arena& arena, std::vector<RankDecision>& decisions) {
  const Units usual = usual_units(source, place.t).units;
  source.set_units(usual);
  if (const auto found = analyze_by_precedent({source, settings, arena, &decisions}, place)) return *found;
  decisions.clear();
  AnalysisSettings anew = settings;
  anew.precedent = {};
  const SearchTask task{source, anew, arena, &decisions};
  std::string what;
  std::optional<Failure> lacks_derivatives;  // other units may not need them
  try {
    const IndexAnalysis found = analyze_at_two_points(task, place).analysis;
    const bool is_decided =
        settings.rank_tol > 0.0 || settings.time_scale > 0.0 ||
        (smallest_gap(decisions) >= gap_of_singular && smallest_kept(decisions) >= kept_of_singular);
    const bool is_refuted = !is_decided && is_redundancy_refuted(source, place, found);
    source.set_units(usual);
    if (!is_refuted) return found;
    what = format("at t = %.15g the decisions in the units given say that equations are redundant, ", place.t) +
           describe(found.values) + ", which all rows of the array together refute.";
  } catch (const Failure& failure) {
    const bool is_of_units = failure.status() == SFDAE_RANK_UNCLEAR || failure.status() == SFDAE_ORDER_MISSING;
    if (!is_of_units || settings.rank_tol > 0.0 || settings.time_scale > 0.0) throw;
    if (failure.status() == SFDAE_ORDER_MISSING) lacks_derivatives = failure;
    what = failure.what();
  }
  if (std::optional<UnitsResult> found = analyze_in_other_units(source, place, settings, arena)) {
    source.set_units(found->units);
    decisions = std::move(found->decisions);
    return found->analysis;
  }
  source.set_units(usual);
  if (lacks_derivatives) throw *lacks_derivatives;
  throw Failure(SFDAE_RANK_UNCLEAR, what + neighbouring_ranks(task));
}

}  // namespace sfdae::core
