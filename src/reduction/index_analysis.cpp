// Strangeness index and characteristic values of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/index_analysis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/balanced_units.h"
#include "reduction/index_search.h"

namespace sfdae::core {

namespace {

// Where the analysis is made, and on which side its other point is.
struct Place {
  double t, toward;
};

// What the analysis would say if the doubtful value were decided by rank_tol.
std::string result_with(CoefficientSource& problem, double t, AnalysisSettings settings, double rank_tol,
                        Arena& arena) {
  settings.rank_tol = rank_tol;
  const CharacteristicValues values = find_local_values(problem, t, settings, arena);
  return values.mu >= 0 ? "the characteristic values are " + describe(values)
                        : "no level up to max_index fulfils the hypothesis";
}

// rank_tol for either answer: the geometric mean of the value and what is below it (two digits, where that is not
// known) keeps it, three times the value drops it. Above one half nothing would be kept.
[[noreturn]] void report_unclear(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                                 const LevelResult& found, Arena& arena) {
  const RankDecision& decision = found.doubtful;
  // The value in doubt is the smallest one kept, or, where that stands clear or there is none, the largest one
  // dropped.
  const bool doubts_kept = decision.rank > 0 && (decision.gap < clear_gap || decision.dropped <= decision.noise);
  const double value = std::max(doubts_kept ? decision.kept : decision.dropped, decision.noise);
  const double below = doubts_kept ? std::max({decision.dropped, decision.noise, 1e-300}) : 1e-2 * value;
  const double keep_tol = std::min(std::sqrt(value * below), 0.5);
  const double drop_tol = std::min(3.0 * value, 0.5);
  const int rank = doubts_kept ? decision.rank : decision.rank + 1;
  const std::string kept = result_with(problem, t, settings, keep_tol, arena);
  const std::string dropped = result_with(problem, t, settings, drop_tol, arena);
  throw Failure(SFDAE_RANK_UNCLEAR,
                describe(decision) +
                    (found.follows ? " is not clear." : " does not fit the ranks of the level below.") +
                    format(" With rank %d ", rank) + kept + format("; with rank %d ", rank - 1) + dropped +
                    format(". Try rank_tol = %.1e or %.1e, or scale the equations.", keep_tol, drop_tol));
}

std::string describe_levels(const std::vector<CharacteristicValues>& levels, int m) {
  std::string text;
  for (std::size_t l = 0; l < levels.size(); ++l)
    text += format(" level %d: a = %d, rank(E T2) = %d of %d;", static_cast<int>(l), levels[l].a, levels[l].d,
                   m - levels[l].a - levels[l].v);
  return text;
}

IndexAnalysis search_at(CoefficientSource& problem, double t, const AnalysisSettings& settings, Arena& arena,
                        std::vector<RankDecision>& decisions) {
  IndexSearch upward(problem, t, settings, arena, &decisions);
  const SearchResult found = upward.search(settings.max_index);
  if (!found.last.clear) report_unclear(problem, t, settings, found.last, arena);
  if (found.values.mu < 0)
    throw Failure(SFDAE_INDEX_TOO_HIGH,
                  format("no strangeness index up to max_index = %d at t = %.15g:", settings.max_index, t) +
                      describe_levels(found.levels, problem.m()) +
                      " raise max_index, or check that the problem is regular.");
  IndexAnalysis analysis;
  analysis.values = found.values;
  analysis.t = t;
  analysis.time_scale = found.last.time_scale;
  analysis.v_hat = found.last.ranks.v_hat;
  analysis.rank_E = found.last.ranks.rank_E;
  analysis.noise = found.last.noise;
  return analysis;
}

// Far enough for a coefficient that vanishes at t to be seen (six digits above the rounding of t), near enough to
// stay on the same smooth piece, and no simple fraction of a period (docs/decisions/07-first-step.md).
double nearby_point(Place place, double time_scale) {
  const auto [t, toward] = place;
  constexpr double near = 0.7e-3, resolved_roundings = 1e6;
  const double distance = std::min(std::fabs(toward - t), time_scale) * near;
  const double resolvable = resolved_roundings * unit_roundoff * std::fabs(t);
  return t + std::copysign(std::min(std::max(distance, resolvable), std::fabs(toward - t)), toward - t);
}

// Units of the unknowns: columns of [E A] that differ by more than moderate_column_ratio are scaled to comparable
// size. Columns below smallest_column are left alone: they may be rounding errors
// (docs/decisions/06-units-of-unknowns.md).
Units choose_units(CoefficientSource& problem, double t) {
  constexpr double moderate_column_ratio = 1024.0, smallest_column = 1e-12;
  const std::size_t n = index(problem.n());
  std::vector<double> scale(n, 1.0);
  bool needed = false;
  // Scaling of rows and columns depends on each other: two sweeps.
  for (int sweep = 0; sweep < 2; ++sweep) {
    problem.set_units(scale);
    TaylorData data;
    const CallbackError error = problem.evaluate(t, {0, 0, -1}, 0.0, data);
    if (error.status != SFDAE_OK) error.raise();
    std::vector<double> size(n);
    double largest = 0.0, smallest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < n; ++j) {
      const int column = static_cast<int>(j);
      size[j] = std::max(max_abs(data.E(0).column(column), data.m), max_abs(data.A(0).column(column), data.m));
      largest = std::max(largest, size[j]);
      if (size[j] > 0.0) smallest = std::min(smallest, size[j]);
    }
    needed = needed || largest > moderate_column_ratio * smallest;
    for (std::size_t j = 0; j < n; ++j)
      if (size[j] > smallest_column * largest) scale[j] *= std::ldexp(1.0, -std::ilogb(size[j]));
  }
  return needed ? Units(scale) : Units();
}

// The analysis in the units of the unknowns that the problem has.
IndexAnalysis analyze_in_units(CoefficientSource& problem, Place place, const AnalysisSettings& settings,
                               Arena& arena, std::vector<RankDecision>& decisions) {
  const double t = place.t;
  IndexAnalysis here = search_at(problem, t, settings, arena, decisions);
  if (!problem.is_constant()) {
    const double nearby = nearby_point(place, here.time_scale);
    const IndexAnalysis there = search_at(problem, nearby, settings, arena, decisions);
    here.rank_E_constant = here.rank_E == there.rank_E;
    const int mu = std::max(here.values.mu, there.values.mu);
    if (here.values.mu != there.values.mu) {
      // At the level that counts both points must agree: E = [0 t; 0 0], A = I does at mu = 1.
      const bool raise_here = here.values.mu < mu;
      IndexSearch again(problem, raise_here ? t : nearby, settings, arena, &decisions);
      const CharacteristicValues raised = again.values_at(mu);
      if (raise_here) {
        here.values = raised;
        const LevelResult found = again.determine_confirmed(mu);
        here.time_scale = found.time_scale;
        here.v_hat = found.ranks.v_hat;
        here.noise = found.noise;
      }
      const CharacteristicValues& other = raise_here ? there.values : raised;
      if (!(here.values == other))
        throw Failure(SFDAE_CHARACTERISTICS_CHANGED, format("t = %.15g is an exceptional point: ", t) +
                                                         describe(here.values) + " there, but " + describe(other) +
                                                         format(" at t = %.15g. Start beside it.", nearby));
    } else if (!(here.values == there.values)) {
      throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                    format("t = %.15g is an exceptional point: ", t) + describe(here.values) + " there, but " +
                        describe(there.values) + format(" at t = %.15g. Start beside it.", nearby));
    }
  }
  return here;
}

