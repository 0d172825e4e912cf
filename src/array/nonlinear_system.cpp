// The strangeness-free system of a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "array/rounding_of_guesses.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/contradiction.h"
#include "reduction/index_analysis.h"
#include "reduction/rank_sequence.h"
#include "starts/consistent_jets.h"
#include "starts/jet_solver.h"
#include "starts/jet_theory.h"

namespace sfdae::core {

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis,
                                 Units units, const Jet& jet)
    : DaeSystem(problem, problem.m(), std::move(analysis), LeadingTerm::identity),
      problem_(problem, settings, analysis_, std::move(units), callback_error_) {
  update_traits();
  demand_free_components(problem_.prescribed(), analysis_.values.u);
  resize();
  if (set_point(jet) == PointStatus::callback_error) callback_error_.raise();
}

NonlinearSystem::NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& saved)
    : DaeSystem(problem, problem.m(), {}, LeadingTerm::identity),
      problem_(problem, settings, analysis_, {}, callback_error_) {
  archive(saved);
}

void NonlinearSystem::update_traits() {
  traits_ = {.unknowns = problem_.n(),
             .differential = analysis_.values.d,
             .undetermined = analysis_.values.u - static_cast<int>(problem_.prescribed().size()),
             .leading_size = problem_.n(),
             .taylor_order = problem_.jet_order()};
}

void NonlinearSystem::resize() {
  linearization_.resize();
  iteration_.resize();
  map_.resize(problem_);
  index_zero_.resize();
  rounding_errors_.assign(index(problem_.n()), 0.0);
  history_.resize(problem_.n(), problem_.jet_order());
  jet_.n = problem_.n();
  jet_.set_order(problem_.jet_order());
}

PointQuality NonlinearSystem::quality() const {
  PointQuality quality = linearization_.quality();
  quality.inconsistency = iteration_.inconsistency();
  return quality;
}

std::string NonlinearSystem::inconsistency_message() const {
  const std::string text = DaeSystem::inconsistency_message();
  try {
    const DerivativeArray array = derivative_array(problem_.problem(), jet_, analysis_.values.mu);
    const std::string names =
        in_words(contradicting_equations(array, equations(), {}, nullptr), problem_.problem().equation_names());
    return names.empty() ? text : text + " It is " + names + " that cannot hold together.";
  } catch (const Failure&) {
    return text;
  }
}

CharacteristicValues NonlinearSystem::values_at(double) {
  ConsistentJets jets(problem_.problem(), jet_.t, jet_.x.data(), {});
  Arena arena;
  return find_local_values(jets, jet_.t, settings(), arena);
}

// ---- Points ----------------------------------------------------------------------------------------------------

PointStatus NonlinearSystem::set_point(const Jet& jet) {
  jet_ = jet;
  jet_.set_order(problem_.jet_order());
  history_.restart(jet_);
  index_zero_.forget();
  return renew_at_accepted();
}

PointStatus NonlinearSystem::set_points(const Jet& before, const Jet& last) {
  const PointStatus status = set_point(last);
  history_.restart(before);
  history_.accept(last);
  return status;
}

// Level mu leaves some components of its highest derivatives undetermined, but the linearization depends on them.
void NonlinearSystem::complete(Jet& jet) {
  jet.set_order(problem_.jet_order());
  next_level_.forget_solution();
  if (problem_.prescribed().empty() && next_level_.solve(jet, jet.column(0))) next_level_.copy_derivatives(jet);
}

void NonlinearSystem::apply_inputs() {
  if (problem_.prescribed().empty()) return;
  std::vector<double> x(index(problem_.n()));
  restore(nullptr, jet_.x.data(), x.data());
  history_.restart(jet_);
}

// Repeats the last renewal at the last accepted point if it was interrupted.
PointStatus NonlinearSystem::complete_linearization() {
  return linearization_.is_complete() ? PointStatus::ok : renew_at_accepted();
}

PointStatus NonlinearSystem::renew_at_accepted() {
  iteration_.chord().forget_rate();
  const PointStatus status = problem_.evaluate_inputs(history_.accepted().t);
  return status == PointStatus::ok ? linearize_at_accepted() : status;
}

// Uses the inputs that were evaluated last. Also judges the ranks and measures the noise.
PointStatus NonlinearSystem::linearize_at_accepted() {
  const PointStatus status = rank_check_.renew(history_.accepted(), linearization_, iteration_);
  if (status == PointStatus::ok) take_rounding_errors();
  return status;
}

