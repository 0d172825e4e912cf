// Functions on whose values branches of recorded equations depend.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/condition_functions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include "expression/node_copies.h"
#include "expression/recorder.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Record with unknowns in place of the user's parameters.
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
  if (evaluator.has_source()) functions_.emplace(evaluator);
  else functions_.emplace(functions_of(evaluator.record(), nodes));
  jet_.resize(3 * width_);
  for (const int node : nodes) {
    alone_.push_back({static_cast<int>(alone_.size())});
    depends_on_derivatives_.push_back((evaluator.record().dependence(node) & on_derivatives) != 0 ? 1 : 0);
    depend_on_derivatives_ = depend_on_derivatives_ || depends_on_derivatives_.back() != 0;
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
    if (functions_->has_source() || !functions_->values_of(alone_[k], t, jet_.data(), 0, g))
      g[k] = std::numeric_limits<double>::quiet_NaN();
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

namespace {

// Widths as a fraction of the tolerances. Movements of x within a width add up in the integrals of x. (Chosen: a block
// at rest creeps by 0.1 tolerances in a unit of time.)
constexpr double width_of_tolerances = 0.1;
// Least number of rounding errors in a width, so that parts of branches are accurate enough (sliding_layers.h), and
// rounding errors in a width times the relative tolerance, as unknowns may be proportional to parts of branches.
// (Chosen.)
constexpr double least_roundings = 1e7, roundings_of_tolerance = 10.0;

}  // namespace

ConditionFunctions::Widths ConditionFunctions::widths(const double* slopes, std::size_t stride, const double* x,
                                                      const double* tolerances) const {
  double open = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n_; ++i) {
    open += std::fabs(slopes[i * stride]) * tolerances[i];
    size += std::fabs(slopes[i * stride] * x[i]);
  }
  if (!(open > 0.0)) return {0.0, 0.0};
  const double roundings = std::max(least_roundings, roundings_of_tolerance * size / open);
  const double least = std::numeric_limits<double>::epsilon() * roundings * size;
  return {std::min(open, std::max(width_of_tolerances * open, least)), open};
}

// Returns 0 if the function does not change by about its slopes on both sides of the point.
double ConditionFunctions::width_of(std::size_t function, const Point& at, const double* tolerances) {
  constexpr double least_change = 0.5;  // of the width. (Chosen.)
  std::vector<double> x(n_), g(count()), beside(count()), gradients(count() * width_);
  if (!linearize(at.t, at.x, at.xdot, g.data(), gradients.data())) return 0.0;
  const auto slope = [&](std::size_t i) { return gradients[i * count() + function]; };
  const auto [width, open] = widths(gradients.data() + function, count(), at.x, tolerances);
  if (!(width > 0.0)) return 0.0;
  for (const double side : {-1.0, 1.0}) {
    for (std::size_t i = 0; i < n_; ++i) {
      const double change = slope(i) != 0.0 ? std::copysign(tolerances[i], side * slope(i)) : 0.0;
      x[i] = at.x[i] + change * width / open;
    }
    evaluate(at.t, x.data(), at.xdot, beside.data());
    const double change = side * (beside[function] - g[function]);
    if (!std::isgreaterequal(change, least_change * width)) return 0.0;
  }
  return width;
}

// Leads from a point to the surface by Newton's method, along normals in units of the tolerances. part: fraction of the
// length of the step away from it.
bool ConditionFunctions::find_zero(std::size_t function, double t, const double* tolerances, double part,
                                   Normal& at) {
  constexpr int most_iterations = 20;
  constexpr double roundings = 1e-13;
  std::vector<double> g(count()), gradients(count() * width_);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!linearize(t, at.x.data(), nullptr, g.data(), gradients.data())) return false;
    double steepness = 0.0, size = 0.0, longest = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double slope = gradients[i * count() + function];
      at.direction[i] = slope * tolerances[i] * tolerances[i];
      steepness += slope * at.direction[i];
      size += std::fabs(slope * at.x[i]);
      longest = std::max(longest, std::fabs(at.direction[i]) / std::max(std::fabs(at.x[i]), 1.0));
    }
    if (!(steepness > 0.0)) return false;
    for (std::size_t i = 0; i < n_; ++i) at.x[i] -= g[function] / steepness * at.direction[i];
    if (std::fabs(g[function]) <= roundings * (size + steepness * part / longest)) {
      for (double& component : at.direction) component *= part / longest;
      return true;
    }
  }
  return false;
}

