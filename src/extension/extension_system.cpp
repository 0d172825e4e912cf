// The strangeness-free system of the minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "array/rounding_of_guesses.h"
#include "extension/archived_structure.h"
#include "extension/strangeness_index.h"
#include "linalg/index.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Limit of weighted changes, in units of the tolerances of a step (docs/design/sparse_algebra.md).
constexpr double step_tolerance = 0.03;
// If stages are linearized one by one, the linearization only provides rounding errors and the states
// (docs/design/minimal_extension.md).
constexpr int points_between_renewals = 4;
// If these do not converge, one linearization for all stages rarely does: a shorter step is tried first
// (docs/design/sparse_algebra.md).
constexpr int failures_of_local_stages = 2;

}  // namespace

ExtensionSystem::ExtensionSystem(MinimalExtension extension, Problem& base, const AnalysisSettings& settings,
                                 std::vector<double> scales, const Jet& jet)
    : DaeSystem(base, extension.n(), {}, LeadingTerm::identity),
      settings_(settings),
      extension_(std::move(extension)),
      linearization_(extension_, counts_),
      iteration_(extension_, callback_error_),
      stages_(extension_),
      structure_(extension_, settings_.rank_tol),
      scales_(std::move(scales)) {
  resize();
  const PointStatus status = set_point(jet, ConfirmedStructure::Certificates::kept);
  if (status == PointStatus::callback_error && !callback_error_.is_recoverable()) callback_error_.raise();
  if (status == PointStatus::callback_error)
    throw Failure(SFDAE_NO_CONSISTENT_VALUES, "no values consistent with the constraints were found: " +
                                                  callback_error_.detail + " Give a better guess.");
  if (status != PointStatus::ok) throw Failure(SFDAE_RANK_UNCLEAR, what_is_unclear(status));
  find_values();
  extension_.forget_values();
}

// If no states are found, only conclusions from the blocks are certain.
std::string ExtensionSystem::what_is_unclear(PointStatus status) const {
  if (status != PointStatus::singular || !structure_.is_certified())
    return format("the structure is not confirmed at t = %.15g: ", jet_.t) + structure_.about_change();
  return format(
      "the structure is confirmed at t = %.15g, with %d free initial values and a strangeness index of at most %d, "
      "but double precision does not determine which unknowns are free there.",
      jet_.t, extension_.freedom(), extension_.offsets().index_bound());
}

ExtensionSystem::ExtensionSystem(RecordedProblem& problem, Problem& base, const AnalysisSettings& settings,
                                 Archive& saved)
    : DaeSystem(base, problem.m(), {}, LeadingTerm::identity),
      settings_(settings),
      extension_(problem, archived_structure(*problem.structure(), saved)),
      linearization_(extension_, counts_),
      iteration_(extension_, callback_error_),
      stages_(extension_),
      structure_(extension_, settings_.rank_tol) {
  resize();
  archive(saved);
}

void ExtensionSystem::resize() {
  const int n = extension_.n(), order = extension_.jet_order();
  traits_ = {.unknowns = n,
             .differential = extension_.freedom(),
             .undetermined = 0,
             .leading_size = n,
             .taylor_order = order,
             .maps_errors_in_place = true};
  history_.resize(n, order);
  jet_.n = n;
  jet_.set_order(order);
  determined_.assign(index(n) * index(order), 0);
  for (const auto& [unknown, l] : extension_.columns())
    if (l > 0) determined_[index((l - 1) * n + unknown)] = 1;
  rounding_errors_.assign(index(n), 0.0);
  scales_.resize(index(n), 0.0);
  work_.assign(index(extension_.num_rows()) + 1, 0.0);
}

void ExtensionSystem::find_values() {
  const int n = extension_.n(), d = extension_.freedom();
  const double tau = settings_.time_scale > 0.0 ? settings_.time_scale : std::exp2(linearization_.time_exponent());
  analysis_.values = {strangeness_index(extension_, linearization_, tau), d, n - d, 0, 0};
  analysis_.t = jet_.t;
  analysis_.rank_E = d;
}

PointQuality ExtensionSystem::quality() const {
  PointQuality quality;
  quality.kept_constraints = quality.kept_differential = quality.smallest_pivot = structure_.smallest_kept();
  return quality;
}

CharacteristicValues ExtensionSystem::values_at(double) {
  return structure_.about_change().empty() ? analysis_.values : CharacteristicValues();
}

// ---- Points ----------------------------------------------------------------------------------------------------