double smallest_gap(const std::vector<RankDecision>& decisions) {
  double gap = std::numeric_limits<double>::infinity();
  for (const RankDecision& decision : decisions) gap = std::min(gap, decision.gap);
  return gap;
}

double smallest_kept(const std::vector<RankDecision>& decisions) {
  double kept = 1.0;
  for (const RankDecision& decision : decisions)
    if (decision.rank > 0) kept = std::min(kept, decision.kept);
  return kept;
}

// Analyzes the problem in faster and faster units of time (1, 1/8, ... 1.5e-11), the units of the unknowns balanced
// for each: docs/decisions/21-fast-units-of-time.md, with the figures behind the constants. What is clear by far in
// two of them, supported by a third, and contradicted in none, counts: the result with the largest gap. Units that
// are much too fast shrink every value by the same factor from level to level: where the smallest one kept is small,
// the next one would be lost among rounding errors, and ranks agree in being wrong.
struct UnitsResult {
  IndexAnalysis analysis;
  std::vector<RankDecision> decisions;
  Units units;
};

std::optional<UnitsResult> analyze_in_other_units(CoefficientSource& problem, Place place,
                                                  const AnalysisSettings& settings, Arena& arena) {
  constexpr double clear_by_far = 1e6, supporting = 1e4, ratio = 1.0 / 8.0, least_kept = 1e-6;
  constexpr int num_units = 13;
  std::optional<UnitsResult> best;
  int agreeing = 0, clear = 0;
  double tau = 1.0;
  for (int attempt = 0; attempt < num_units; ++attempt, tau *= ratio) {
    UnitsResult found;
    AnalysisSettings scaled = settings;
    scaled.time_scale = tau;
    try {
      found.units = balanced_units(problem, place.t, tau);
      problem.set_units(found.units);
      found.analysis = analyze_in_units(problem, place, scaled, arena, found.decisions);
    } catch (const Failure& failure) {
      if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
      continue;
    }
    const bool is_clear = std::all_of(found.decisions.begin(), found.decisions.end(),
                                      [](const RankDecision& d) { return d.verdict == Verdict::clear; });
    const double gap = smallest_gap(found.decisions);
    if (!is_clear || gap < supporting) continue;
    if (best && !(best->analysis.values == found.analysis.values)) return std::nullopt;
    ++agreeing;
    if (gap >= clear_by_far) ++clear;
    const bool is_best = !best || gap > smallest_gap(best->decisions);
    if (is_best) best = std::move(found);
    // After the clearest one faster units have nothing to add.
    if (agreeing >= 3 && clear >= 2 && smallest_kept(best->decisions) >= least_kept && !is_best) return best;
  }
  return std::nullopt;
}

}  // namespace

