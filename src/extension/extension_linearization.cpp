// The extension linearized at a jet.
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_linearization.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "extension/states_by_blocks.h"
#include "linalg/column_basis.h"
#include "linalg/equilibration.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"
#include "linalg/random.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Other states are chosen if the current ones move some unknown that could be one by so much more than at their choice,
// and by so many of its sizes if they change by theirs (docs/design/minimal_extension.md).
constexpr double worth_a_choice = 3.0, harmless_sensitivity = 5.0;
// Reciprocal condition at which a choice stage by stage is taken without trying others. Chosen, not measured.
constexpr double good_condition = 1e-10;
// Values larger than so many rounding errors are certain. Chosen, not measured.
constexpr double certain = 1e3;
// As many columns as error estimates have between two linearizations, with BDF; see docs/design/structural_analysis.md.
constexpr int few_states = 3;
// Units of roundoff of the sum of the terms of f.
constexpr double few_roundings = 4.0;

}  // namespace

PointStatus ExtensionLinearization::linearize(const Jet& jet, CallbackError& error) {
  is_usable_ = false;
  step_.forget();
  held_.forget();
  for (auto& pair : pairs_) pair.forget();
  ++counts_.reductions;
  error = extension_.linearize(jet, values_);
  if (error.status != SFDAE_OK) return PointStatus::callback_error;
  origin_ = jet;
  return PointStatus::ok;
}

PointStatus ExtensionLinearization::renew(const Jet& jet, CallbackError& error, States states) {
  const PointStatus status = linearize(jet, error);
  if (status != PointStatus::ok) return status;
  // At an initial guess numbers may overflow.
  const QuietArithmetic quiet;
  note_sizes();
  const bool stay = states == States::may_stay && choices_ > 0 && factor_held() && is_harmless(sensitivity_);
  if (!stay) {
    if (!choose_states()) return PointStatus::singular;
    sensitivity_of_choice_ = sensitivity_;
  }
  is_usable_ = true;
  return PointStatus::ok;
}

bool ExtensionLinearization::is_harmless(double sensitivity) const {
  return sensitivity <= std::max(harmless_sensitivity, worth_a_choice * sensitivity_of_choice_);
}

PointStatus ExtensionLinearization::restore(const Jet& jet, const std::vector<int>& states, Archive& archive,
                                            CallbackError& error) {
  const PointStatus status = linearize(jet, error);
  if (status != PointStatus::ok) return status;
  set_states(states);
  archive_lists(archive);
  if (!factor_held()) return PointStatus::singular;
  is_usable_ = true;
  return PointStatus::ok;
}

// Unit of time in which x_j and x_j' have derivatives of one size in equations that contain both.
int ExtensionLinearization::time_exponent() const {
  const std::vector<int>& first = extension_.first();
  double sum = 0.0;
  int count = 0;
  for (int row = 0; row < extension_.num_rows(); ++row) {
    double of_x = 0.0, of_slopes = 0.0;
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int order = extension_.columns()[index(extension_.column()[index(e)])].order;
      double& largest = order == 0 ? of_x : of_slopes;
      if (order < 2) largest = std::max(largest, std::fabs(values_[index(e)]));
    }
    if (extension_.rows()[index(row)].order > 0 || of_x == 0.0 || of_slopes == 0.0) continue;
    sum += std::log2(of_slopes) - std::log2(of_x);
    ++count;
  }
  // Its powers must not overflow.
  const double largest_unit = 400.0 / extension_.jet_order();
  return count > 0 ? static_cast<int>(std::lround(std::clamp(sum / count, -largest_unit, largest_unit))) : 0;
}

// The derivatives in the equations' own unit of time: dependence of columns must not depend on the user's unit.
std::vector<double> ExtensionLinearization::values_in_own_time() const {
  const std::vector<int>& first = extension_.first();
  const int unit = time_exponent();
  std::vector<double> values(values_);
  for (int row = 0; row < extension_.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int order = extension_.columns()[index(extension_.column()[index(e)])].order;
      values[index(e)] = std::ldexp(values[index(e)], unit * (extension_.rows()[index(row)].order - order));
    }
  return values;
}