void NonlinearSystem::take_rounding_errors() {
  std::copy(linearization_.rounding_errors().begin(), linearization_.rounding_errors().end(),
            rounding_errors_.begin());
}

bool NonlinearSystem::is_drowned(const double* inverse_weights) const {
  const auto error_of = [this](int j) { return linearization_.rounding_errors()[index(j)]; };
  return core::is_drowned(linearization_.origin().jet, history_.accepted(), error_of, inverse_weights);
}

// Called before a step.
PointStatus NonlinearSystem::leave_drowned_point(const double* inverse_weights) {
  return linearization_.is_usable() && is_drowned(inverse_weights) ? renew_at_accepted() : PointStatus::ok;
}

// Called after a step has converged.
PointStatus NonlinearSystem::judge_rounding_errors(const double* inverse_weights) {
  if (!linearization_.is_usable()) return PointStatus::ok;
  if (is_drowned(inverse_weights)) return PointStatus::not_converged;
  take_rounding_errors();
  return PointStatus::ok;
}

PointStatus NonlinearSystem::move_to(double t) {
  PointStatus status = complete_linearization();
  if (status == PointStatus::ok) status = problem_.evaluate_inputs(t);
  if (status != PointStatus::ok) return status;
  if (t == history_.accepted().t) jet_ = history_.accepted();
  else if (t != jet_.t) history_.interpolate(t, jet_);
  return PointStatus::ok;
}

void NonlinearSystem::accept() {
  history_.accept(jet_);
  linearization_.count_point();
}

void NonlinearSystem::error_in_x(const double* dw, int count, double* dx) {
  if (index_zero_.error_in_x(dw, count, dx)) return;
  // Renews the linearization as the next step would after a failed one.
  if (!linearization_.is_usable()) renew_at_accepted();
  linearization_.error_in_x(dw, count, dx);
}

PointStatus NonlinearSystem::check_ranks() { return rank_check_.compare(jet_, linearization_, iteration_); }

// ---- Steps -----------------------------------------------------------------------------------------------------

// Linearizes again at the last accepted point, where ranks can be judged, and if necessary at the start of the
// iteration. A linearization that fails is forgotten: iterations may converge with it, but error estimates would be
// zero. An initial guess from which the iteration does not converge may be far from any solution. If an exponential is
// larger there by orders of magnitude, changes with that linearization are too small by as much, and a shorter step
// would seem to converge at once.
template <class Iterate>
PointStatus NonlinearSystem::iterate_with_renewal(const double* inverse_weights, const Jet& start, Iterate iterate) {
  const Jet& accepted = history_.accepted();
  const bool is_usable = linearization_.is_usable();
  PointStatus status = is_usable ? iterate() : PointStatus::not_converged;
  if (status == PointStatus::ok || is_hopeless(status)) return status;
  if (!is_usable || linearization_.origin().jet.t != accepted.t) {
    iteration_.chord().forget_rate();
    status = linearize_at_accepted();
    if (status == PointStatus::ok) status = iterate();
    if (status == PointStatus::ok || is_hopeless(status)) return status;
  }
  iteration_.chord().forget_rate();
  status = linearization_.renew(start, false);
  if (status == PointStatus::ok && is_drowned(inverse_weights)) status = PointStatus::not_converged;
  const DoubtedMatrix doubt(iteration_.chord());
  if (status == PointStatus::ok) status = iterate();
  if (status != PointStatus::ok) linearization_.forget();
  return status;
}

PointStatus NonlinearSystem::iterate_from_guess(const IterationTask& task) {
  start_ = jet_;
  const auto iterate = [&] {
    return iterate_with_renewal(task.inverse_weights, start_, [&] {
      jet_ = start_;
      return iteration_.solve(task, linearization_, jet_);
    });
  };
  const PointStatus status = iterate();
  if (!may_hold_derivatives(status)) return status;
  history_.hold_derivatives(start_);
  return iterate();
}

// Derivatives of a polynomial have its errors divided by powers of the step, so iterations from them may converge less
// and less as steps become shorter. From the derivatives of the last point they converge if the step is short enough.
bool NonlinearSystem::may_hold_derivatives(PointStatus status) const {
  return status != PointStatus::ok && !is_hopeless(status) && problem_.mu() > 0;
}