PointStatus ExtensionSystem::set_point(const Jet& jet, ConfirmedStructure::Certificates certificates) {
  jet_ = jet;
  jet_.set_order(extension_.jet_order());
  history_.restart(jet_);
  about_later_point_.clear();
  // Certifies again with the linearization, which gives the rounding errors of the jet and its distance to the
  // solution.
  PointStatus status = structure_.certify(jet_, {}, callback_error_, certificates);
  if (status == PointStatus::ok) status = renew(jet_);
  if (status != PointStatus::ok) return status;
  take_rounding_errors();
  std::vector<double> noise = linearization_.noise_of_jet();
  add_distance(noise);
  status = structure_.certify(jet_, noise, callback_error_, certificates);
  structure_.forget_what_certifies();
  return status;
}

// Adds the distance to the solution, estimated from the residuals.
void ExtensionSystem::add_distance(std::vector<double>& noise) {
  callback_error_ = extension_.residuals(jet_, work_.data());
  if (callback_error_.status != SFDAE_OK) return;
  linearization_.solve_held(work_.data());
  const StateChoice& choice = linearization_.choice();
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    if (!choice.is_held(column))
      noise[index(unknown) + index(order) * index(unknowns())] += std::fabs(work_[index(choice.slot(column))]);
  }
}

PointStatus ExtensionSystem::certify_if_due() {
  return structure_.is_due() ? structure_.certify(jet_, linearization_.noise_of_jet(), callback_error_)
                             : PointStatus::ok;
}

PointStatus ExtensionSystem::renew(const Jet& jet) {
  return note_renewal(linearization_.renew(jet, callback_error_));
}

PointStatus ExtensionSystem::note_renewal(PointStatus status) {
  iteration_.chord().forget_rate();
  if (status == PointStatus::singular && structure_.about_change().empty())
    structure_.set_about_change("no unknowns determine all others.");
  return status;
}

PointStatus ExtensionSystem::renew_at_accepted() {
  const PointStatus status = renew(history_.accepted());
  if (status == PointStatus::ok) take_rounding_errors();
  return status;
}

// Errors that no step can reduce: those of the linearization, at a point that is a solution.
void ExtensionSystem::take_rounding_errors() {
  for (int j = 0; j < unknowns(); ++j)
    rounding_errors_[index(j)] = linearization_.noise()[index(extension_.column_of(j, 0))];
}

PointStatus ExtensionSystem::move_to(double t) {
  if (t == history_.accepted().t) jet_ = history_.accepted();
  else if (t != jet_.t) history_.interpolate(t, jet_);
  return PointStatus::ok;
}

// ---- Steps -----------------------------------------------------------------------------------------------------

bool ExtensionSystem::is_drowned(const double* inverse_weights) const {
  const auto error_of = [this](int j) { return linearization_.noise()[index(extension_.column_of(j, 0))]; };
  return core::is_drowned(linearization_.origin(), history_.accepted(), error_of, inverse_weights);
}

void ExtensionSystem::leave_drowned_point(const double* inverse_weights) {
  if (!linearization_.is_usable() || !is_drowned(inverse_weights)) return;
  if (renew_at_accepted() != PointStatus::ok) linearization_.forget();
}

// Called after a step has converged.
PointStatus ExtensionSystem::judge_rounding_errors(const double* inverse_weights) {
  if (!linearization_.is_usable()) return PointStatus::ok;
  if (is_drowned(inverse_weights)) return PointStatus::not_converged;
  take_rounding_errors();
  return PointStatus::ok;
}

// Tries the current linearization, then that of the last accepted point, then that of the guess; see
// nonlinear_system.cpp.
template <class Start, class Iterate>
PointStatus ExtensionSystem::iterate_with_renewal(const double* inverse_weights, Start guess, Iterate iterate) {
  const Jet& accepted = history_.accepted();
  PointStatus status = PointStatus::not_converged;
  if (linearization_.is_usable()) {
    status = iterate();
    if (status == PointStatus::ok || is_hopeless(status)) return status;
  }
  if (!linearization_.is_usable() || linearization_.origin().t != accepted.t ||
      linearization_.origin().x != accepted.x) {
    status = renew_at_accepted();
    if (status == PointStatus::ok) status = iterate();
    if (status == PointStatus::ok || is_hopeless(status)) return status;
  }
  status = renew(guess());
  if (status == PointStatus::ok && is_drowned(inverse_weights)) status = PointStatus::not_converged;
  const DoubtedMatrix doubt(iteration_.chord());
  if (status == PointStatus::ok) status = iterate();
  if (status != PointStatus::ok) linearization_.forget();
  return status;
}

