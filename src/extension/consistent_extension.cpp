// Consistent jets of the minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/consistent_extension.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "extension/least_change_search.h"
#include "extension/stage_search.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"
#include "linalg/rank.h"
#include "problem/failure.h"
#include "structure/time_unit.h"

namespace sfdae::core {

namespace {

// Weight W of unknowns that may move freely, in squares of the sizes of x: far below that of the others, far above
// roundoff. Chosen, not measured.
constexpr double weight_of_free = 1e-10;
// Least changes that count, relative to the tolerances and to the changed value. By judgement.
constexpr double moved = 1e-6, beyond_rounding_of_x = 64.0 * unit_roundoff;
// Derivatives of higher order lose digits from step to step if all equations are solved together. By judgement.
constexpr int highest_order_to_approach = 6;
// Largest step toward the nearest point that may be left out, relative to the tolerances.
constexpr double thousandth = 1e-3;
// Size of a derivative relative to its unknown, in the equations' own unit of time, at which a rounding error of x
// changes it by about its size.
constexpr double beyond_rounding = 1.0 / unit_roundoff;

}  // namespace

std::vector<char> differentiated_unknowns(const Signature& signature) {
  std::vector<char> flags(index(signature.size()), 0);
  for (int i = 0; i < signature.size(); ++i)
    for (const Signature::Entry& entry : signature.row(i))
      if (entry.order > 0) flags[index(entry.unknown)] = 1;
  return flags;
}

void ConsistentExtension::fail(const Jet& jet, const char* why) const {
  // No guess helps if blocks of the system Jacobian are singular everywhere.
  const char* const advice =
      why == StageSearch::singular
          ? " If structure misleads, set structure = SFDAE_STRUCTURE_OFF; if that is a singular point alone, give "
            "another guess."
          : " Give a better guess.";
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                format("no values consistent with the constraints were found at t = %.15g: ", jet.t) + why + advice);
}

bool ConsistentExtension::is_held(const MinimalExtension::Column& column) const {
  return column.order == 0 && request_.kind == InitialValues::fixed && request_.fixed[index(column.unknown)] != 0;
}

bool ConsistentExtension::is_drawn(const MinimalExtension::Column& column) const {
  return column.order == 0 && (!request_.differentiated_stay() || differentiated_[index(column.unknown)] != 0);
}

double ConsistentExtension::weight(const MinimalExtension::Column& column, double value) const {
  const std::size_t j = index(column.unknown);
  if (column.order > 0) return 0.0;
  if (request_.is_weighted()) {
    const double ratio = least_weight_ / request_.weights[j];
    return ratio * ratio;
  }
  if (!request_.differentiated_stay()) return 1.0;
  if (is_drawn(column)) return 1.0 / (drawn_sizes_[j] * drawn_sizes_[j]);
  const double size = std::max(units_.sizes[j], std::fabs(value));
  return weight_of_free / (size * size);
}

Jet ConsistentExtension::find(const PointOfInterest& point) {
  Jet nearest = find_nearest(point);
  if (!request_.differentiated_stay() || !may_be_digits(point.x, nearest)) return nearest;
  const ConsistencyRequest trusting = request_.trusting_digits(point.x);
  drawn_sizes_ = trusting.sizes();
  std::optional<Jet> by_digits;
  try {
    by_digits = find_nearest(point);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
  }
  drawn_sizes_ = units_.sizes;
  return by_digits && is_within(trusting.tolerances, point.x, *by_digits) ? std::move(*by_digits)
                                                                          : std::move(nearest);
}

// True if something has moved, and a jet may exist that moves everything by less than its tolerance: the nearest one
// has the least sum of squares.
bool ConsistentExtension::may_be_digits(const double* given, const Jet& found) const {
  double sum = 0.0;
  int count = 0;
  bool has_moved = false;
  for (int j = 0; j < extension_.n(); ++j) {
    if (!is_drawn({j, 0})) continue;
    const double change = std::fabs(found.x[index(j)] - given[j]), size = units_.sizes[index(j)];
    const double in_sizes = change / size;
    has_moved = has_moved || change > beyond_rounding_of_x * std::max(std::fabs(given[j]), size);
    sum += in_sizes * in_sizes;
    ++count;
  }
  return has_moved && sum <= count;
}

bool ConsistentExtension::is_within(const std::vector<double>& tolerances, const double* given,
                                    const Jet& found) const {
  for (int j = 0; j < extension_.n(); ++j)
    if (is_drawn({j, 0}) && !(std::fabs(found.x[index(j)] - given[j]) <= tolerances[index(j)])) return false;
  return true;
}

Jet ConsistentExtension::find_nearest(const PointOfInterest& point) {
  // Nearly singular matrices lead to numbers that are not finite, which the searches check.
  const QuietArithmetic quiet;
  Jet guess;
  guess.t = point.t;
  guess.n = extension_.n();
  guess.x.assign(point.x, point.x + extension_.n());
  guess.set_order(extension_.jet_order());
  if (point.xdot != nullptr) std::copy_n(point.xdot, extension_.n(), guess.column(1));
  units_.time =
      time_unit(extension_.problem().evaluator(), {guess.t, guess.x.data(), units_.sizes}, extension_.jet_order());
  Jet jet = guess;
  // Derivatives beyond the extension have no meaning.
  for (int j = 0; j < extension_.n(); ++j)
    if (extension_.offsets().d[index(j)] == 0) jet.column(1)[j] = 0.0;
  for (int stage = extension_.first_stage(); stage <= 0; ++stage) solve_stage(stage, guess, jet);
  if (has_to_move(guess, jet)) solve_together(guess, jet);
  return jet;
}