PointStatus NonlinearSystem::solve(const StepEquations& equations, double* x) {
  history_.predict(equations.guess, 0, linearization_.determined(), units(), jet_);
  const IterationTask task{
      true, equations.c, equations.w_rest, equations.x_rest, equations.guess.inverse_weights, newton_tolerance};
  PointStatus status = leave_drowned_point(task.inverse_weights);
  if (status != PointStatus::ok) return status;
  if (index_zero_.is_possible() && linearization_.is_usable()) {
    status = solve_index_zero(task);
    if (status == PointStatus::ok) status = review_index_zero();
  } else {
    status = iterate_from_guess(task);
    if (status == PointStatus::ok) status = rank_check_.review(jet_, linearization_, iteration_);
  }
  if (status == PointStatus::ok) status = judge_rounding_errors(task.inverse_weights);
  std::copy_n(jet_.x.data(), problem_.n(), x);
  return status;
}

// Tries the current Jacobian, then that of the last accepted point, then that of the initial guess.
PointStatus NonlinearSystem::solve_index_zero(const IterationTask& task) {
  start_ = jet_;
  const IndexZeroStep::Shared shared{linearization_.noise(), iteration_.chord(), counts_.factorizations};
  const Jet& accepted = history_.accepted();
  if (!index_zero_.has_jacobian() && linearization_.origin().jet.t == accepted.t)
    index_zero_.take(linearization_.origin().jet, linearization_.data());
  const Jet* const places[] = {nullptr, &accepted, &start_};
  PointStatus status = PointStatus::not_converged;
  for (const Jet* place : places) {
    if (place == nullptr ? !index_zero_.has_jacobian() : index_zero_.has_jacobian_of(place->t)) continue;
    if (place != nullptr) {
      iteration_.chord().forget_rate();
      status = place == &start_ ? index_zero_.renew(start_, linearization_.preferred_rows())
                                : renew_jacobian_at_accepted();
      if (status != PointStatus::ok) return status;
    }
    jet_ = start_;
    const DoubtedMatrix doubt(iteration_.chord(), place == &start_);
    status = index_zero_.solve(task, shared, jet_);
    if (status == PointStatus::ok) return status;
    // As in iterate_with_renewal: no shorter step may use the Jacobian of such a guess.
    if (place == &start_) index_zero_.forget();
    if (is_hopeless(status)) return status;
  }
  return status;
}

PointStatus NonlinearSystem::renew_jacobian_at_accepted() {
  const PointStatus status = linearize_at_accepted();
  if (status == PointStatus::ok) index_zero_.take(linearization_.origin().jet, linearization_.data());
  return status;
}

// A Jacobian renewed for slow convergence or a due rank check usually confirms the ranks. Otherwise they are judged.
PointStatus NonlinearSystem::review_index_zero() {
  ChordIteration& chord = iteration_.chord();
  const bool is_due = rank_check_.count_point();
  // A new factorization may be all that is needed.
  if (chord.is_slow() && index_zero_.blames_matrix()) chord.set_slow(false);
  if (!chord.is_slow() && !is_due) return PointStatus::ok;
  const PointStatus renewed = index_zero_.renew(jet_, linearization_.preferred_rows());
  if (renewed != PointStatus::ok) return renewed;
  if (index_zero_.has_ranks_of(linearization_.data(), linearization_.form())) {
    rank_check_.confirm(chord);
    return PointStatus::ok;
  }
  const PointStatus status = rank_check_.renew(jet_, linearization_, iteration_);
  rank_check_.expect_fast(chord);
  if (status == PointStatus::ok) index_zero_.take(linearization_.origin().jet, linearization_.data());
  return status;
}

PointStatus NonlinearSystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  t_reached = equations.t_end;
  PointStatus status = complete_linearization();
  if (status == PointStatus::ok) status = leave_drowned_point(equations.guess.inverse_weights);
  if (status != PointStatus::ok) return status;
  stages_.predict(equations, history_, linearization_.determined());
  const bool has_one = equations.method.s == 1;
  const auto iterate = [&] {
    return has_one ? iterate_with_renewal(equations.guess.inverse_weights, stages_.middle(),
                                          [&] { return stages_.solve(equations, linearization_, iteration_); })
                   : solve_several_stages(equations);
  };
  status = iterate();
  if (may_hold_derivatives(status)) {
    stages_.hold_derivatives(history_);
    status = iterate();
  }
  if (status != PointStatus::ok) return status;
  jet_ = stages_.last();
  stages_.copy_to(x);
  stages_.copy_to(w);
  if (has_one) status = rank_check_.review(jet_, linearization_, iteration_);
  return status == PointStatus::ok ? judge_rounding_errors(equations.guess.inverse_weights) : status;
}