PointStatus ExtensionSystem::review_local() {
  has_end_tangents_ = true;
  const PointStatus certified = certify_if_due();
  if (certified != PointStatus::ok) return certified;
  iteration_.chord().set_slow(false);
  if (structure_.points() % points_between_renewals != 0 &&
      linearization_.is_harmless(linearization_.sensitivity(stages_.end_tangents())))
    return PointStatus::ok;
  // The end of the step does not depend on the states.
  has_end_tangents_ = false;
  const PointStatus status = renew(jet_);
  iteration_.chord().set_rate(0.1);
  return status;
}

// Renews a linearization that has become slow at the converged point, and certifies the structure periodically.
PointStatus ExtensionSystem::review() {
  ChordIteration& chord = iteration_.chord();
  const PointStatus certified = certify_if_due();
  if (certified != PointStatus::ok) return certified;
  if (!chord.is_slow()) return PointStatus::ok;
  chord.set_slow(false);
  if (iteration_.blames_matrix()) {
    linearization_.forget_step_matrix();
    return PointStatus::ok;
  }
  const PointStatus status = renew(jet_);
  chord.set_rate(0.1);
  return status;
}

PointStatus ExtensionSystem::solve(const StepEquations& equations, double* x) {
  leave_drowned_point(equations.guess.inverse_weights);
  bool holds_derivatives = false;
  const auto guess = [&]() -> const Jet& {
    history_.predict(equations.guess, 0, determined_, {}, jet_);
    if (holds_derivatives) history_.hold_derivatives(jet_);
    return jet_;
  };
  const StepTask task{equations.c, equations.w_rest, equations.guess.inverse_weights, step_tolerance};
  const auto iterate = [&] {
    return iterate_with_renewal(equations.guess.inverse_weights, guess, [&] {
      guess();
      return iteration_.solve_step(task, linearization_, jet_);
    });
  };
  PointStatus status = iterate();
  if (status != PointStatus::ok && !is_hopeless(status) && analysis_.values.mu > 0) {
    holds_derivatives = true;
    status = iterate();
  }
  if (status == PointStatus::ok) status = review();
  if (status == PointStatus::ok) status = judge_rounding_errors(equations.guess.inverse_weights);
  std::copy_n(jet_.x.data(), unknowns(), x);
  return status;
}

// Newton's method at each stage may converge beyond points where the states do not determine the other unknowns, to
// something that is not a solution. So the states have to be suitable at all stages; otherwise new ones are chosen
// where the old ones are worst. Without a better choice the step is refused.
PointStatus ExtensionSystem::solve_local_stages(const StageEquations& equations) {
  using Linearized = ExtensionStages::Linearized;
  PointStatus status = stages_.solve(equations, Linearized::at_each_stage, linearization_, iteration_);
  const Jet* const there = stages_.ill_served();
  if (there == nullptr) return status;
  const std::vector<int> states = linearization_.choice().states();
  status = note_renewal(linearization_.renew(*there, callback_error_, ExtensionLinearization::States::chosen_there));
  if (status != PointStatus::ok) return status;
  status = linearization_.choice().states() == states
               ? PointStatus::not_converged
               : stages_.solve(equations, Linearized::at_each_stage, linearization_, iteration_);
  // The prediction was unsuitable: later steps must not be judged by its rounding errors.
  if (status != PointStatus::ok && !is_hopeless(status)) renew_at_accepted();
  return status;
}

PointStatus ExtensionSystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  using Linearized = ExtensionStages::Linearized;
  t_reached = equations.t_end;
  has_end_tangents_ = false;
  leave_drowned_point(equations.guess.inverse_weights);
  stages_.predict(equations, history_, determined_);
  if (linearization_.is_usable() && stages_.may_linearize_each(equations.method.s)) {
    const PointStatus status = solve_local_stages(equations);
    if (status == PointStatus::ok) {
      failures_in_row_ = 0;
      are_stages_local_ = true;
      take_stages(x, w);
      const PointStatus reviewed = review_local();
      return reviewed == PointStatus::ok ? judge_rounding_errors(equations.guess.inverse_weights) : reviewed;
    }
    if (is_hopeless(status)) return status;
    if (status == PointStatus::not_converged && ++failures_in_row_ < failures_of_local_stages) return status;
  }
  const auto iterate = [&] {
    return iterate_with_renewal(
        equations.guess.inverse_weights, [this]() -> const Jet& { return stages_.middle(); },
        [&] { return stages_.solve(equations, Linearized::once, linearization_, iteration_); });
  };
  PointStatus status = iterate();
  if (status != PointStatus::ok && !is_hopeless(status) && analysis_.values.mu > 0) {
    stages_.hold_derivatives(history_);
    status = iterate();
  }
  if (status != PointStatus::ok) return status;
  failures_in_row_ = 0;
  are_stages_local_ = false;
  take_stages(x, w);
  status = review();
  return status == PointStatus::ok ? judge_rounding_errors(equations.guess.inverse_weights) : status;
}

