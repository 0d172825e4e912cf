// Solution of all equations of the extension by least changes.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/least_change_search.h"

#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

constexpr int most_search_iterations = 50, few_iterations = 12;
// Relative to the sum of weighted changes: smaller steps gain nothing.
constexpr double settled = 1e-14;

}  // namespace

LeastChangeSearch::LeastChangeSearch(MinimalExtension& extension, Demands demands, const SearchUnits& units)
    : extension_(extension),
      equations_{extension.first(), extension.column(), extension.num_columns()},
      demands_(std::move(demands)),
      unit_(units.of(extension.columns())),
      units_(units),
      dx_(demands_.W.size()),
      r_(index(extension.num_rows())) {
  step_.analyze(equations_);
}

double LeastChangeSearch::distance(int k, const Jet& from, const Jet& to) const {
  const auto [unknown, order] = extension_.columns()[index(k)];
  return (to.column(order)[unknown] - from.column(order)[unknown]) / unit_[index(k)];
}

bool LeastChangeSearch::compute(const Jet& jet, const Jet* guess) {
  CallbackError error = extension_.linearize(jet);
  if (error.status == SFDAE_OK) error = extension_.residuals(jet, r_.data());
  if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
  if (error.status != SFDAE_OK) return false;
  values_ = extension_.values();
  scale_columns(equations_.column, unit_, values_);
  equilibrate_rows(equations_.first, values_, factors_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] *= -factors_[i];
  residual_ = largest_entry(r_);
  const auto value = [&](int k) {
    const auto [unknown, order] = extension_.columns()[index(k)];
    return jet.column(order)[unknown] / unit_[index(k)];
  };
  sum_rows(equations_.first, equations_.column, values_, value, sums_);
  relative_ = residual_sizes(sums_, r_, 0.0).relative;
  if (!std::isfinite(residual_) || !step_.factor(equations_, values_, demands_.W, demands_.are_held)) return false;
  for (std::size_t k = 0; k < dx_.size(); ++k)
    dx_[k] = guess != nullptr ? draw(k) * distance(static_cast<int>(k), jet, *guess) : 0.0;
  step_.solve(equations_, demands_.are_held, dx_.data(), r_.data());
  return true;
}

JetChange LeastChangeSearch::apply(const std::vector<double>& dx, double part, Jet& jet) const {
  JetChange change;
  for (std::size_t k = 0; k < dx.size(); ++k) {
    const auto [unknown, order] = extension_.columns()[k];
    double& value = jet.column(order)[unknown];
    const double step = part * unit_[k] * dx[k];
    value += step;
    change.add(order, step, value, units_.sizes[index(unknown)]);
  }
  return change;
}

double LeastChangeSearch::sum(const Jet& guess, const Jet& jet) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < dx_.size(); ++k)
    sum += draw(k) * std::pow(distance(static_cast<int>(k), guess, jet), 2);
  return sum;
}

double LeastChangeSearch::sum_of_change() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < dx_.size(); ++k) sum += draw(k) * dx_[k] * dx_[k];
  return sum;
}

bool LeastChangeSearch::fulfil(Jet& jet) {
  SearchProgress progress;
  for (int iteration = 0; iteration < most_search_iterations; ++iteration) {
    if (!compute(jet, nullptr)) return false;
    const JetChange change = apply(dx_, 1.0, jet);
    if (!change.is_finite()) return false;
    if (progress.has_ended(change, residual_, relative_)) return true;
  }
  return false;
}

bool LeastChangeSearch::hurry(const Jet& guess, Jet& jet) {
  SearchProgress progress;
  for (int iteration = 0; iteration < few_iterations; ++iteration) {
    if (!compute(jet, &guess)) return false;
    const JetChange change = apply(dx_, 1.0, jet);
    if (!change.is_finite()) return false;
    if (progress.has_ended(change, residual_, relative_)) {
      if (sum_of_change() > demands_.negligible) settle(guess, jet);
      return true;
    }
    if (progress.is_stuck()) return false;
  }
  return false;
}

void LeastChangeSearch::approach(const Jet& guess, Jet& jet) {
  constexpr int most = 300;
  constexpr double shortest = 1.0 / 1024.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    const double before = sum(guess, jet);
    if (!compute(jet, &guess)) return;
    if (sum_of_change() <= settled * before) return settle(guess, jet);
    const std::vector<double> whole = dx_;
    bool is_nearer = false;
    for (double part = 1.0; !is_nearer && part >= shortest; part *= 0.5) {
      Jet next = jet;
      is_nearer = apply(whole, part, next).is_finite() && fulfil(next) && sum(guess, next) < before;
      if (is_nearer) jet = std::move(next);
    }
    if (!is_nearer) return;
  }
}

// Sums near the least one agree in all digits, steps do not.
void LeastChangeSearch::settle(const Jet& guess, Jet& jet) {
  constexpr double no_smaller = 0.9, small_beside_all = 1e-8;
  double last = small_beside_all * sum(guess, jet);
  for (int iteration = 0; iteration < most_search_iterations; ++iteration) {
    if (!compute(jet, &guess)) return;
    const double change = sum_of_change();
    if (!(change < no_smaller * last) || change <= demands_.negligible) return;
    last = change;
    Jet next = jet;
    if (!apply(dx_, 1.0, next).is_finite()) return;
    jet = std::move(next);
  }
}

}  // namespace sfdae::core