// One linearization suits all stages best at the middle of the step. Its ranks have to be confirmed by the solution:
// steps are long, and ranks are compared after each.
PointStatus NonlinearSystem::solve_several_stages(const StageEquations& equations) {
  const auto iterate = [&] {
    const PointStatus status = stages_.solve(equations, linearization_, iteration_);
    if (status != PointStatus::ok) return status;
    jet_ = stages_.last();
    return rank_check_.review_by_comparison(jet_, equations.guess.inverse_weights, linearization_, iteration_);
  };
  PointStatus status = linearization_.renew(stages_.middle(), false);
  if (status == PointStatus::ok && is_drowned(equations.guess.inverse_weights)) status = PointStatus::not_converged;
  if (status == PointStatus::ok) status = iterate();
  const bool is_final = status == PointStatus::callback_error && !callback_error_.is_recoverable();
  if (status == PointStatus::ok || is_final) return status;
  iteration_.chord().forget_rate();
  status = rank_check_.renew(history_.nearest(equations.t_end), linearization_, iteration_);
  return status == PointStatus::ok ? iterate() : status;
}

// State that later steps depend on is not changed: requested points must not affect the steps.
void NonlinearSystem::restore(const double*, const double* x_free, const Guess& guess, double* x) {
  if (guess.taylor != nullptr && jet_.t != history_.accepted().t)
    history_.predict(guess, 0, linearization_.determined(), units(), jet_);
  std::copy_n(x_free, problem_.n(), jet_.x.data());
  start_ = jet_;
  PointStatus status = PointStatus::not_converged;
  if (linearization_.is_usable()) {
    // Ends of steps do without a map: there are as many of them as linearizations.
    const bool has_map = jet_.t != history_.accepted().t && map_.make(problem_, linearization_, arena_);
    status = iteration_.solve_to_rounding(linearization_, jet_, has_map ? &map_ : nullptr);
  }
  if (status == PointStatus::callback_error) callback_error_.raise();
  // Within a long step the linearization may be too far off.
  if (status != PointStatus::ok) restore_anew(guess.inverse_weights);
  std::copy_n(jet_.x.data(), problem_.n(), x);
}

// Restores from start_: with a linearization there, whose derivatives may be those of another solution, and by a
// search. The nearer result is taken, since the interpolated x is accurate. If both fail, goes step by step.
// inverse_weights: of tolerances, or null.
void NonlinearSystem::restore_anew(const double* inverse_weights) {
  Jet first = start_;
  const bool has_first = restore_with_linearization_at(start_) == PointStatus::ok;
  if (has_first) std::swap(first, jet_);
  Failure failure(SFDAE_NO_CONSISTENT_VALUES,
                  format("no values consistent with the constraints were found at t = %.15g.", start_.t));
  Jet begin = start_;
  const bool has_found = problem_.prescribed().empty() && search_anew(inverse_weights, begin, failure);
  if (has_found && !(has_first && distance_from_start(first) < distance_from_start(jet_))) return;
  if (has_first) jet_ = first;
  else if (!problem_.prescribed().empty() || restore_step_by_step(begin) != PointStatus::ok) throw failure;
}

// Searches from start_ for a consistent jet. The search may move x and w needlessly, so a linearization at the jet
// found is tried that keeps w. Returns false if that fails and differential variables would move beyond the tolerances
// (begin then has the derivatives found), or if the search fails (failure then tells why).
bool NonlinearSystem::search_anew(const double* inverse_weights, Jet& begin, Failure& failure) {
  jet_ = start_;
  try {
    JetSolver(problem_.problem(), units()).solve(jet_, problem_.mu());
  } catch (const Failure& reason) {
    const bool is_final = reason.status() != SFDAE_NO_CONSISTENT_VALUES && reason.status() != SFDAE_NOT_FINITE &&
                          reason.status() != SFDAE_CALLBACK_FAILED;
    if (is_final) throw;
    failure = reason;
    return false;
  }
  const Jet found = jet_;
  begin = found;
  std::copy_n(start_.x.data(), problem_.n(), begin.x.data());
  std::swap(start_, begin);
  const bool keeps_w = restore_with_linearization_at(found) == PointStatus::ok;
  std::swap(start_, begin);
  if (keeps_w) return true;
  jet_ = found;
  return !moves_differentiated(found, inverse_weights);
}