ExtensionLinearization* ExtensionSystem::factors_of_stages(const StageMethod& method, double h) {
  const bool are_there = !are_stages_local_ && linearization_.is_usable() && linearization_.factor_stages(method, h);
  return are_there ? &linearization_ : nullptr;
}

void ExtensionSystem::take_stages(double* x, double* w) {
  jet_ = stages_.last();
  stages_.copy_to(x);
  stages_.copy_to(w);
}

// One real and (s - 1) / 2 complex factorizations, and about five iterations for each stage.
double ExtensionSystem::stage_cost(int s) const {
  const double evaluation = static_cast<double>(extension_.column().size());
  return evaluation * (5.0 * s + 3.0 + 12.0 * (s - 1) / 2);
}

// At the end of a step the jet contains the slopes.
void ExtensionSystem::correct_slopes(double* wdot, double* xdot) {
  const std::vector<int>& d = extension_.offsets().d;
  for (int j = 0; j < unknowns(); ++j)
    if (d[index(j)] > 0) wdot[j] = xdot[j] = jet_.column(1)[j];
}

void ExtensionSystem::error_in_x(const double* dw, int count, double* dx) {
  const int n = unknowns();
  // Renews the linearization as the next step would after a failed one.
  if (!linearization_.is_usable()) renew_at_accepted();
  const StateChoice& choice = linearization_.choice();
  for (int k = 0; k < count; ++k, dw += n, dx += n) {
    if (dx != dw) std::copy_n(dw, n, dx);
    if (!linearization_.is_usable() || differential() == n) continue;
    const ConstView tangents = has_end_tangents_ ? stages_.end_tangents() : linearization_.tangents();
    if (tangents.cols > 0) {
      add_tangents(tangents, dw, dx);
      continue;
    }
    std::fill(work_.begin(), work_.end(), 0.0);
    linearization_.subtract_states(dw, work_.data());
    linearization_.solve_held(work_.data());
    for (int j = 0; j < n; ++j)
      if (!choice.is_state(j)) dx[j] = work_[index(choice.slot(extension_.column_of(j, 0)))];
  }
}

// Sets the other x_j from changes of the states.
void ExtensionSystem::add_tangents(ConstView T, const double* dw, double* dx) const {
  const StateChoice& choice = linearization_.choice();
  for (int j = 0; j < unknowns(); ++j) {
    if (choice.is_state(j)) continue;
    const int slot = choice.slot(extension_.column_of(j, 0));
    dx[j] = 0.0;
    for (int b = 0; b < T.cols; ++b) dx[j] += T(slot, b) * dw[choice.states()[index(b)]];
  }
}

// ---- Outputs ---------------------------------------------------------------------------------------------------

// Uses the current linearization, or else one at the jet that is used once. xdot: the derivative, or null.
template <class Start>
PointStatus ExtensionSystem::solve_held(Start start, Jet& jet, double* xdot) {
  using Hope = ExtensionIteration::Hope;
  const auto solve = [&](ExtensionLinearization& linearization, Hope hope) {
    const PointStatus status = iteration_.solve_held(linearization, scales_, hope, jet);
    return status == PointStatus::ok && xdot != nullptr ? iteration_.derivative(linearization, hope, jet, xdot)
                                                        : status;
  };
  start(jet);
  const bool is_usable = linearization_.is_usable() && !history_.is_beyond(linearization_.origin().t);
  PointStatus status = is_usable ? solve(linearization_, Hope::other_linearization) : PointStatus::not_converged;
  if (status == PointStatus::ok || is_hopeless(status)) return status;
  ExtensionLinearization here(extension_, counts_);
  start(jet);
  status = here.renew(jet, callback_error_);
  return status == PointStatus::ok ? solve(here, Hope::none) : status;
}

