// Sensitivities of consistent initial values.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/consistent_directions.h"

#include <algorithm>
#include <cmath>

#include "extension/consistent_extension.h"
#include "extension/jet_search.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/failure.h"
#include "structure/time_unit.h"

namespace sfdae::core {

namespace {

// Relative to the sum of terms: residuals of satisfied equations, residuals that may be roundoff of other equations,
// and negligible changes. Chosen, not measured.
constexpr double fulfilled = 1e-8, rounding_of_rows = 1e-12, no_change = 1e-13;
// Each solution removes most of the effect of weights of 1e-10.
constexpr int solutions_to_let_go = 3;

}  // namespace

ConsistentDirections::ConsistentDirections(MinimalExtension& extension, const ConsistencyRequest& request,
                                           const Jet& jet, const std::vector<double>& values)
    : extension_(extension),
      request_(request),
      values_(values),
      equations_{extension.first(), extension.column(), extension.num_columns()} {
  const ConsistentExtension search(extension, request);
  for (const MinimalExtension::Column& column : extension.columns()) {
    W_.push_back(search.weight(column, jet.column(column.order)[column.unknown]));
    drawn_.push_back(search.is_drawn(column) ? 1 : 0);
    held_.push_back(search.is_held(column) ? 1 : 0);
  }
  for (int j = 0; j < extension.n(); ++j) stays_.push_back(search.stays(j) ? 1 : 0);
  SearchUnits units{request.sizes()};
  units.time = time_unit(extension.problem().evaluator(), {jet.t, jet.x.data(), units.sizes}, extension.jet_order());
  unit_ = units.of(extension.columns());
  scale_columns(extension.column(), unit_, values_);
  equilibrate_rows(extension.first(), values_, factors_);
  dx_.resize(W_.size());
  r_.resize(factors_.size());
}

void ConsistentDirections::fail() const {
  if (request_.kind == InitialValues::fixed)
    throw Failure(SFDAE_FIXED_VALUES, "fixed components cannot follow the parameter with the constraints fulfilled.");
  throw Failure(SFDAE_NO_CONSISTENT_VALUES, "no derivatives of consistent values were found.");
}

bool ConsistentDirections::stay(const double* directions, const double* S) const {
  for (std::size_t j = 0; j < stays_.size(); ++j)
    if (stays_[j] != 0 && !(std::fabs(S[j] - directions[j]) <= no_change * std::fabs(directions[j]))) return false;
  return true;
}

// Rows that are sums of rounding errors alone have no residuals of their own.
template <class Value>
bool ConsistentDirections::is_fulfilled(const double* right, Value value) const {
  const std::vector<int>& first = extension_.first();
  double largest = 0.0;
  std::vector<double> residuals(factors_.size()), sums(factors_.size());
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    double residual = factors_[i] * right[i], sum = std::fabs(residual);
    for (std::size_t e = index(first[i]); e < index(first[i + 1]); ++e) {
      const double term = values_[e] * value(extension_.column()[e]);
      residual -= term;
      sum += std::fabs(term);
    }
    if (!std::isfinite(residual)) return false;
    residuals[i] = std::fabs(residual);
    sums[i] = sum;
    largest = std::max(largest, sum);
  }
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (residuals[i] > fulfilled * sums[i] && residuals[i] > rounding_of_rows * largest) return false;
  return true;
}

void ConsistentDirections::find(const double* right, const double* directions, double* S) {
  const QuietArithmetic quiet;
  const std::vector<int>& first = extension_.first();
  const std::vector<int>& column = extension_.column();
  const auto direction = [&](int k) {
    const auto [unknown, order] = extension_.columns()[index(k)];
    return order == 0 ? directions[unknown] : 0.0;
  };
  for (std::size_t i = 0; i < r_.size(); ++i) {
    r_[i] = factors_[i] * right[i];
    for (std::size_t e = index(first[i]); e < index(first[i + 1]); ++e)
      if (held_[index(column[e])] != 0) r_[i] -= values_[e] * direction(column[e]);
  }
  step_.analyze(equations_);
  if (!step_.factor(equations_, values_, W_, held_)) fail();
  // Unknowns that may end anywhere are drawn to their values in the last solution, so that they move nothing else.
  std::fill(dx_.begin(), dx_.end(), 0.0);
  for (int solution = 0; solution < solutions_to_let_go; ++solution) {
    for (std::size_t k = 0; k < dx_.size(); ++k)
      dx_[k] = W_[k] * (drawn_[k] != 0 ? direction(static_cast<int>(k)) : dx_[k]);
    step_.solve(equations_, held_, dx_.data(), r_.data());
  }
  const auto value = [&](int k) { return held_[index(k)] != 0 ? direction(k) : dx_[index(k)]; };
  if (!is_fulfilled(right, value)) fail();
  for (int j = 0; j < extension_.n(); ++j) S[j] = value(extension_.column_of(j, 0));
}

}  // namespace sfdae::core