// Chooses states stage by stage: the unknowns of a stage that its equations leave over [P01]. The last stage leaves
// none, as the system Jacobian has been judged, and the others are much smaller, so that this is fast with little
// fill-in. No result if unknowns other than x_j would be left over. values: scaled with all equations, as rounding
// errors of zeros could be the only entries of a column in its stage.
std::optional<std::vector<int>> ExtensionLinearization::states_by_stages(const std::vector<double>& values) const {
  std::vector<int> states;
  states.reserve(index(extension_.freedom()));
  SparseRows stage_rows;
  for (int stage = extension_.first_stage(); stage < 0; ++stage) {
    const int first_column = extension_.first_column(stage);
    stage_rows.columns = extension_.first_column(stage + 1) - first_column;
    stage_rows.first.assign(1, 0);
    stage_rows.column.clear();
    stage_rows.value.clear();
    for (int row = extension_.first_row(stage); row < extension_.first_row(stage + 1); ++row) {
      for (int e = extension_.first()[index(row)]; e < extension_.first()[index(row + 1)]; ++e) {
        const int column = extension_.column()[index(e)] - first_column;
        if (column < 0) continue;
        stage_rows.column.push_back(column);
        stage_rows.value.push_back(values[index(e)]);
      }
      stage_rows.first.push_back(static_cast<int>(stage_rows.column.size()));
    }
    BasisSettings settings;
    settings.is_scaled = true;
    for (int column = 0; column < stage_rows.columns; ++column)
      settings.classes.push_back(may_be_state(first_column + column) ? 1 : 0);
    const ColumnBasis basis = column_basis(stage_rows, settings);
    if (basis.rank != stage_rows.rows() || !basis.has_all_of_class_0) return std::nullopt;
    for (int column : basis.left_over) states.push_back(extension_.columns()[index(first_column + column)].unknown);
  }
  std::sort(states.begin(), states.end());
  return states;
}

// Chooses states from all equations of the extension at once.
std::optional<std::vector<int>> ExtensionLinearization::states_of_all(const std::vector<double>& values) const {
  BasisSettings settings;
  for (int column = 0; column < extension_.num_columns(); ++column)
    settings.classes.push_back(may_be_state(column) ? 1 : 0);
  const ColumnBasis basis =
      column_basis({extension_.num_columns(), extension_.first(), extension_.column(), values}, settings);
  if (basis.rank != extension_.num_rows() || !basis.has_all_of_class_0) return std::nullopt;
  std::vector<int> states;
  for (int column : basis.left_over) states.push_back(extension_.columns()[index(column)].unknown);
  std::sort(states.begin(), states.end());
  return states;
}

// Unknowns that are not an x_j, or whose x_j' is not in the extension, cannot be states.
bool ExtensionLinearization::may_be_state(int column) const {
  const auto [unknown, order] = extension_.columns()[index(column)];
  return order == 0 && extension_.offsets().d[index(unknown)] > 0;
}

// Scales rows and columns by powers of two.
std::vector<double> ExtensionLinearization::scaled(std::vector<double> values) const {
  const std::vector<int>& first = extension_.first();
  Equilibration scales;
  scales.compute({extension_.num_rows(), extension_.num_columns(), first.data(), extension_.column().data()},
                 values.data());
  for (int row = 0; row < extension_.num_rows(); ++row)
    for (std::size_t e = index(first[index(row)]); e < index(first[index(row + 1)]); ++e)
      values[e] = times_power_of_two(
          values[e], scales.of_lines()[index(row)] + scales.of_crossings()[index(extension_.column()[e])]);
  return values;
}

// The factorization tells whether the states determine all other unknowns.
bool ExtensionLinearization::choose_states() {
  const std::vector<double> in_own_time = values_in_own_time();
  const auto take = [this](std::optional<std::vector<int>> states) {
    if (!states) return false;
    set_states(std::move(*states));
    return factor_held();
  };
  if (take(states_by_stages(scaled(in_own_time))) && held_.reciprocal_condition() >= good_condition) return true;
  if (extension_.is_deep() && take(states_by_blocks(extension_, origin_))) return true;
  return take(states_of_all(in_own_time)) || take(states_of_all(values_));
}

void ExtensionLinearization::set_states(std::vector<int> states) {
  ++choices_;
  if (choices_ > 1 && states == choice_.states()) return;
  ++choice_number_;
  choice_.set(extension_, std::move(states));
  held_.set_choice();
  step_.set_choice();
  for (auto& pair : pairs_) pair.set_choice();
}

bool ExtensionLinearization::factor_held() {
  ++counts_.factorizations;
  if (!held_.factor(derivatives(), choice_, 0.0)) return false;
  measure_noise();
  measure_sensitivity();
  return true;
}

// The largest |x_j| so far.
void ExtensionLinearization::note_sizes() {
  sizes_.resize(index(extension_.n()), 0.0);
  for (std::size_t j = 0; j < sizes_.size(); ++j) sizes_[j] = std::max(sizes_[j], std::fabs(origin_.x[j]));
}

// Changes of all x_j by their sizes, with random signs.
std::vector<double> ExtensionLinearization::random_changes() const {
  std::minstd_rand generator(1);
  std::vector<double> changes(sizes_);
  for (double& change : changes)
    if (symmetric_random(generator) < 0.0) change = -change;
  return changes;
}

// Largest change of an unknown that could be a state, in its size, from changes by slots. Unknowns that follow without
// a choice move with the states and say nothing about it. Unknowns that are pure roundoff have no size.
double ExtensionLinearization::sensitivity_to(const double* changes) const {
  double sensitivity = 0.0;
  for (int j = 0; j < extension_.n(); ++j) {
    const double size = sizes_[index(j)];
    const int column = extension_.column_of(j, 0);
    if (choice_.is_state(j) || !may_be_state(column) || size <= certain * noise_[index(column)]) continue;
    const double change = std::fabs(changes[choice_.slot(column)]);
    // Not a number counts as too much.
    sensitivity = std::max(sensitivity, change <= HUGE_VAL ? change / size : HUGE_VAL);
  }
  return sensitivity;
}