// State that later steps depend on is not changed: requested points must not affect the steps. w is part of x;
// polynomials no longer have it once they have been archived.
void ExtensionSystem::restore(const double*, const double* x_free, const Guess& guess, double* x) {
  if (guess.taylor != nullptr && jet_.t != history_.accepted().t) history_.predict(guess, 0, determined_, {}, jet_);
  std::copy_n(x_free, unknowns(), jet_.x.data());
  const Jet guessed = jet_;
  const PointStatus status = solve_held([&guessed](Jet& jet) { jet = guessed; }, jet_, nullptr);
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                  format("no values consistent with the constraints were found at t = %.15g.", jet_.t));
  std::copy_n(jet_.x.data(), unknowns(), x);
}

bool ExtensionSystem::exact_derivative(const double* x, double* xdot) {
  const auto start = [this, x](Jet& jet) {
    jet = jet_;
    std::copy_n(x, unknowns(), jet.x.data());
  };
  Jet jet;
  const PointStatus status = solve_held(start, jet, xdot);
  if (status == PointStatus::callback_error && !callback_error_.is_recoverable()) callback_error_.raise();
  return status == PointStatus::ok;
}

bool ExtensionSystem::find_longer_jet(Jet& longer) {
  Jet jet;
  std::vector<double> xdot(index(unknowns()));
  if (solve_held([this](Jet& to) { to = jet_; }, jet, xdot.data()) != PointStatus::ok) return false;
  longer = iteration_.longer_jet();
  return true;
}

bool ExtensionSystem::consistent_derivative(const double* x, double, double* xdot) {
  if (exact_derivative(x, xdot)) return true;
  std::copy_n(jet_.column(1), unknowns(), xdot);
  return false;
}

bool ExtensionSystem::differentiates() const {
  const std::vector<int>& c = extension_.offsets().c;
  return std::any_of(c.begin(), c.end(), [](int order) { return order > 0; });
}

bool ExtensionSystem::find_differentiated(char* flags) {
  for (int j = 0; j < unknowns(); ++j) flags[j] = extension_.offsets().d[index(j)] != 0 ? 1 : 0;
  return true;
}

double ExtensionSystem::change_of_differentiated(const double* dx, const double* tolerances) const {
  double largest = 0.0;
  for (int j = 0; j < unknowns(); ++j)
    if (extension_.offsets().d[index(j)] != 0 && tolerances[j] > 0.0)
      largest = std::max(largest, std::fabs(dx[j]) / tolerances[j]);
  return largest;
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

namespace {

// Demands different unknowns whose derivatives are in the extension.
void demand_states(const std::vector<int>& states, const Offsets& offsets) {
  std::vector<char> is_met(offsets.d.size(), 0);
  for (int j : states) {
    if (j < 0 || index(j) >= is_met.size() || offsets.d[index(j)] == 0 || is_met[index(j)] != 0)
      throw DamagedArchive();
    is_met[index(j)] = 1;
  }
}

}  // namespace

void ExtensionSystem::archive(Archive& archive) {
  if (!archive.is_reading()) archive_structure(extension_.structure(), archive);
  CharacteristicValues& values = analysis_.values;
  bool is_usable = linearization_.is_usable();
  archive.small(values.mu, values.d, values.a, structure_.points(), is_usable, failures_in_row_);
  archive.real(analysis_.t);
  iteration_.archive(archive);
  linearization_.archive_choice(archive);
  archive.reals(scales_, index(unknowns()));
  archive.reals(rounding_errors_, index(unknowns()));
  history_.archive(archive);
  Jet origin = linearization_.origin();
  if (archive.is_reading()) origin = history_.accepted();
  archive.real(origin.t);
  archive.reals(origin.x, index(unknowns()) * index(extension_.jet_order() + 1));
  std::vector<int> states = linearization_.choice().states();
  states.resize(index(differential()));
  archive.small(states.data(), states.size());
  if (!archive.is_reading()) {
    linearization_.archive_lists(archive);
    linearization_.archive_matrices(archive);
    stages_.archive(archive, linearization_);
    return;
  }
  if (values.d != differential() || values.a != unknowns() - values.d) throw DamagedArchive();
  values.u = values.v = 0;
  analysis_.rank_E = values.d;
  demand_states(states, extension_.offsets());
  jet_ = history_.accepted();
  if (check_ranks() != PointStatus::ok) throw DamagedArchive();
  if (linearization_.restore(origin, states, archive, callback_error_) != PointStatus::ok) throw DamagedArchive();
  if (!linearization_.archive_matrices(archive)) throw DamagedArchive();
  stages_.archive(archive, linearization_);
  if (!is_usable) linearization_.forget();
}

}  // namespace sfdae::core
