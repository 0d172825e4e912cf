// Sensitivities of equations that are solved by their minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "sensitivity/extension_sensitivities.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "extension/consistent_directions.h"
#include "extension/consistent_extension.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Residuals of equations none of which is differentiated: rounding errors are not amplified from step to step, as they
// may be with hidden constraints (see rounding_of_residuals).
constexpr double harmless_residuals = 1e-14;

}  // namespace

ExtensionSensitivities::ExtensionSensitivities(ExtensionSystem& system, std::vector<int> parameters)
    : system_(system),
      extension_(system.extension()),
      numbers_(std::move(parameters)),
      parameters_(extension_.problem(), numbers_),
      equations_(extension_, parameters_, numbers_),
      stages_(equations_) {}

// Takes the states of x; lists of operations belong to one choice.
void ExtensionSensitivities::take_choice() {
  if (choice_number_ == system_.linearization().choice_number()) return;
  const StateChoice& choice = system_.linearization().choice();
  choice_number_ = -1;  // while memory may be missing
  slots_.set(extension_, choice);
  held_.analyze(choice.pattern(true));
  stages_.set_choice(choice, slots_);
  step_.set(choice, slots_, equations_.varying(),
            extension_.highest_level() > 0 ? rounding_of_residuals : harmless_residuals);
  right_.assign(index(extension_.num_rows()) * index(count()) + 1, 0.0);
  solution_ = right_;
  choice_number_ = system_.linearization().choice_number();
}

