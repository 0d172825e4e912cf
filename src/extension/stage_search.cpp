// The unknowns of one stage.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/stage_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Steps are halved so often, at most, where residuals do not become smaller.
constexpr int most_halvings = 10;
constexpr int most_iterations = 50;

}  // namespace

StageSearch::StageSearch(MinimalExtension& extension, int stage, std::vector<double> W, const SearchUnits& units)
    : extension_(extension),
      stage_(stage),
      columns_(extension.columns().begin() + extension.first_column(stage),
               extension.columns().begin() + extension.first_column(stage + 1)),
      equations_{J_.first, J_.column, static_cast<int>(columns_.size())},
      W_(std::move(W)),
      dx_(columns_.size()),
      r_(index(extension.first_row(stage + 1) - extension.first_row(stage))),
      held_(columns_.size(), 0),
      unit_(units.of(columns_)),
      units_(units) {}

// HUGE_VAL: it cannot be computed. r_ becomes minus the scaled residuals.
double StageSearch::residual(const Jet& jet) {
  const CallbackError error = extension_.stage_residuals(stage_, jet, r_.data());
  if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] *= -factors_[i];
  return error.status == SFDAE_OK ? largest_entry(r_) : HUGE_VAL;
}

double StageSearch::relative(const Jet& jet) const {
  return relative_residual(J_.first, J_.column, J_.values, r_, [&](int k) {
    const auto [unknown, order] = columns_[index(k)];
    return jet.column(order)[unknown] / unit_[index(k)];
  });
}

// Errors at the guess are the user's; elsewhere the search has gone astray, maybe in an earlier stage.
const char* StageSearch::explain(const CallbackError& error, const Jet& guess, bool is_first) {
  if (!error.is_recoverable() || (is_first && extension_.linearize(guess).status != SFDAE_OK)) error.raise();
  return "the search leads to where the equations cannot be evaluated.";
}

const char* StageSearch::linearize(const Jet& guess, const Jet& jet, bool is_first) {
  CallbackError error = extension_.linearize_stage(stage_, jet, J_);
  if (error.status != SFDAE_OK) return explain(error, guess, is_first);
  scale_columns(J_.column, unit_, J_.values);
  equilibrate_rows(J_.first, J_.values, factors_);
  residual_ = residual(jet);
  if (is_first && is_solved(guess, jet)) return nullptr;
  if (is_first) step_.analyze(equations_, is_square());
  if (!step_.factor(equations_, J_.values, W_, held_)) return singular;
  if (residual_ < HUGE_VAL) return nullptr;
  error = extension_.stage_residuals(stage_, jet, r_.data());
  return error.status != SFDAE_OK ? explain(error, guess, is_first) : "the equations overflow.";
}

// Nothing is left to be done: values given that are consistent are the nearest ones. Certificates tell whether equations are
// singular there.
bool StageSearch::is_solved(const Jet& guess, const Jet& jet) const {
  if (residual_ != 0.0) return false;
  return is_square() || std::all_of(columns_.begin(), columns_.end(), [&](const MinimalExtension::Column& column) {
           return jet.column(column.order)[column.unknown] == guess.column(column.order)[column.unknown];
         });
}

// Whether it was a whole one. change_ becomes that of the jet.
bool StageSearch::step(const Jet& guess, Jet& jet) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto [unknown, order] = columns_[k];
    dx_[k] = W_[k] * (guess.column(order)[unknown] - jet.column(order)[unknown]) / unit_[k];
  }
  step_.solve(equations_, held_, dx_.data(), r_.data());
  for (std::size_t k = 0; k < columns_.size(); ++k) dx_[k] *= unit_[k];
  const Jet start = jet;
  const bool is_at_rounding = relative(jet) <= rounding_residual;
  double factor = 1.0;
  for (int halving = 0;; ++halving, factor *= 0.5) {
    change_ = {};
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const auto [unknown, order] = columns_[k];
      double& value = jet.column(order)[unknown];
      value = start.column(order)[unknown] + factor * dx_[k];
      change_.add(order, dx_[k], value, units_.sizes[index(unknown)]);
    }
    // Rounding errors need not become smaller.
    const bool is_less = residual(jet) <= residual_ || relative(jet) <= rounding_residual;
    if (!is_less && change_.is_small() && is_at_rounding) {
      // A matrix that is nearly singular makes larger errors of them.
      jet = start;
      change_ = {};
      residual(jet);
      return true;
    }
    if (is_less || change_.is_small() || halving == most_halvings) return factor == 1.0;
  }
}

const char* StageSearch::run(const Jet& guess, Jet& jet) {
  SearchProgress progress;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (const char* const why = linearize(guess, jet, iteration == 0)) return why;
    if (iteration == 0 && is_solved(guess, jet)) return nullptr;
    const bool is_whole = step(guess, jet);
    if (!change_.is_finite()) return "the search has diverged.";
    if (is_whole && progress.has_ended(change_, residual_, relative(jet))) return nullptr;
  }
  return "the search does not come to an end.";
}

}  // namespace sfdae::core
