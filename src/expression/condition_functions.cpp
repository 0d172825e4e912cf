// Functions on whose values branches of recorded equations depend.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/condition_functions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// With unknowns in place of the user's parameters.
std::shared_ptr<const Record> functions_of(const Record& record, const std::vector<int>& nodes) {
  const int n = record.n(), user = record.num_user_parameters();
  Recorder recorder(n + user);
  const auto node_of = [&](int k) { return k < user ? recorder.unknown(n + k) : recorder.constant(0.0); };
  const std::vector<int> copies = copy_with(node_of, record, Derivatives::kept, recorder);
  std::vector<int> functions;
  for (const int node : nodes) functions.push_back(copies[index(node)]);
  return recorder.finish(std::move(functions));
}

}  // namespace

ConditionFunctions::ConditionFunctions(const TaylorEvaluator& evaluator, const std::vector<int>& nodes)
    : evaluator_(evaluator),
      n_(index(evaluator.record().n())),
      width_(n_ + index(evaluator.record().num_user_parameters())) {
  if (nodes.empty()) return;
  functions_.emplace(functions_of(evaluator.record(), nodes));
  jet_.resize(3 * width_);
  for (const int node : nodes) {
    alone_.push_back({static_cast<int>(alone_.size())});
    depend_on_derivatives_ = depend_on_derivatives_ || (evaluator.record().dependence(node) & on_derivatives) != 0;
  }
}

void ConditionFunctions::load(const double* x, const double* xdot) {
  std::copy_n(x, n_, jet_.begin());
  for (std::size_t i = n_; i < width_; ++i) jet_[i] = evaluator_.parameter(static_cast<int>(i - n_));
  const auto slopes = jet_.begin() + static_cast<std::ptrdiff_t>(width_);
  std::fill_n(slopes, width_, 0.0);
  if (xdot != nullptr) std::copy_n(xdot, n_, slopes);
}

void ConditionFunctions::evaluate(double t, const double* x, const double* xdot, double* g) {
  load(x, depend_on_derivatives_ ? xdot : nullptr);
  if (functions_->values(t, jet_.data(), 0, g)) return;
  for (std::size_t k = 0; k < count(); ++k)
    if (!functions_->values_of(alone_[k], t, jet_.data(), 0, g)) g[k] = std::numeric_limits<double>::quiet_NaN();
}

bool ConditionFunctions::linearize(double t, const double* x, const double* xdot, double* g, double* gradients) {
  load(x, xdot);
  return functions_->gradients(t, jet_.data(), {0, -1, 0}, g, nullptr, gradients);
}

std::vector<double> ConditionFunctions::resolution(double t, const double* x, const double* xdot,
                                                   const double* changes) {
  std::vector<double> g(count()), gradients(count() * width_), result(count(), 0.0);
  if (!linearize(t, x, xdot, g.data(), gradients.data())) return result;
  for (std::size_t j = 0; j < n_; ++j)
    for (std::size_t k = 0; k < count(); ++k) result[k] += std::fabs(gradients[j * count() + k]) * changes[j];
  return result;
}

std::optional<ConditionFunctions::Rates> ConditionFunctions::rates(const Point& at) {
  load(at.x, at.xdot);
  std::fill(jet_.begin() + static_cast<std::ptrdiff_t>(2 * width_), jet_.end(), 0.0);
  std::vector<double> values(2 * count());
  Rates found{std::vector<double>(count()), std::vector<double>(count() * width_)};
  if (!functions_->gradients(at.t, jet_.data(), {0, -1, 0}, values.data(), nullptr, found.gradients.data()))
    return std::nullopt;
  // Column 1 has the derivatives by t along x'.
  if (!functions_->values(at.t, jet_.data(), 1, values.data())) return std::nullopt;
  std::copy(values.begin() + static_cast<std::ptrdiff_t>(count()), values.end(), found.by_time.begin());
  return found;
}

std::optional<std::vector<double>> ConditionFunctions::shifts(const std::vector<std::size_t>& functions,
                                                              const Point& at, ConstView S,
                                                              const std::vector<int>& parameters) {
  constexpr double same = 1e-6;  // of the larger one
  std::vector<double> found(parameters.size(), 0.0);
  if (functions.empty()) return found;
  const std::optional<Rates> known = rates(at);
  if (!known) return std::nullopt;
  for (const std::size_t k : functions) {
    const auto gradient = [&](std::size_t i) { return known->gradients[i * count() + k]; };
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      double change = parameters[j] >= 0 ? gradient(n_ + index(parameters[j])) : 0.0;
      for (std::size_t i = 0; i < n_; ++i) change += gradient(i) * S(static_cast<int>(i), static_cast<int>(j));
      const double shift = change == 0.0 ? 0.0 : -change / known->by_time[k];
      if (k == functions[0]) found[j] = shift;
      const double largest = std::max(std::fabs(shift), std::fabs(found[j]));
      if (!std::islessequal(std::fabs(shift - found[j]), same * largest)) return std::nullopt;
    }
  }
  return found;
}

// Of the tolerances: what x moves by within a width adds up in what x is integrated to. (Chosen: a block at rest creeps
// by 0.1 tolerances in a unit of time.)
constexpr double width_of_tolerances = 0.1;
// Widths have so many roundings, for parts of branches to have the errors that are wanted (sliding_layers.h), and as
// many as relative tolerances have parts, as unknowns may be proportional to parts of branches. (Chosen.)
constexpr double least_roundings = 1e7, roundings_of_tolerance = 10.0;

std::vector<RegularizedCondition> ConditionFunctions::surfaces(const std::vector<std::size_t>& functions,
                                                               const Point& at, const double* tolerances) {
  constexpr double same = 1e-9;  // of gradients that are parallel
  std::vector<double> g(count()), gradients(count() * width_);
  std::vector<RegularizedCondition> found;
  if (!linearize(at.t, at.x, at.xdot, g.data(), gradients.data())) return found;
  const auto slope = [&](std::size_t k, std::size_t i) { return gradients[i * count() + k]; };
  const auto steepest = [&](std::size_t k) {
    std::size_t largest = 0;
    for (std::size_t i = 1; i < n_; ++i)
      if (std::fabs(slope(k, i)) > std::fabs(slope(k, largest))) largest = i;
    return largest;
  };
  std::vector<char> is_taken(count(), 0);
  for (const std::size_t leader : functions) {
    if (is_taken[leader] != 0) continue;
    double open = 0.0, size = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      open += std::fabs(slope(leader, i)) * tolerances[i];
      size += std::fabs(slope(leader, i) * at.x[i]);
    }
    const double roundings = std::max(least_roundings, roundings_of_tolerance * size / open);
    const double least = std::numeric_limits<double>::epsilon() * roundings * size;
    const double width = std::min(open, std::max(width_of_tolerances * open, least));
    const std::size_t i_max = steepest(leader);
    for (std::size_t k = 0; k < count(); ++k) {
      const double ratio = slope(k, i_max) / slope(leader, i_max);
      bool is_same = std::isfinite(ratio) && ratio != 0.0 && std::fabs(g[k]) <= std::fabs(ratio) * open;
      for (std::size_t i = 0; is_same && i < n_; ++i)
        is_same = std::fabs(slope(k, i) - ratio * slope(leader, i)) <= same * std::fabs(slope(k, i_max));
      if ((!is_same && k != leader) || is_taken[k] != 0) continue;
      is_taken[k] = 1;
      found.push_back({k, width, leader, ratio < 0.0});
    }
  }
  return found;
}

}  // namespace sfdae::core