PointStatus ExtensionSensitivities::linearize(const Jet& jet) {
  take_choice();
  ++linearizations_;
  callback_error_ = equations_.linearize(jet, here_);
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

void ExtensionSensitivities::copy_x(const double* from_slots, double* S) const {
  for (int q = 0; q < count(); ++q, from_slots += extension_.num_rows())
    for (int j = 0; j < unknowns(); ++j) *S++ = from_slots[slots_.of_x(j)];
}

// ---- Steps -----------------------------------------------------------------------------------------------------

// S_j' = c S_j + rest_j for the states.
PointStatus ExtensionSensitivities::solve_step(double c, const double* rest, const double*, double* S) {
  const PointStatus status = linearize(system_.jet());
  if (status != PointStatus::ok) return status;
  std::copy(here_.right.begin(), here_.right.end(), right_.begin());
  const double* const of_entries = here_.values.data();
  double* right = right_.data();
  for (int q = 0; q < count(); ++q, rest += unknowns(), right += extension_.num_rows())
    for (const SensitivitySlots::Entry& entry : slots_.slopes())
      right[entry.row] -= of_entries[entry.entry] * rest[entry.state];
  ++factorizations_;
  if (!step_.solve(here_, c, right_.data(), count(), solution_.data())) return PointStatus::singular;
  copy_x(solution_.data(), S);
  return PointStatus::ok;
}

void ExtensionSensitivities::keep(const StageMethod& method, int i, const Jet& jet) {
  if (kept_.jets.size() < index(method.s)) kept_.jets.resize(index(method.s));
  kept_.jets[index(i)] = jet;
}

PointStatus ExtensionSensitivities::keep_stage_of_step(const StageMethod& method, int i, const double*) {
  kept_.are_of_step = true;
  keep(method, i, system_.jet_of_stage(i));
  return PointStatus::ok;
}

PointStatus ExtensionSensitivities::keep_stage(const StageMethod& method, int i, const double*) {
  kept_.are_of_step = false;
  keep(method, i, system_.jet());
  return PointStatus::ok;
}

PointStatus ExtensionSensitivities::solve_kept_stages(const StageMethod& method, double h, const double* S_start,
                                                      double* S) {
  take_choice();
  linearizations_ += method.s;
  callback_error_ = equations_.linearize(kept_.jets, method.s, kept_.rows);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  const ExtensionSensitivityStages::Task task{method, h, kept_.jets, kept_.rows, S_start, system_.scales()};
  LocalStages* const local = kept_.are_of_step ? system_.local_factors_of_stages() : nullptr;
  if (stages_.solve_locally(task, system_.linearization(), local, S)) return PointStatus::ok;
  ExtensionLinearization* const by = kept_.are_of_step ? system_.factors_of_stages(method, h) : nullptr;
  return stages_.solve(task, by, S) ? PointStatus::ok : PointStatus::singular;
}

// ---- Points ----------------------------------------------------------------------------------------------------

bool ExtensionSensitivities::solve_held(const double* S) {
  values_.clear();
  // 0: not -0
  for (int e : system_.linearization().choice().entries_of_held()) values_.push_back(0.0 + here_.values[index(e)]);
  std::copy(here_.right.begin(), here_.right.end(), right_.begin());
  for (int q = 0; q < count(); ++q, S += unknowns())
    for (const SensitivitySlots::Entry& entry : slots_.held())
      right_[index(q) * index(extension_.num_rows()) + index(entry.row)] -=
          here_.values[entry.entry] * S[entry.state];
  ++factorizations_;
  return held_.solve(values_, right_.data(), count(), solution_.data());
}

// Copies S with the present states; in their place solution_ has S_j'.
void ExtensionSensitivities::copy_held(const double* from, double* S) const {
  copy_x(solution_.data(), S);
  for (std::ptrdiff_t q = 0; q < count(); ++q)
    for (int j : system_.linearization().choice().states()) S[q * unknowns() + j] = from[q * unknowns() + j];
}

PointStatus ExtensionSensitivities::restore(const double* guess, double* S) {
  if (system_.differential() == unknowns()) {
    take_choice();
    std::copy_n(guess, size(), S);
    return PointStatus::ok;
  }
  const PointStatus status = linearize(system_.jet());
  if (status != PointStatus::ok) return status;
  if (!solve_held(guess)) return PointStatus::singular;
  copy_held(guess, S);
  return PointStatus::ok;
}

// Slopes of x_j with d_j > 0 are in the extension; all rows differentiated once more determine the others.
PointStatus ExtensionSensitivities::derivative(const double* S, double* Sdot) {
  const std::vector<int>& d = extension_.offsets().d;
  const bool has_all = std::find(d.begin(), d.end(), 0) == d.end();
  Jet longer;
  if (!has_all && !system_.find_longer_jet(longer)) {
    callback_error_ = system_.callback_error();
    return callback_error_.status != SFDAE_OK && !callback_error_.is_recoverable() ? PointStatus::callback_error
                                                                                   : PointStatus::ok;
  }
  const PointStatus status = linearize(system_.jet());
  if (status != PointStatus::ok) return status;
  if (!solve_held(S)) return PointStatus::singular;
  const StateChoice& choice = system_.linearization().choice();
  for (int q = 0; q < count(); ++q)
    for (int j = 0; j < unknowns(); ++j)
      if (d[index(j)] > 0)
        Sdot[index(q) * index(unknowns()) + index(j)] =
            solution_[index(q) * index(extension_.num_rows()) + index(choice.slot(extension_.column_of(j, 1)))];
  if (has_all) return PointStatus::ok;
  // The Taylor coefficients of S that are known.
  const std::size_t length = index(unknowns()) * index(extension_.jet_order() + 2);
  taylor_.assign(length * index(count()), 0.0);
  for (int q = 0; q < count(); ++q)
    for (int column = 0; column < extension_.num_columns(); ++column) {
      const auto [unknown, order] = extension_.columns()[index(column)];
      taylor_[index(q) * length + index(order) * index(unknowns()) + index(unknown)] =
          choice.is_held(column) ? S[index(q) * index(unknowns()) + index(unknown)]
                                 : solution_[index(q) * index(extension_.num_rows()) + index(choice.slot(column))];
    }
  return find_next_coefficients(longer, Sdot);
}

// For x_j with d_j = 0, finds x_j', with the matrix of the held states, in values_.
PointStatus ExtensionSensitivities::find_next_coefficients(const Jet& longer, double* Sdot) {
  callback_error_ = equations_.slopes(longer, taylor_.data(), right_.data());
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  for (double& value : right_) value = -value;
  if (!held_.solve(values_, right_.data(), count(), solution_.data())) return PointStatus::singular;
  for (int q = 0; q < count(); ++q)
    for (int j = 0; j < unknowns(); ++j)
      if (extension_.offsets().d[index(j)] == 0)
        Sdot[index(q) * index(unknowns()) + index(j)] =
            solution_[index(q) * index(extension_.num_rows()) + index(slots_.of_x(j))];
  return PointStatus::ok;
}

// ---- Starts ----------------------------------------------------------------------------------------------------

// Returns whether all states are differential variables, whose directions then determine S.
bool ExtensionSensitivities::states_are_differentiated() const {
  const std::vector<char> differentiated = differentiated_unknowns(extension_.problem().structure()->signature);
  const std::vector<int>& states = system_.linearization().choice().states();
  return std::all_of(states.begin(), states.end(), [&](int j) { return differentiated[index(j)] != 0; });
}

void ExtensionSensitivities::start(const ConsistencyRequest& request, const double* directions, double* S) {
  equations_.take_parameters();
  const PointStatus status = linearize(system_.jet());
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (system_.differential() == unknowns()) {
    std::copy_n(directions, size(), S);
    return;
  }
  ConsistentDirections nearest(extension_, request, system_.jet(), here_.values);
  const bool has_candidates = states_are_differentiated() && solve_held(directions);
  if (has_candidates) copy_held(directions, S);
  for (int q = 0; q < count(); ++q, directions += unknowns(), S += unknowns()) {
    if (has_candidates && nearest.stay(directions, S)) continue;
    try {
      nearest.find(here_.right.data() + index(q) * index(extension_.num_rows()), directions, S);
    } catch (const Failure& failure) {
      throw Failure(failure.status(),
                    format("sensitivity %d, whose directions take the place of values: ", q) + failure.what());
    }
  }
}

// ---- Checkpoints -----------------------------------------------------------------------------------------------

// Values that are evaluated once for a step are not archived.
void ExtensionSensitivities::archive(Archive& archive) {
  take_choice();
  long factorizations = counts().factorizations;
  archive.counts(linearizations_, factorizations);
  if (archive.is_reading()) factorizations_ = factorizations;
  step_.archive(archive);
  held_.archive(archive);
  stages_.archive(archive, system_.linearization());
}

}  // namespace sfdae::core
