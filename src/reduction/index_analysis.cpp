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
#include "reduction/certificate.h"
#include "reduction/fast_units.h"
#include "reduction/two_point_analysis.h"
#include "reduction/unclear_ranks.h"

namespace sfdae::core {

namespace {

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

bool is_singular(const CharacteristicValues& values) { return values.u > 0 && values.v > 0; }

// Decisions that norms make with such a distance need no certificate (docs/decisions/32-certificates.md).
constexpr double gap_by_far = 1e6, kept_by_far = 1e-6;
// Equations both too few and too many are what a rank that is too small looks like: more is asked of those.
constexpr double gap_of_singular = 1e9, kept_of_singular = 1e-4;

bool are_clear_by_far(const std::vector<RankDecision>& decisions, bool is_singular) {
  // What is dropped without being as small as rounding may be a value that pivots have made small.
  constexpr double rounding = 8.0 * unit_roundoff;
  const auto is_clear = [](const RankDecision& d) {
    return d.verdict == Verdict::clear ||
           (d.verdict == Verdict::confirmed && d.dropped < rounding * std::max(d.rows, d.cols));
  };
  return std::all_of(decisions.begin(), decisions.end(), is_clear) &&
         smallest_gap(decisions) >= (is_singular ? gap_of_singular : gap_by_far) &&
         smallest_kept(decisions) >= (is_singular ? kept_of_singular : kept_by_far);
}

double relative_distance(const Significance& significance) {
  return std::min(1.0, trial_perturbation * significance.weakest);
}

// What could become clearer in other units, or by a certificate.
bool is_about_ranks(const Failure& failure) {
  return failure.status() == SFDAE_RANK_UNCLEAR || failure.status() == SFDAE_INDEX_TOO_HIGH ||
         failure.status() == SFDAE_CHARACTERISTICS_CHANGED;
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
      found.units = fast_units(problem, place.t, tau);
      problem.set_units(found.units);
      found.analysis = analyze_at_two_points({problem, scaled, arena, &found.decisions}, place).analysis;
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

// Along a jet: residuals and rounding errors of jets look like values to a certificate.
IndexAnalysis analyze_along_jet(CoefficientSource& problem, Place place, const AnalysisSettings& settings,
                                Arena& arena, std::vector<RankDecision>& decisions) {
  const Units usual = choose_units(problem, place.t);
  problem.set_units(usual);
  try {
    return analyze_at_two_points({problem, settings, arena, &decisions}, place).analysis;
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_RANK_UNCLEAR || settings.rank_tol > 0.0 || settings.time_scale > 0.0) throw;
    if (std::optional<UnitsResult> found = analyze_in_other_units(problem, place, settings, arena)) {
      problem.set_units(found->units);
      decisions = std::move(found->decisions);
      return found->analysis;
    }
    problem.set_units(usual);
    throw Failure(SFDAE_RANK_UNCLEAR, std::string(failure.what()) + " Set rank_tol, or scale the equations: " +
                                          rank_tolerances({problem, settings, arena}, place.t, {}) + ".");
  }
}

// The analysis of one problem in several ways.
class Analysis {
 public:
  Analysis(CoefficientSource& problem, Place place, const AnalysisSettings& settings, Arena& arena)
      : problem_(problem), place_(place), settings_(settings), scaled_(settings), arena_(arena) {
    scaled_.time_scale = 0.0;
    scaled_.rank_tol = 0.0;
    usual_ = choose_units(problem, place.t);
    is_even_ = has_even_entries(problem, place.t, usual_);
    is_balanced_ = !is_even_ || settings.rank_tol > 0.0;
    if (is_balanced_) balanced_ = balanced_units(problem, place.t, usual_);
  }

  IndexAnalysis by_tolerance(std::vector<RankDecision>& decisions);
  IndexAnalysis run(std::vector<RankDecision>& decisions);

 private:
  SearchTask task_in_balanced_units(std::vector<RankDecision>* log) {
    problem_.set_units(balanced_.unknowns);
    return {problem_, scaled_, arena_, log, &balanced_};
  }
  bool is_confirmed_in_balanced_units(const IndexAnalysis& quick);
  bool norms_agree(const AnalysisOutcome& outcome, std::vector<RankDecision>& decisions);
  bool redundancy_agrees(const IndexAnalysis& analysis);
  bool is_independent_of_suspects(const CharacteristicValues& values);
  [[noreturn]] void report_useless(const AnalysisOutcome& outcome);
  [[noreturn]] void report_unclear(const CharacteristicValues& certified);

