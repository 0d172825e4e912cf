// Search for the unknowns of one stage.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/stage_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Most halvings of a step while residuals do not decrease.
constexpr int most_halvings = 10;
constexpr int most_stage_iterations = 50;
// A decrease of weighted residuals that outweighs the other norm. Chosen, not measured.
constexpr double much_less = 0.5;
// Changes that are squared by each step are near, and not small, at most that often.
constexpr double near = 0.01;
constexpr int most_near_solution = 3;

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

void StageSearch::sum_rows_at(const Jet& jet, std::vector<double>& sums) const {
  const auto value = [&](int k) {
    const auto [unknown, order] = columns_[index(k)];
    return jet.column(order)[unknown] / unit_[index(k)];
  };
  sum_rows(J_.first, J_.column, J_.values, value, sums);
}

// Sizes of the residuals, HUGE_VAL if they cannot be computed. r_ becomes minus the scaled residuals.
StageSearch::Residual StageSearch::residual(const Jet& jet) {
  const CallbackError error = extension_.stage_residuals(stage_, jet, r_.data());
  if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] *= -factors_[i];
  if (error.status != SFDAE_OK) return {{HUGE_VAL, HUGE_VAL}, HUGE_VAL};
  sum_rows_at(jet, sums_);
  Residual result{residual_sizes(sums_, r_, extension_.is_deep() ? rounding_residual : 0.0), 0.0};
  if (!(result.sizes.relative < HUGE_VAL)) return {result.sizes, HUGE_VAL};
  for (std::size_t i = 0; i < r_.size(); ++i) {
    const double size = std::fabs(r_[i]), unit = sums_of_linearization_[i];
    result.weighted = std::max(result.weighted, unit > 0.0 ? size / unit : size);
  }
  return result;
}

// True if residuals have decreased; roundoff need not. In deep chains rounding errors of some equations exceed others
// as a whole, in any units: they do not count, and a step is good if residuals decrease in one of two units.
bool StageSearch::has_improved() const {
  if (here_.sizes.largest <= before_.sizes.largest || here_.sizes.relative <= rounding_residual) return true;
  return extension_.is_deep() && here_.weighted <= much_less * before_.weighted;
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
  sum_rows_at(jet, sums_of_linearization_);
  before_ = here_ = residual(jet);
  if (is_first && is_solved(guess, jet)) return nullptr;
  if (is_first) step_.analyze(equations_, is_square());
  if (!step_.factor(equations_, J_.values, W_, held_)) return singular;
  if (before_.sizes.largest < HUGE_VAL) return nullptr;
  error = extension_.stage_residuals(stage_, jet, r_.data());
  return error.status != SFDAE_OK ? explain(error, guess, is_first) : "the equations overflow.";
}

// True if nothing is left to be done: given values that are consistent are the nearest ones. Certificates tell whether
// equations are singular there.
bool StageSearch::is_solved(const Jet& guess, const Jet& jet) const {
  if (!(before_.sizes.largest < HUGE_VAL) || largest_entry(r_) != 0.0) return false;
  return is_square() || std::all_of(columns_.begin(), columns_.end(), [&](const MinimalExtension::Column& column) {
           return jet.column(column.order)[column.unknown] == guess.column(column.order)[column.unknown];
         });
}

// Makes a step; true if it was a full one. change_ becomes that of the jet.
bool StageSearch::step(Toward toward, const Jet& guess, Jet& jet) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto [unknown, order] = columns_[k];
    const double distance = guess.column(order)[unknown] - jet.column(order)[unknown];
    dx_[k] = toward == Toward::guess ? W_[k] * distance / unit_[k] : 0.0;
  }
  step_.solve(equations_, held_, dx_.data(), r_.data());
  for (std::size_t k = 0; k < columns_.size(); ++k) dx_[k] *= unit_[k];
  const Jet start = jet;
  const bool is_at_rounding = before_.sizes.relative <= rounding_residual;
  double factor = 1.0;
  for (int halving = 0;; ++halving, factor *= 0.5) {
    change_ = {};
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const auto [unknown, order] = columns_[k];
      double& value = jet.column(order)[unknown];
      value = start.column(order)[unknown] + factor * dx_[k];
      change_.add(order, dx_[k], value, units_.sizes[index(unknown)]);
    }
    here_ = residual(jet);
    const bool is_less = has_improved();
    if (!is_less && change_.is_small() && is_at_rounding) {
      // A matrix that is nearly singular makes larger errors of them.
      jet = start;
      change_ = {};
      here_ = residual(jet);
      return true;
    }
    if (is_less || change_.is_small() || halving == most_halvings) return factor == 1.0;
  }
}

// These steps do not find the nearest solution if it is farther away than its curvature allows: on a circle whose
// radius is less than half the distance of the guess from its center. Then any solution is accepted, but none that is
// approached as slowly as singular points are.
const char* StageSearch::run(const Jet& guess, Jet& jet) {
  const Jet start = jet;
  const char* const why = run_toward(Toward::guess, guess, jet);
  if (why == nullptr || why == singular || is_square() || !extension_.is_deep()) return why;
  jet = start;
  return run_toward(Toward::solution, guess, jet);
}

const char* StageSearch::run_toward(Toward toward, const Jet& guess, Jet& jet) {
  SearchProgress progress;
  int near_solution = 0;
  for (int iteration = 0; iteration < most_stage_iterations; ++iteration) {
    if (const char* const why = linearize(guess, jet, iteration == 0)) return why;
    if (iteration == 0 && is_solved(guess, jet)) return nullptr;
    const bool is_whole = step(toward, guess, jet);
    if (!change_.is_finite()) return "the search has diverged.";
    if (toward == Toward::solution && change_.largest() < near && !change_.is_small()) ++near_solution;
    if (near_solution > most_near_solution) break;
    if (is_whole && progress.has_ended(change_, before_.sizes.largest, here_.sizes.relative)) return nullptr;
  }
  return "the search does not come to an end.";
}

}  // namespace sfdae::core