// Functions that are zero together at the point alone are excluded: several points of the surface are checked, at
// several times. Points at which functions cannot be evaluated are skipped.
std::vector<ConditionFunctions::Side> ConditionFunctions::sides_beside(std::size_t leader, const Point& at,
                                                                       const double* tolerances) {
  constexpr double step = 1e-2, nearest = 1e-6;  // of the distance of points; of max(|x|, 1). (Chosen.)
  Normal here{{at.x, at.x + n_}, std::vector<double>(n_)};
  std::vector<Side> sides(count(), Side::none);
  sides[leader] = Side::above;
  if (!find_zero(leader, at.t, tolerances, nearest, here)) return sides;
  sides = sides_at(at.t, here);
  std::minstd_rand numbers;
  const auto offset = [&numbers](double around, double part) {
    const double number = static_cast<double>(numbers()) / static_cast<double>(std::minstd_rand::max());
    return around + part * (2.0 * number - 1.0) * std::max(std::fabs(around), 1.0);
  };
  int evaluated = 0;
  for (const double part : {0.1, 0.1, 0.01, 0.01, 1e-3, 1e-3}) {
    Normal point{std::vector<double>(n_), std::vector<double>(n_)};
    const double t = offset(at.t, part);
    for (std::size_t i = 0; i < n_; ++i) point.x[i] = offset(at.x[i], part);
    if (!find_zero(leader, t, tolerances, step * part, point)) continue;
    const std::vector<Side> there = sides_at(t, point);
    for (std::size_t k = 0; k < count(); ++k)
      if (sides[k] == Side::none || there[k] == Side::none) sides[k] = Side::none;
      else if (there[k] != sides[k]) sides[k] = Side::both;
    ++evaluated;
  }
  if (evaluated < 2) std::fill(sides.begin(), sides.end(), Side::none);
  sides[leader] = Side::above;
  return sides;
}

// Sides at one point of a surface.
std::vector<ConditionFunctions::Side> ConditionFunctions::sides_at(double t, const Normal& point) {
  constexpr double same = 1e-9;  // fraction of the change of g in the step away from the surface
  std::vector<double> on(count()), above(count()), below(count()), x(n_);
  const auto evaluate_beside = [&](double side, std::vector<double>& g) {
    for (std::size_t i = 0; i < n_; ++i) x[i] = point.x[i] + side * point.direction[i];
    evaluate(t, x.data(), nullptr, g.data());
  };
  evaluate_beside(0.0, on);
  evaluate_beside(1.0, above);
  evaluate_beside(-1.0, below);
  std::vector<Side> sides(count(), Side::none);
  for (std::size_t k = 0; k < count(); ++k) {
    const bool is_zero = std::fabs(on[k]) <= same * std::max(std::fabs(above[k]), std::fabs(below[k]));
    if (is_zero && is_met(above[k]) != is_met(below[k])) sides[k] = is_met(above[k]) ? Side::above : Side::below;
  }
  return sides;
}

std::vector<RegularizedCondition> ConditionFunctions::surfaces(const std::vector<std::size_t>& functions,
                                                               const Point& at, const double* tolerances) {
  const QuietArithmetic quiet;
  std::vector<RegularizedCondition> found;
  std::vector<char> is_taken(depends_on_derivatives_);
  for (const std::size_t leader : functions) {
    if (is_taken[leader] != 0) continue;
    const double width = width_of(leader, at, tolerances);
    if (!(width > 0.0)) continue;
    const std::vector<Side> sides = sides_beside(leader, at, tolerances);
    if (std::find(sides.begin(), sides.end(), Side::both) != sides.end()) return {};
    for (std::size_t k = 0; k < count(); ++k) {
      if (sides[k] == Side::none || is_taken[k] != 0) continue;
      is_taken[k] = 1;
      found.push_back({k, width, leader, sides[k] == Side::below});
    }
  }
  return found;
}

}  // namespace sfdae::core
