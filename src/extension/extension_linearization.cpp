// The extension linearized at a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/extension_linearization.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "linalg/column_basis.h"
#include "linalg/index.h"
#include "linalg/random.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Other states are chosen where these move some unknown by so much more than where they were chosen, and by so many of its
// sizes if they change by theirs. Chosen, not measured.
constexpr double worth_a_choice = 3.0, harmless_sensitivity = 30.0;
// Of roundings of the terms of f, added up.
constexpr double few_roundings = 4.0;

}  // namespace

PointStatus ExtensionLinearization::linearize(const Jet& jet, CallbackError& error) {
  is_usable_ = false;
  step_.forget();
  held_.forget();
  for (auto& pair : pairs_) pair.forget();
  ++counts_.reductions;
  error = extension_.linearize(jet);
  if (error.status != SFDAE_OK) return PointStatus::callback_error;
  origin_ = jet;
  values_ = extension_.values();
  return PointStatus::ok;
}

PointStatus ExtensionLinearization::renew(const Jet& jet, CallbackError& error) {
  const PointStatus status = linearize(jet, error);
  if (status != PointStatus::ok) return status;
  note_sizes();
  const auto is_harmless = [this] {
    return sensitivity_ <= std::max(harmless_sensitivity, worth_a_choice * sensitivity_of_choice_);
  };
  const bool keeps = choices_ > 0 && factor_held() && is_harmless();
  if (!keeps) {
    if (!choose_states() || !factor_held()) return PointStatus::singular;
    sensitivity_of_choice_ = sensitivity_;
  }
  measure_noise();
  is_usable_ = true;
  return PointStatus::ok;
}

PointStatus ExtensionLinearization::restore(const Jet& jet, const std::vector<int>& states, CallbackError& error) {
  const PointStatus status = linearize(jet, error);
  if (status != PointStatus::ok) return status;
  set_states(states);
  if (!factor_held()) return PointStatus::singular;
  measure_noise();
  is_usable_ = true;
  return PointStatus::ok;
}

// That in which x_j and x_j' have derivatives of one size in equations that contain both.
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
  // As far as its powers do not overflow.
  const double largest_unit = 400.0 / extension_.jet_order();
  return count > 0 ? static_cast<int>(std::lround(std::clamp(sum / count, -largest_unit, largest_unit))) : 0;
}

// The derivatives with time in units of its own: whether columns depend on each other is not to depend on the user's.
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

// Unknowns that are no x_j, or have no x_j' in the extension, cannot be states: the others are, as far as these are not
// determined.
bool ExtensionLinearization::choose_states() {
  BasisSettings settings;
  settings.classes.assign(index(extension_.num_columns()), 0);
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    if (order == 0 && extension_.offsets().d[index(unknown)] > 0) settings.classes[index(column)] = 1;
  }
  const auto basis_of = [&](const std::vector<double>& values) {
    return column_basis({extension_.num_columns(), extension_.first(), extension_.column(), values}, settings);
  };
  const auto determines_all = [&](const ColumnBasis& basis) {
    return basis.rank == extension_.num_rows() && basis.has_all_of_class_0;
  };
  ColumnBasis basis = basis_of(values_in_own_time());
  if (!determines_all(basis)) basis = basis_of(values_);
  if (!determines_all(basis)) return false;
  std::vector<int> states;
  for (int column : basis.left_over) states.push_back(extension_.columns()[index(column)].unknown);
  std::sort(states.begin(), states.end());
  set_states(std::move(states));
  return true;
}

void ExtensionLinearization::set_states(std::vector<int> states) {
  ++choices_;
  if (choices_ > 1 && states == choice_.states()) return;
  choice_.set(extension_, std::move(states));
  step_.set_choice(choice_);
  held_.set_choice(choice_);
  for (auto& pair : pairs_) pair.set_choice(choice_);
}

bool ExtensionLinearization::factor_held() {
  ++counts_.factorizations;
  if (!held_.factor(derivatives(), choice_, 0.0)) return false;
  measure_sensitivity();
  return true;
}

// The largest |x_j| so far.
void ExtensionLinearization::note_sizes() {
  sizes_.resize(index(extension_.n()), 0.0);
  for (std::size_t j = 0; j < sizes_.size(); ++j) sizes_[j] = std::max(sizes_[j], std::fabs(origin_.x[j]));
}

// By one change of all states, with random signs.
void ExtensionLinearization::measure_sensitivity() {
  sensitivity_ = 0.0;
  std::minstd_rand generator(1);
  std::vector<double> changes(sizes_);
  for (double& change : changes)
    if (symmetric_random(generator) < 0.0) change = -change;
  work_.assign(index(choice_.size()) + 1, 0.0);
  subtract_states(changes.data(), work_.data());
  held_.solve(work_.data());
  for (int j = 0; j < extension_.n(); ++j) {
    const double size = sizes_[index(j)];
    if (choice_.is_state(j) || size == 0.0) continue;
    const double change = std::fabs(work_[index(choice_.slot(extension_.column_of(j, 0)))]);
    // Not a number counts as too much.
    sensitivity_ = std::max(sensitivity_, change <= HUGE_VAL ? change / size : HUGE_VAL);
  }
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
  const std::vector<int>& first = extension_.first();
  for (int row = 0; row < extension_.num_rows(); ++row)
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e) {
      const int column = extension_.column()[index(e)];
      if (choice_.is_held(column)) r[row] -= values_[index(e)] * changes[extension_.columns()[index(column)].unknown];
    }
}

// Roundings of the terms of each row, with random signs.
void ExtensionLinearization::measure_noise() {
  work_.assign(index(choice_.size()), 0.0);
  noise_.assign(extension_.columns().size(), 0.0);
  const std::vector<int>& first = extension_.first();
  const auto coefficient = [this](int column) {
    const auto [unknown, order] = extension_.columns()[index(column)];
    return origin_.column(order)[unknown];
  };
  std::minstd_rand generator(1);
  for (int row = 0; row < extension_.num_rows(); ++row) {
    double sum = 0.0;
    for (int e = first[index(row)]; e < first[index(row + 1)]; ++e)
      sum += std::fabs(values_[index(e)] * coefficient(extension_.column()[index(e)]));
    work_[index(row)] = symmetric_random(generator) < 0.0 ? -sum : sum;
  }
  held_.solve(work_.data());
  for (int column = 0; column < extension_.num_columns(); ++column) {
    const double own = std::fabs(coefficient(column));
    const double by_f = choice_.is_held(column) ? 0.0 : few_roundings * std::fabs(work_[index(choice_.slot(column))]);
    noise_[index(column)] = unit_roundoff * std::max(own, by_f);
  }
}

}  // namespace sfdae::core