void ExtensionLinearization::make_tangents() {
  const int d = static_cast<int>(choice_.states().size());
  num_tangents_ = d <= few_states ? d : 0;
  const std::size_t size = index(choice_.size());
  tangents_.assign(size * index(num_tangents_), 0.0);
  std::vector<double> change(index(extension_.n()), 0.0);
  for (int b = 0; b < num_tangents_; ++b) {
    const std::size_t state = index(choice_.states()[index(b)]);
    change[state] = 1.0;
    subtract_states(change.data(), tangents_.data() + index(b) * size);
    held_.solve(tangents_.data() + index(b) * size);
    change[state] = 0.0;
  }
}

// Changes by slots, if the states change by their sizes.
std::vector<double> ExtensionLinearization::changes_by(ConstView tangents) const {
  const std::vector<double> of_states = random_changes();
  std::vector<double> changes(index(choice_.size()), 0.0);
  for (int b = 0; b < tangents.cols; ++b) {
    const double change = of_states[index(choice_.states()[index(b)])];
    for (int slot = 0; slot < tangents.rows; ++slot) changes[index(slot)] += change * tangents(slot, b);
  }
  return changes;
}

void ExtensionLinearization::measure_sensitivity() {
  make_tangents();
  if (num_tangents_ > 0) {
    sensitivity_ = sensitivity_to(changes_by(tangents()).data());
    return;
  }
  work_.assign(index(choice_.size()) + 1, 0.0);
  subtract_states(random_changes().data(), work_.data());
  held_.solve(work_.data());
  sensitivity_ = sensitivity_to(work_.data());
}

bool ExtensionLinearization::factor_step(double c) {
  if (step_.is_for(1.0 / c)) return true;
  ++counts_.factorizations;
  return step_.factor(derivatives(), choice_, 1.0 / c);
}

bool ExtensionLinearization::factor_stages(const StageMethod& method, double h) {
  if (!factor_step(method.gamma / h)) return false;
  for (std::size_t k = 0; 2 * static_cast<int>(k) + 2 < method.s; ++k) {
    const std::complex<double> epsilon = h / method.lambda[k];
    if (pairs_[k].is_for(epsilon)) continue;
    ++counts_.factorizations;
    if (!pairs_[k].factor(derivatives(), choice_, epsilon)) return false;
  }
  return true;
}

bool ExtensionLinearization::archive_matrices(Archive& archive) {
  bool is_factored = step_.archive(archive, derivatives(), choice_);
  for (auto& pair : pairs_) is_factored = pair.archive(archive, derivatives(), choice_) && is_factored;
  return is_factored;
}

void ExtensionLinearization::subtract_states(const double* changes, double* r) const {
  if (choice_.has_held_entries()) {
    for (const StateChoice::HeldEntry& held : choice_.held_entries())
      r[held.row] -= values_[index(held.entry)] * changes[held.unknown];
    return;
  }
  const std::vector<int>& first = extension_.first();
  for (int row = 0; row < extension_.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int column = extension_.column()[index(e)];
      if (choice_.is_held(column)) r[row] -= values_[index(e)] * changes[extension_.columns()[index(column)].unknown];
    }
}

std::vector<double> ExtensionLinearization::noise_of_jet() const {
  if (!is_usable_) return {};
  std::vector<double> noise(origin_.x.size(), 0.0);
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    noise[index(unknown) + index(order) * index(extension_.n())] = noise_[index(column)];
  }
  return noise;
}

// Rounding errors of the terms of each row, with random signs. Sizes are random, too: equal ones would cancel in
// equations whose terms cancel, as forces across a rod do in its multiplier.
std::vector<double> ExtensionLinearization::noise_at(const Jet& jet) {
  work_.assign(index(choice_.size()), 0.0);
  std::vector<double> noise(extension_.columns().size(), 0.0);
  // The sizes of the coefficients come first.
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    noise[index(column)] = std::fabs(jet.column(order)[unknown]);
  }
  const std::vector<int>& first = extension_.first();
  const int* const columns = extension_.column().data();
  std::minstd_rand generator(1);
  for (int row = 0; row < extension_.num_rows(); ++row) {
    double sum = 0.0;
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e)
      sum += std::fabs(values_[index(e)]) * noise[index(columns[e])];
    const double random = symmetric_random(generator);
    work_[index(row)] = (random < 0.0 ? random - 0.5 : random + 0.5) * sum;
  }
  held_.solve(work_.data());
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const double own = noise[index(column)];
    const double by_f = choice_.is_held(column) ? 0.0 : few_roundings * std::fabs(work_[index(choice_.slot(column))]);
    noise[index(column)] = unit_roundoff * std::max(own, by_f);
  }
  return noise;
}

}  // namespace sfdae::core
