// Test whether finite-difference derivatives are accurate enough for the tolerances.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/difference_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Factor per step for the remembered size of a component: a passage through zero takes few steps, a decay to zero many.
// (Chosen.)
constexpr double remembered = 0.5;
// Components that start at zero need some steps to reach their size. (Chosen.)
constexpr int most_points_in_excess = 3;

void take_larger(const double* x, std::vector<double>& sizes) {
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = std::max(std::fabs(x[i]), sizes[i]);
}

std::optional<CallResult> find_excess(const std::vector<double>& errors, const std::vector<double>& sizes, double t,
                                      const ErrorWeights& weights) {
  double largest = 1.0, allowed_there = 0.0;
  int worst = -1;
  for (int i = 0; i < static_cast<int>(errors.size()); ++i) {
    const double allowed = weights.tolerance(i, sizes.data()), error = errors[index(i)];
    if (!(error > largest * allowed)) continue;
    largest = allowed > 0.0 ? error / allowed : std::numeric_limits<double>::max();
    allowed_there = allowed;
    worst = i;
  }
  if (worst < 0) return std::nullopt;
  return CallResult{SFDAE_TOLERANCE_TOO_SMALL,
                    format("the tolerances are too small for derivatives by differences (option "
                           "difference_derivatives): at t = %.15g they cause an error of about %.2g in component %d "
                           "of x, whose tolerance is %.2g. Supply the derivatives, or multiply the tolerances by "
                           "%.2g at least.",
                           t, errors[index(worst)], worst, allowed_there, largest)};
}

}  // namespace

void DifferenceCheck::accept(DaeSystem& system, const ErrorWeights& weights, const double* x, bool is_first) {
  DifferenceCheck next = *this;
  if (is_first) next.forget_points();
  if (!system.has_difference_errors()) {
    next.errors_.clear();
  } else {
    const std::size_t n = index(system.unknowns());
    next.t_ = system.t();
    next.errors_.resize(n);
    next.sizes_.resize(n, 0.0);
    system.difference_errors(x, next.errors_.data());
    for (double& size : next.sizes_) size *= remembered;
    take_larger(x, next.sizes_);
    next.points_in_excess_ = next.excess(weights) ? next.points_in_excess_ + 1 : 0;
    next.note_start(weights, x, is_first);
  }
  *this = std::move(next);
}

void DifferenceCheck::forget_points() {
  sizes_.clear();
  points_in_excess_ = 0;
}

void DifferenceCheck::note_start(const ErrorWeights& weights, const double* x, bool is_first) {
  if (errors_at_start_.empty()) {
    if (!is_first) return;
    t_start_ = t_;
    errors_at_start_ = errors_;
    sizes_since_.assign(errors_.size(), 0.0);
    points_since_ = 0;
  }
  take_larger(x, sizes_since_);
  if (++points_since_ < most_points_in_excess || excess_at_start(weights)) return;
  errors_at_start_.clear();
  sizes_since_.clear();
}

std::optional<CallResult> DifferenceCheck::excess(const ErrorWeights& weights) const {
  return find_excess(errors_, sizes_, t_, weights);
}

std::optional<CallResult> DifferenceCheck::excess_at_start(const ErrorWeights& weights) const {
  return find_excess(errors_at_start_, sizes_since_, t_start_, weights);
}

std::optional<CallResult> DifferenceCheck::lasting_excess(const ErrorWeights& weights) const {
  if (points_in_excess_ >= most_points_in_excess) return excess(weights);
  if (points_since_ >= most_points_in_excess) return excess_at_start(weights);
  return std::nullopt;
}

std::optional<CallResult> DifferenceCheck::excess_at(DaeSystem& system, const ErrorWeights& weights,
                                                     const double* x) const {
  if (!system.has_difference_errors()) return std::nullopt;
  std::vector<double> errors(index(system.unknowns())), sizes = sizes_;
  sizes.resize(errors.size(), 0.0);
  system.difference_errors(x, errors.data());
  take_larger(x, sizes);
  if (auto excess = find_excess(errors, sizes, system.t(), weights)) return excess;
  std::vector<double> sizes_since = sizes_since_;
  take_larger(x, sizes_since);
  return find_excess(errors_at_start_, sizes_since, t_start_, weights);
}

std::optional<CallResult> excess_of_differences(const ConsistentPoint& point, const Tolerances& tolerances) {
  ErrorWeights weights;
  weights.set(tolerances, Tightening::none);
  return find_excess(point.difference_errors, point.x, point.t, weights);
}

void DifferenceCheck::archive(Archive& archive, std::size_t n) {
  archive.small(points_in_excess_);
  archive.real(t_);
  bool has_last = !errors_.empty(), has_start = !errors_at_start_.empty();
  archive.small(has_last, has_start, points_since_);
  if (has_last) {
    archive.reals(errors_, n);
    archive.reals(sizes_, n);
  }
  archive.real(t_start_);
  if (!has_start) return;
  archive.reals(errors_at_start_, n);
  archive.reals(sizes_since_, n);
}

}  // namespace sfdae::core