// Newton's method, linearized at each jet, with w kept, if there are no hidden constraints. With an exponential a step
// gains one power of e, and the first jet may be hundreds of them away. Steps to points where the equations cannot be
// evaluated are halved.
PointStatus NonlinearSystem::restore_step_by_step(const Jet& begin) {
  // Limits of steps, of steps without a gain (as the first one to where exponentials are large), and of halvings; the
  // factors of a gain, and of a change after which the linearization is reused for the rest. Chosen, not measured.
  constexpr int most = 1000, most_in_vain = 8, most_halvings = 40;
  constexpr double gain = 0.9, near = 0.1;
  if (problem_.mu() > 0 || linearization_.ranks().count == 0) return PointStatus::not_converged;
  ArrayLinearization linearization(problem_, counts_, arena_);
  linearization.resize();
  jet_ = begin;
  Jet before = begin, end = begin;
  double residual = std::numeric_limits<double>::infinity(), change = residual;
  int in_vain = 0, halvings = 0;
  for (int step = 0; step < most && in_vain < most_in_vain; ++step) {
    PointStatus status =
        linearization.restore({jet_, linearization_.origin().rows, false, 0}, linearization_.ranks());
    NonlinearIteration::Improvement made;
    if (status == PointStatus::ok) status = iteration_.improve(linearization, end = jet_, made);
    if (status == PointStatus::callback_error && !callback_error_.is_recoverable()) callback_error_.raise();
    if (status != PointStatus::ok) {
      if (step == 0 || ++halvings > most_halvings) return status;
      for (std::size_t i = 0; i < jet_.x.size(); ++i) jet_.x[i] = 0.5 * (before.x[i] + jet_.x[i]);
      continue;
    }
    if (!(made.residual <= gain * residual || made.change <= gain * change)) ++in_vain;
    const bool is_near = made.change <= near * change;
    residual = made.residual;
    change = made.change;
    before = jet_;
    jet_ = end;
    if (is_near && iteration_.solve_at_last(linearization, end) == PointStatus::ok) {
      jet_ = end;
      return PointStatus::ok;
    }
  }
  return PointStatus::not_converged;
}

// True if differential variables move from start_ to the jet beyond the tolerances. Hidden constraints may move them.
bool NonlinearSystem::moves_differentiated(const Jet& jet, const double* inverse_weights) const {
  if (problem_.mu() > 0 || inverse_weights == nullptr || !linearization_.is_usable()) return false;
  std::vector<double> change(index(problem_.n())), tolerances(change.size());
  for (std::size_t i = 0; i < change.size(); ++i) {
    change[i] = jet.x[i] - start_.x[i];
    tolerances[i] = 1.0 / inverse_weights[i];
  }
  return change_of_differentiated(change.data(), tolerances.data()) > 1.0;
}

double NonlinearSystem::distance_from_start(const Jet& jet) const {
  double distance = 0.0;
  for (int i = 0; i < problem_.n(); ++i)
    distance = std::max(distance, std::fabs(jet.x[index(i)] - start_.x[index(i)]) / units()[i]);
  return distance;
}

// Restores from start_, with a linearization that is used once.
PointStatus NonlinearSystem::restore_with_linearization_at(const Jet& place) {
  if (linearization_.ranks().count == 0) return PointStatus::not_converged;
  ArrayLinearization linearization(problem_, counts_, arena_);
  linearization.resize();
  PointStatus status = linearization.restore({place, linearization_.origin().rows, false, 0}, linearization_.ranks());
  if (status == PointStatus::ok) {
    jet_ = start_;
    status = iteration_.solve_at_last(linearization, jet_);
  }
  if (status == PointStatus::callback_error && !callback_error_.is_recoverable()) callback_error_.raise();
  return status;
}

// Near singular points there is no linearization, as ranks differ from those known. F is evaluated again.
bool NonlinearSystem::find_differentiated(char* flags) {
  TaylorData data;
  if (problem_.linearize(history_.accepted(), nullptr, data) != PointStatus::ok) return false;
  mark_differentiated(data, flags);
  return true;
}