// True if the stages have moved values that are to stay: they ignore later stages and fixed values.
bool ConsistentExtension::has_to_move(const Jet& guess, const Jet& jet) const {
  if (request_.is_weighted()) return true;
  for (int j = 0; j < extension_.n(); ++j) {
    const double change = std::fabs(jet.x[index(j)] - guess.x[index(j)]);
    const double least =
        std::max(moved * units_.sizes[index(j)], beyond_rounding_of_x * std::fabs(guess.x[index(j)]));
    if (stays(j) && change > least) return true;
  }
  return false;
}

// Solves one stage. Derivatives, which are unknown, get little weight.
void ConsistentExtension::solve_stage(int stage, const Jet& guess, Jet& jet) {
  const int rows = extension_.first_row(stage + 1) - extension_.first_row(stage);
  const int first = extension_.first_column(stage), last = extension_.first_column(stage + 1);
  if (rows == 0) return;
  std::vector<double> W;
  for (int k = first; k < last; ++k) {
    const MinimalExtension::Column& column = extension_.columns()[index(k)];
    const double size = units_.sizes[index(column.unknown)];
    W.push_back(rows == last - first ? 0.0 : column.order > 0 ? weight_of_free / (size * size) : weight(column));
  }
  if (const char* const why = StageSearch(extension_, stage, std::move(W), units_).run(guess, jet)) fail(jet, why);
}

// True if all equations together do not determine any digit of some derivative; stage by stage they may.
bool ConsistentExtension::has_derivatives_beyond_rounding(const Jet& jet) const {
  for (const auto& [unknown, order] : extension_.columns()) {
    const double size = std::max(std::fabs(jet.x[index(unknown)]), units_.sizes[index(unknown)]);
    const double derivative = std::fabs(jet.column(order)[unknown]) * std::pow(units_.time, order);
    if (!(derivative < beyond_rounding * size)) return true;
  }
  return false;
}

void ConsistentExtension::solve_together(const Jet& guess, Jet& jet) {
  const std::vector<MinimalExtension::Column>& columns = extension_.columns();
  LeastChangeSearch::Demands demands;
  if (request_.differentiated_stay()) demands.negligible = thousandth * thousandth;
  bool is_candidate = true;  // consistent, and fixed values are as given
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto [unknown, order] = columns[k];
    const bool is_fixed = is_held(columns[k]);
    demands.W.push_back(weight(columns[k], jet.column(order)[unknown]));
    demands.are_drawn.push_back(is_drawn(columns[k]) ? 1 : 0);
    demands.are_held.push_back(is_fixed ? 1 : 0);
    const double change = jet.column(order)[unknown] - guess.column(order)[unknown];
    if (is_fixed && std::fabs(change) > moved * units_.sizes[index(unknown)]) is_candidate = false;
    if (is_fixed) jet.column(order)[unknown] = guess.column(order)[unknown];
  }
  // The jet is consistent, though it need not be the nearest one.
  const bool may_stay = !request_.is_weighted() && request_.kind != InitialValues::fixed;
  if (may_stay && has_derivatives_beyond_rounding(jet)) return;
  LeastChangeSearch search(extension_, std::move(demands), units_);
  // From values that are consistent already, searches may run away if equations are nearly dependent.
  const auto runs_away = [&](const Jet& found) {
    return is_candidate && search.sum(guess, found) > search.sum(guess, jet);
  };
  if (!request_.is_weighted()) {
    Jet quick = jet;
    if (search.hurry(guess, quick) && !runs_away(quick)) {
      jet = std::move(quick);
      return;
    }
    // If constraints are curved, full steps may converge slowly, or not at all.
    if (may_stay) {
      if (extension_.jet_order() <= highest_order_to_approach) search.approach(guess, jet);
      return;
    }
  }
  Jet next = jet;
  const bool is_fulfilled = search.fulfil(next);
  if (is_fulfilled && !runs_away(next)) jet = std::move(next);
  if (is_fulfilled || is_candidate) {
    search.approach(guess, jet);
    return;
  }
  if (request_.kind == InitialValues::fixed)
    throw Failure(
        SFDAE_NO_CONSISTENT_VALUES,
        format("no consistent values were found near the guess at t = %.15g that leave the fixed components as "
               "they are. Give a better guess, or fix fewer components.",
               jet.t));
  fail(jet, "the search does not come to an end.");
}

void ConsistentExtension::report(const PointOfInterest& point, const Jet& found, ConsistentPoint& result) const {
  const std::size_t n = index(extension_.n());
  const std::vector<double> given(point.x, point.x + n),
      consistent(found.x.begin(), found.x.begin() + extension_.n());
  std::vector<double> changes(n, 0.0);
  double sum = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    const double change = consistent[j] - given[j];
    sum = std::hypot(sum, change);
    if (differentiated_[j] != 0) changes[j] = change;
  }
  result.change.residual_before = sum;
  report_change(request_, point.t, given, consistent, result.change);
  if (request_.reports_changes())
    result.value_change = largest_change(given.data(), changes.data(), request_.tolerances, extension_.n());
}

}  // namespace sfdae::core