bool fits_dimensions(const IndexAnalysis& analysis, int m, int n) {
  const CharacteristicValues& values = analysis.values;
  return values.mu >= 0 && values.mu <= max_derivative_order && values.d >= 0 && values.a >= 0 &&
         values.d + values.a + values.v == m && values.d + values.a + values.u == n && analysis.v_hat >= 0 &&
         analysis.v_hat <= (values.mu + 1) * m && std::isfinite(analysis.time_scale) && analysis.time_scale > 0.0;
}

std::string describe(const CharacteristicValues& values) {
  if (values.mu < 0) return "undetermined";
  return format("mu = %d, d = %d, a = %d, u = %d, v = %d", values.mu, values.d, values.a, values.u, values.v);
}

std::string describe(const RankDecision& decision) {
  const char* subject = decision.subject == Subject::stage         ? "diagonal block"
                        : decision.subject == Subject::constraints ? "constraints"
                        : decision.subject == Subject::array       ? "derivative array"
                                                                   : "E T2";
  return format("rank decision at t = %.15g, level %d (%s, %d x %d): kept %.1e, dropped %.1e, noise %.1e (gap %.2g)",
                decision.t, decision.level, subject, decision.rows, decision.cols, decision.kept, decision.dropped,
                decision.noise, decision.gap);
}

CharacteristicValues find_local_values(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                                       Arena& arena) {
  try {
    IndexSearch upward(problem, t, settings, arena, nullptr);
    const SearchResult found = upward.search(settings.max_index);
    return found.last.clear ? found.values : CharacteristicValues{};
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
    return {};
  }
}

bool known_values_hold(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                       const IndexAnalysis& known, Arena& arena) {
  IndexSearch upward(problem, t, settings, arena, nullptr);
  PointRanks expected;
  expected.a = known.values.a;
  expected.d = known.values.d;
  expected.v_hat = known.v_hat;
  return upward.has_ranks(known.values.mu, known.time_scale, expected);
}

IndexAnalysis analyze_index(CoefficientSource& problem, double t, double toward, const AnalysisSettings& settings,
                            Arena& arena, std::vector<RankDecision>& decisions) {
  decisions.clear();
  problem.set_units({});
  problem.set_units(choose_units(problem, t));
  try {
    return analyze_in_units(problem, {t, toward}, settings, arena, decisions);
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_RANK_UNCLEAR || settings.rank_tol > 0.0 || settings.time_scale > 0.0) throw;
    if (std::optional<UnitsResult> found = analyze_in_other_units(problem, {t, toward}, settings, arena)) {
      problem.set_units(found->units);
      decisions = std::move(found->decisions);
      return found->analysis;
    }
    problem.set_units({});
    problem.set_units(choose_units(problem, t));
    throw;
  }
}

}  // namespace sfdae::core