// ---- x' --------------------------------------------------------------------------------------------------------

bool NonlinearSystem::exact_derivative(const double* x, double* xdot) {
  if (!problem_.prescribed().empty() || !next_level_.solve(jet_, x)) return false;
  std::copy_n(next_level_.derivative(), problem_.n(), xdot);
  // x' of smallest norm, as the free part is held.
  linearization_.remove_free_part(xdot);
  return true;
}

bool NonlinearSystem::consistent_derivative(const double* x, double, double* xdot) {
  if (exact_derivative(x, xdot)) return true;
  // x' as level mu knows it; F1 = 0 determines the differential part.
  std::copy_n(jet_.column(1), problem_.n(), xdot);
  correct_by_linearization(x, xdot);
  return false;
}

void NonlinearSystem::correct_derivative(double, const double* x, double* xdot) {
  if (!exact_derivative(x, xdot)) correct_by_linearization(x, xdot);
}

// xdot is unchanged if F cannot be evaluated or could not be linearized.
bool NonlinearSystem::correct_by_linearization(const double* x, double* xdot) {
  if (!linearization_.is_usable()) return false;
  const bool is_corrected = linearization_.correct_derivative(jet_.t, x, xdot) == PointStatus::ok;
  if (!is_corrected && !callback_error_.is_recoverable()) callback_error_.raise();
  return is_corrected;
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

void NonlinearSystem::archive(Archive& archive) {
  CharacteristicValues& values = analysis_.values;
  ArrayLinearization::Origin& origin = linearization_.origin();
  bool has_units = !units().are_one(), has_matrix = linearization_.matrix().is_valid(),
       has_next = next_level_.has_jet();
  int unjudged = rank_check_.unjudged();
  bool follows_structure = problem_.problem().follows_structure();
  archive.small(values.mu, values.d, values.a, values.u, values.v, analysis_.v_hat, analysis_.rank_E, analysis_.noise,
                analysis_.rank_E_constant, analysis_.rows, has_units, origin.is_judged, origin.age, unjudged,
                follows_structure);
  if (archive.is_reading()) {
    problem_.problem().follow_structure(follows_structure);
    if (problem_.problem().follows_structure() != follows_structure) throw DamagedArchive();
  }
  archive.small(has_matrix, has_next, next_level_.availability());
  // Without a linearization the jet of the last point is archived.
  if (!archive.is_reading() && !linearization_.is_usable()) origin.jet = history_.accepted();
  for (double* value : {&analysis_.t, &analysis_.time_scale}) archive.real(*value);
  iteration_.chord().archive_rate(archive);
  linearization_.matrix().archive_c(archive);
  const int m = problem_.m(), n = problem_.n();
  if (archive.is_reading()) {
    update_traits();
    if (!fits_dimensions(analysis_, m, n) || values.mu > max_strangeness_index || undetermined() < 0 ||
        !is_row_scaling(analysis_.rows) || origin.age < 0)
      throw DamagedArchive();
    resize();
  }
  if (has_units) archive.reals(problem_.units().values(), index(n));
  history_.archive(archive);
  archive.reals(rounding_errors_, index(n));
  archive.real(origin.jet.t);
  archive.reals(origin.jet.x, index(n) * index(problem_.jet_order() + 1));
  archive.reals(origin.rows, index(m));
  if (has_next) next_level_.archive_highest_derivative(archive);
  RankSequence ranks = linearization_.ranks();
  archive_ranks(archive, ranks);
  archive_ranks(archive, analysis_.certified_ranks);
  if (archive.is_reading()) {
    rank_check_.set_unjudged(unjudged);
    restore_linearization(ranks, has_matrix);
  }
  index_zero_.archive(archive, counts_.factorizations);
}

// Restores the linearization as it was archived.
void NonlinearSystem::restore_linearization(const RankSequence& ranks, bool has_matrix) {
  jet_ = history_.accepted();
  const ArrayLinearization::Origin origin = linearization_.origin();
  if (problem_.evaluate_inputs(origin.jet.t) != PointStatus::ok ||
      linearization_.restore(origin, ranks) != PointStatus::ok)
    throw DamagedArchive();
  // Steps whose c differs from it by roundoff are taken with this very matrix.
  if (has_matrix && !linearization_.factor_step_matrix(linearization_.matrix().c())) throw DamagedArchive();
}

}  // namespace sfdae::core
