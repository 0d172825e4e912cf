// Strangeness index and characteristic values of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/index_analysis.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "problem/failure.h"
#include "reduction/balanced_units.h"
#include "reduction/certificate.h"
#include "reduction/confirmed_ranks.h"
#include "reduction/jet_analysis.h"
#include "reduction/known_rank_elimination.h"
#include "reduction/two_point_analysis.h"
#include "reduction/unclear_ranks.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

bool is_singular(const CharacteristicValues& values) { return values.u > 0 && values.v > 0; }

// Norms that decide with this distance need no certificate (docs/design/rank_decisions.md).
constexpr double gap_by_far = 1e6, kept_by_far = 1e-6;
// Required gap without a certificate: kron with n = 100, mu = 3, w = 4 has a gap of 2e8.
constexpr double gap_without_certificate = 1e8;

bool are_clear_by_far(const std::vector<RankDecision>& decisions, bool is_singular) {
  // A dropped value that is not as small as roundoff may be a value made small by pivots.
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

// Ranks could become clearer in other units, or by a certificate, which may not need the missing derivatives.
bool is_about_ranks(const Failure& failure) {
  return failure.status() == SFDAE_RANK_UNCLEAR || failure.status() == SFDAE_INDEX_TOO_HIGH ||
         failure.status() == SFDAE_CHARACTERISTICS_CHANGED || failure.status() == SFDAE_ORDER_MISSING;
}

// The analysis of one problem by several methods.
class Analysis {
 public:
  Analysis(CoefficientSource& problem, Place place, const AnalysisSettings& settings, Arena& arena)
      : problem_(problem), place_(place), settings_(settings), scaled_(settings), arena_(arena) {
    UsualUnits usual = usual_units(problem, place.t);
    usual_ = std::move(usual.units);
    scaled_.precedent = {};
    scaled_.time_scale = 0.0;
    scaled_.rank_tol = 0.0;
    is_even_ = has_even_entries(usual.data);
    if (!is_even_) balanced_ = balanced_units(usual.data, usual_);
  }

  IndexAnalysis by_tolerance(std::vector<RankDecision>& decisions);
  std::optional<IndexAnalysis> by_precedent(std::vector<RankDecision>& decisions);
  IndexAnalysis run(std::vector<RankDecision>& decisions);

 private:
  const BalancedUnits& balanced() {
    if (!balanced_) balanced_ = balanced_units(data_in_units(problem_, place_.t, usual_), usual_);
    return *balanced_;
  }
  SearchTask task_in_balanced_units(std::vector<RankDecision>* log) {
    problem_.set_units(balanced().unknowns);
    return {problem_, scaled_, arena_, log, &balanced()};
  }
  IndexAnalysis in_usual_units(const IndexAnalysis& quick) {
    problem_.set_units(usual_);
    return quick;
  }
  IndexAnalysis by_certificate(AnalysisOutcome found, const std::optional<IndexAnalysis>& quick,
                               std::vector<RankDecision>& decisions);
  AnalysisOutcome certified();
  std::optional<AnalysisOutcome> certified_if_any();
  bool has_good_usual_units(const IndexAnalysis& quick) {
    return is_even_ || are_balanced(usual_, quick.time_scale, balanced());
  }
  bool is_clear_by_norms(IndexAnalysis& quick, const std::vector<RankDecision>& decisions);
  bool agrees_in_balanced_units(IndexAnalysis& quick);
  bool is_certified_at_mu(IndexAnalysis& quick, const std::vector<RankDecision>& decisions);
  bool is_confirmed_as_it_is(IndexAnalysis& quick, const std::vector<RankDecision>& decisions);
  bool outlasts_certificate(const IndexAnalysis& quick, const std::vector<RankDecision>& decisions);
  bool norms_agree(const AnalysisOutcome& outcome, std::vector<RankDecision>& decisions);
  // Units of the unknowns and rows that the time scale of an analysis belongs to, and the suspects in them.
  struct Frame {
    const Units& unknowns;
    RowScaling rows;
    const BalancedUnits& suspects;
  };
  bool redundancy_agrees(const IndexAnalysis& analysis) {
    return redundancy_agrees(analysis, {balanced().unknowns, RowScaling::timed, balanced()});
  }
  bool redundancy_agrees(const IndexAnalysis& analysis, const Frame& frame);
  bool is_independent_of_suspects(const CharacteristicValues& values);
  [[noreturn]] void report_useless(const AnalysisOutcome& outcome);
  [[noreturn]] void report_unclear(const CharacteristicValues& certified);

  CoefficientSource& problem_;
  Place place_;
  const AnalysisSettings& settings_;
  AnalysisSettings scaled_;  // settings for balanced units
  Arena& arena_;
  Units usual_;
  bool is_even_ = false;                   // in usual units
  std::optional<BalancedUnits> balanced_;  // computed when needed
  TrialPerturbations perturbations_;
};

// rank_tol acts in balanced units.
IndexAnalysis Analysis::by_tolerance(std::vector<RankDecision>& decisions) {
  scaled_ = settings_;
  scaled_.precedent = {};
  const AnalysisOutcome found = certified();
  norms_agree(found, decisions);
  return found.analysis;
}

// Result if norms alone make the ranks at t clear by far.
std::optional<IndexAnalysis> Analysis::by_precedent(std::vector<RankDecision>& decisions) {
  problem_.set_units(usual_);
  auto found = analyze_by_precedent({problem_, settings_, arena_, &decisions}, place_);
  if (found && is_clear_by_norms(*found, decisions)) return in_usual_units(*found);
  decisions.clear();
  return std::nullopt;
}

IndexAnalysis Analysis::run(std::vector<RankDecision>& decisions) {
  if (const auto found = by_precedent(decisions)) return *found;
  problem_.set_units(usual_);
  std::optional<IndexAnalysis> quick;
  std::optional<Failure> failed;
  try {
    quick = analyze_at_two_points({problem_, settings_, arena_, &decisions}, place_).analysis;
    if (is_clear_by_norms(*quick, decisions)) return in_usual_units(*quick);
  } catch (const Failure& failure) {
    if (!is_about_ranks(failure)) throw;
    failed = failure;
  }
  if (std::optional<AnalysisOutcome> found = certified_if_any())
    return by_certificate(std::move(*found), quick, decisions);
  if (quick && outlasts_certificate(*quick, decisions)) return in_usual_units(*quick);
  if (failed && failed->status() != SFDAE_RANK_UNCLEAR) throw *failed;
  report_unclear({});
}

AnalysisOutcome Analysis::certified() {
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = true;
  task.perturbations = &perturbations_;
  return analyze_at_two_points(task, place_);
}

// None if no level fulfills the hypothesis with perturbed copies, or the two points disagree.
std::optional<AnalysisOutcome> Analysis::certified_if_any() {
  try {
    return certified();
  } catch (const Failure& failure) {
    if (!is_about_ranks(failure)) throw;
    return std::nullopt;
  }
}

// quick: by norms, which are not decisive alone; decisions: theirs.
IndexAnalysis Analysis::by_certificate(AnalysisOutcome found, const std::optional<IndexAnalysis>& quick,
                                       std::vector<RankDecision>& decisions) {
  const CharacteristicValues& values = found.analysis.values;
  const bool is_same = quick && quick->values == values;
  const bool is_redundancy_right = (found.is_clear || is_same) && redundancy_agrees(found.analysis);
  found.analysis.distance = relative_distance(found.significance);
  std::vector<RankDecision> confirmed;
  if (found.is_clear && is_redundancy_right && norms_agree(found, confirmed) && is_independent_of_suspects(values)) {
    // Units that are good enough stay: the integrated system does not depend on the certainty of its ranks. Small
    // values kept amplify rounding errors, in these units.
    if (is_same && smallest_kept(decisions) >= kept_by_far) {
      IndexAnalysis usual = in_usual_units(*quick);
      usual.distance = found.analysis.distance;
      return usual;
    }
    if (found.significance.smallest_pivot < settings_.least_useful_pivot) report_useless(found);
    decisions = std::move(confirmed);
    problem_.set_units(balanced().unknowns);
    return found.analysis;
  }
  const bool is_visible = found.significance.is_plausible() || smallest_gap(decisions) >= gap_by_far;
  if (is_same && is_visible && is_redundancy_right) return in_usual_units(*quick);
  if (quick && !found.is_clear && has_good_usual_units(*quick) && outlasts_certificate(*quick, decisions))
    return in_usual_units(*quick);
  report_unclear(values);
}

// Norms in the usual units decide, alone or together with norms in balanced ones; otherwise a certificate has to
// confirm them.
bool Analysis::is_clear_by_norms(IndexAnalysis& quick, const std::vector<RankDecision>& decisions) {
  const bool has_suspects = balanced_ && balanced_->has_suspects;
  if (!has_suspects && are_clear_by_far(decisions, is_singular(quick.values)) && agrees_in_balanced_units(quick))
    return true;
  return is_confirmed_as_it_is(quick, decisions);
}

bool Analysis::agrees_in_balanced_units(IndexAnalysis& quick) {
  if (has_good_usual_units(quick)) return true;
  std::vector<RankDecision> others;
  const CharacteristicValues values = local_values(task_in_balanced_units(&others), place_.t);
  return values == quick.values &&
         (are_clear_by_far(others, is_singular(values)) || is_certified_at_mu(quick, others));
}

// decisions: of all levels in balanced units, with the same values as norms in the usual ones. If only values kept at
// level mu are too small for norms, a certificate of that level confirms their ranks one by one.
bool Analysis::is_certified_at_mu(IndexAnalysis& quick, const std::vector<RankDecision>& decisions) {
  const CharacteristicValues& values = quick.values;
  if (values.u > 0 || values.v > 0 || quick.v_hat > 0 || settings_.by_svd) return false;
  std::vector<RankDecision> below, at_mu;
  for (const RankDecision& decision : decisions) (decision.level < values.mu ? below : at_mu).push_back(decision);
  if (smallest_gap(at_mu) < gap_by_far || !are_clear_by_far(below, false)) return false;
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = true;
  const LevelResult found = IndexSearch(task, place_.t).determine_confirmed(values.mu);
  const RankSequence& ranks = found.known_ranks;
  const bool is_same = ranks.count == at_mu.size() &&
                       std::equal(at_mu.begin(), at_mu.end(), ranks.rank.begin(),
                                  [](const RankDecision& decision, int rank) { return decision.rank == rank; });
  if (!found.clear || !is_same) return false;
  IndexAnalysis balanced = quick;
  balanced.time_scale = found.time_scale;
  if (!redundancy_agrees(balanced)) return false;
  quick.distance = relative_distance(found.significance);
  return true;
}

// For large problems, for which balanced units may be of no use (reduction/confirmed_ranks.h).
bool Analysis::is_confirmed_as_it_is(IndexAnalysis& quick, const std::vector<RankDecision>& decisions) {
  const CharacteristicValues& values = quick.values;
  const bool is_large = std::max(problem_.m(), problem_.n()) >= large_problem;
  if (!is_large || values.u > 0 || values.v > 0 || quick.v_hat > 0) return false;
  if (settings_.by_svd || !problem_.differentiations().empty() || smallest_kept(decisions) < kept_by_far)
    return false;
  std::vector<RankDecision> at_mu, to_confirm;
  for (const RankDecision& decision : decisions) {
    if (decision.level != values.mu) continue;
    at_mu.push_back(decision);
    if (decision.t == place_.t) to_confirm.push_back(decision);
  }
  const bool is_clear = are_clear_by_far(at_mu, false) && smallest_gap(decisions) >= gap_by_far;
  problem_.set_units(usual_);
  SearchTask task{problem_, settings_, arena_};
  task.perturbations = &perturbations_;
  const std::optional<Significance> confirmed = confirmed_ranks(task, is_clear ? to_confirm : decisions);
  const BalancedUnits no_suspects;
  if (!confirmed || !redundancy_agrees(quick, {usual_, quick.rows, no_suspects})) return false;
  quick.distance = relative_distance(*confirmed);
  return true;
}

// True if norms are clear without a clear certificate: perturbed copies fail for large arrays and high levels, whose
// rounding errors grow beyond the perturbations.
bool Analysis::outlasts_certificate(const IndexAnalysis& quick, const std::vector<RankDecision>& decisions) {
  if (balanced().has_suspects) return false;
  const double gap = is_singular(quick.values) ? gap_of_singular : gap_without_certificate;
  return smallest_gap(decisions) >= gap && smallest_kept(decisions) >= kept_by_far;
}

// The ranks of the certificate leave a gap between the norms of kept and dropped values, too.
bool Analysis::norms_agree(const AnalysisOutcome& outcome, std::vector<RankDecision>& decisions) {
  constexpr double visible_gap = 10.0;
  const IndexAnalysis& analysis = outcome.analysis;
  IndexSearch search(task_in_balanced_units(nullptr), place_.t);
  decisions = search.decisions_with(analysis.values.mu, analysis.certified_ranks, analysis.time_scale);
  return !decisions.empty() && std::all_of(decisions.begin(), decisions.end(), [](const RankDecision& d) {
    return d.rank == 0 || d.kept >= visible_gap * d.dropped;
  });
}

// u and v, from one matrix without a chain of decisions: from lambda E - A if the coefficients are constant in the data
// of level mu; else from the rows of the array.
bool Analysis::redundancy_agrees(const IndexAnalysis& analysis, const Frame& frame) {
  const CharacteristicValues& values = analysis.values;
  TaylorData data;
  problem_.set_units(frame.unknowns);
  const CallbackError error =
      problem_.evaluate(place_.t, {values.mu, values.mu, -1}, analysis.time_scale, data, frame.rows);
  if (error.status != SFDAE_OK) error.raise();
  bool is_constant = true;
  for (int k = 1; k <= values.mu; ++k) is_constant = is_constant && data.is_zero_E(k) && data.is_zero_A(k);
  if (!is_constant) return analysis.v_hat == 0 || !has_independent_rows(data, values.mu, frame.suspects);
  const int rank = clear_pencil_rank(data, frame.suspects);
  return rank == problem_.n() - values.u && rank == problem_.m() - values.v;
}

bool Analysis::is_independent_of_suspects(const CharacteristicValues& values) {
  if (!balanced().has_suspects) return true;
  SearchTask task = task_in_balanced_units(nullptr);
  task.certified = task.omits_suspects = true;
  task.perturbations = &perturbations_;
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

Precedent precedent_of(const IndexAnalysis& analysis) {
  return {analysis.values, analysis.rank_E, analysis.rank_E_constant};
}

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
                        : decision.subject == Subject::block       ? "block of the system Jacobian"
                                                                   : "E T2";
  return format("rank decision at t = %.15g, level %d (%s, %d x %d): kept %.1e, dropped %.1e, noise %.1e (gap %.2g)",
                decision.t, decision.level, subject, decision.rows, decision.cols, decision.kept, decision.dropped,
                decision.noise, decision.gap);
}

// Bounded by the smallest values on which norms decide alone.
double least_useful_pivot(const std::vector<double>& rtol) {
  constexpr double roundings = 10.0;
  double smallest = useful_pivot_at_best;
  for (double tolerance : rtol)
    if (tolerance > 0.0) smallest = std::max(smallest, roundings * unit_roundoff / tolerance);
  return std::min(smallest, kept_by_far);
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
  const UsualUnits usual = usual_units(source, t);
  const BalancedUnits units = balanced_units(usual.data, usual.units);
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
  if (problem.is_along_jet()) return analyze_along_jet(problem, {t, toward}, settings, arena, decisions);
  Analysis analysis(problem, {t, toward}, settings, arena);
  return settings.rank_tol > 0.0 ? analysis.by_tolerance(decisions) : analysis.run(decisions);
}

}  // namespace sfdae::core