  CoefficientSource& problem_;
  Place place_;
  const AnalysisSettings& settings_;
  AnalysisSettings scaled_;  // with what fits balanced units
  Arena& arena_;
  Units usual_;
  bool is_even_ = false;  // in usual units; balanced ones are only found where more is needed
  bool is_balanced_ = false;
  BalancedUnits balanced_;
};

// rank_tol acts in balanced units.
IndexAnalysis Analysis::by_tolerance(std::vector<RankDecision>& decisions) {
  scaled_ = settings_;
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = true;
  const AnalysisOutcome found = analyze_at_two_points(task, place_);
  norms_agree(found, decisions);
  return found.analysis;
}

IndexAnalysis Analysis::run(std::vector<RankDecision>& decisions) {
  problem_.set_units(usual_);
  std::optional<IndexAnalysis> quick;
  std::optional<Failure> failed;
  try {
    quick = analyze_at_two_points({problem_, settings_, arena_, &decisions}, place_).analysis;
    if (!balanced_.has_suspects && are_clear_by_far(decisions, is_singular(quick->values)) &&
        (is_even_ || are_balanced(usual_, quick->time_scale, balanced_) || is_confirmed_in_balanced_units(*quick))) {
      problem_.set_units(usual_);
      return *quick;
    }
  } catch (const Failure& failure) {
    if (!is_about_ranks(failure)) throw;
    failed = failure;
  }
  if (!is_balanced_) balanced_ = balanced_units(problem_, place_.t, usual_);
  AnalysisOutcome certified;
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = true;
  try {
    certified = analyze_at_two_points(task, place_);
  } catch (const Failure& failure) {
    if (!is_about_ranks(failure)) throw;
    if (!quick) throw *failed;
    // Levels too high for a certificate: rounding errors have grown beyond what it perturbs.
    if (smallest_gap(decisions) >= gap_of_singular && smallest_kept(decisions) >= kept_by_far) {
      problem_.set_units(usual_);
      return *quick;
    }
    report_unclear({});
  }
  const CharacteristicValues& values = certified.analysis.values;
  certified.analysis.distance = relative_distance(certified.significance);
  std::vector<RankDecision> confirmed;
  if (certified.is_clear && redundancy_agrees(certified.analysis) && norms_agree(certified, confirmed) &&
      is_independent_of_suspects(values)) {
    if (certified.significance.smallest_pivot < settings_.least_useful_pivot) report_useless(certified);
    // Units that are good enough stay: what is integrated does not depend on how sure its ranks are. Small values kept
    // amplify rounding errors, in these units.
    if (quick && quick->values == values && smallest_kept(decisions) >= kept_by_far) {
      problem_.set_units(usual_);
      quick->distance = certified.analysis.distance;
      return *quick;
    }
    decisions = std::move(confirmed);
    return certified.analysis;
  }
  if (quick && quick->values == values &&
      (certified.significance.is_plausible() || smallest_gap(decisions) >= gap_by_far) &&
      redundancy_agrees(certified.analysis)) {
    problem_.set_units(usual_);
    return *quick;
  }
  // Even data whose ranks norms make clear by far: what perturbed copies lose is the size of the array.
  const bool is_usual_good = is_even_ || (quick && are_balanced(usual_, quick->time_scale, balanced_));
  if (quick && is_usual_good && !certified.is_clear && smallest_gap(decisions) >= gap_of_singular &&
      smallest_kept(decisions) >= kept_by_far) {
    problem_.set_units(usual_);
    return *quick;
  }
  report_unclear(values);
}

bool Analysis::is_confirmed_in_balanced_units(const IndexAnalysis& quick) {
  std::vector<RankDecision> decisions;
  const CharacteristicValues values = local_values(task_in_balanced_units(&decisions), place_.t);
  return values == quick.values && are_clear_by_far(decisions, is_singular(values));
}

// The ranks of the certificate leave a gap between the norms of what is kept and dropped, too.
bool Analysis::norms_agree(const AnalysisOutcome& outcome, std::vector<RankDecision>& decisions) {
  constexpr double visible_gap = 10.0;
  LevelResult certified;
  certified.known_ranks = outcome.analysis.certified_ranks;
  certified.time_scale = outcome.analysis.time_scale;
  IndexSearch search(task_in_balanced_units(nullptr), place_.t);
  decisions = search.decisions_with(outcome.analysis.values.mu, certified);
  return std::all_of(decisions.begin(), decisions.end(),
                     [](const RankDecision& d) { return d.rank == 0 || d.kept >= visible_gap * d.dropped; });
}

// u and v, from one matrix without a chain of decisions: of coefficients that are constant as far as the level mu can
// see, from lambda E - A; else from the rows of the array. Nothing can be said where rows are left out.
bool Analysis::redundancy_agrees(const IndexAnalysis& analysis) {
  const CharacteristicValues& values = analysis.values;
  if (!problem_.differentiations().empty()) return true;
  TaylorData data;
  problem_.set_units(balanced_.unknowns);
  const CallbackError error =
      problem_.evaluate(place_.t, {values.mu, values.mu, -1}, analysis.time_scale, data, RowScaling::timed);
  if (error.status != SFDAE_OK) error.raise();
  bool is_constant = true;
  for (int k = 1; k <= values.mu; ++k) is_constant = is_constant && data.is_zero_E(k) && data.is_zero_A(k);
  if (!is_constant) return analysis.v_hat == 0 || !has_independent_rows(data, values.mu, balanced_);
  const int rank = clear_pencil_rank(data, balanced_);
  return rank == problem_.n() - values.u && rank == problem_.m() - values.v;
}

bool Analysis::is_independent_of_suspects(const CharacteristicValues& values) {
  if (!balanced_.has_suspects) return true;
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = task.omits_suspects = true;
  try {
    const AnalysisOutcome other = analyze_at_two_points(task, place_);
    return other.is_clear && other.analysis.values == values;
  } catch (const Failure& failure) {
    if (!is_about_ranks(failure)) throw;
    return false;
  }
}

void Analysis::report_useless(const AnalysisOutcome& outcome) {
  const CharacteristicValues& values = outcome.analysis.values;
  const SearchTask task = task_in_balanced_units(nullptr);
  throw Failure(SFDAE_RANK_UNCLEAR,
                format("at t = %.15g, ", place_.t) + describe(values) +
                    format(" is certain for these data (changing it takes relative changes of %.1e), but rests on a "
                           "value of %.1e in balanced units that amplifies rounding errors by its inverse: ",
                           relative_distance(outcome.significance), outcome.significance.smallest_pivot) +
                    rank_tolerances(task, place_.t, values) + ".");
}

void Analysis::report_unclear(const CharacteristicValues& certified) {
  const SearchTask task = task_in_balanced_units(nullptr);
  throw Failure(SFDAE_RANK_UNCLEAR,
                format("the ranks at t = %.15g are not clear: ", place_.t) +
                    (certified.mu >= 0 ? "entry by entry the data suggest " + describe(certified) +
                                             ", but errors of "
                                             "their size of rounding or the sizes of what is kept and dropped do not "
                                             "confirm it; in balanced units "
                                       : "in balanced units ") +
                    rank_tolerances(task, place_.t, certified) + ".");
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
  return local_values({problem, settings, arena}, t);
}

bool known_values_hold(CoefficientSource& problem, double t, const AnalysisSettings& settings,
                       const IndexAnalysis& known, Arena& arena) {
  AnalysisSettings scaled = settings;
  scaled.rows = known.rows;
  IndexSearch upward({problem, scaled, arena}, t);
  PointRanks expected;
  expected.a = known.values.a;
  expected.d = known.values.d;
  expected.v_hat = known.v_hat;
  return upward.has_ranks(known.values.mu, known.time_scale, expected);
}

double certified_distance(CoefficientSource& source, double t, const IndexAnalysis& known,
                          const AnalysisSettings& settings, Arena& arena) {
  const BalancedUnits units = balanced_units(source, t, choose_units(source, t));
  source.set_units(units.unknowns);
  AnalysisSettings scaled = settings;
  scaled.time_scale = scaled.rank_tol = 0.0;
  SearchTask task{source, scaled, arena, nullptr, &units};
  task.certified = true;
  const CharacteristicValues& values = known.values;
  const LevelResult found = IndexSearch(task, t).determine_confirmed(values.mu);
  const PointRanks& ranks = found.ranks;
  const bool is_same = ranks.a == values.a && ranks.d == values.d && ranks.v_hat == known.v_hat;
  if (!is_same || !found.clear)
    throw Failure(SFDAE_RANK_UNCLEAR, format("at t = %.15g perturbed data ", t) +
                                          (is_same ? std::string("do not make clear that ") + describe(values)
                                                   : format("have a = %d, d = %d at level %d, but the analysis says ",
                                                            ranks.a, ranks.d, values.mu) +
                                                         describe(values)) +
                                          ".");
  return relative_distance(found.significance);
}

IndexAnalysis analyze_index(CoefficientSource& problem, double t, double toward, const AnalysisSettings& settings,
                            Arena& arena, std::vector<RankDecision>& decisions) {
  decisions.clear();
  if (!problem.point(t).empty()) return analyze_along_jet(problem, {t, toward}, settings, arena, decisions);
  Analysis analysis(problem, {t, toward}, settings, arena);
  return settings.rank_tol > 0.0 ? analysis.by_tolerance(decisions) : analysis.run(decisions);
}

}  // namespace sfdae::core
