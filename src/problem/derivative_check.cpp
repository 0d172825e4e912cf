// Compares derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/derivative_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "linalg/rank.h"
#include "problem/differences.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

constexpr int points = DifferenceFormula::points;
// Spacings of the points from the widest down by factors of 4; the one with the smallest estimated error counts.
constexpr double widest_spacing = 0.1;
constexpr int spacings = 20;
// Differences may share their truncation error with their estimate: nothing below is called uncertain.
constexpr double least_uncertainty = 1e3 * unit_roundoff;

double largest(const std::vector<double>& v) { return max_abs({v.data(), static_cast<int>(v.size()), 1, 1}); }

// True if the derivative is there.
bool get(LinearProblem& problem, char which, double t, int order, std::vector<double>& values) {
  const Trouble trouble = problem.call(which, t, order, values.data());
  if (trouble.status == SFDAE_ORDER_MISSING) return false;
  if (trouble.status != SFDAE_OK) throw Failure(trouble.status, trouble.message());
  return true;
}

void compare(LinearProblem& problem, char which, double t, int order, DerivativeMismatch& worst) {
  const int rows = problem.m(), count = which == 'f' ? rows : rows * problem.n();
  const std::size_t size = static_cast<std::size_t>(count);
  std::vector<double> supplied(size), difference(size), candidate(size);
  if (!get(problem, which, t, order, supplied)) return;
  std::vector<double> samples(size * points), one(size);
  double uncertainty = -1.0, scale = largest(supplied);
  // Relative spacing: 1 near t = 0, |t| far away.
  const double unit = std::max(1.0, std::fabs(t) * 1e-3);
  double h = widest_spacing * unit;
  for (int attempt = 0; attempt < spacings; ++attempt, h /= 4.0) {
    bool reached = true;
    for (int i = 0; i < points && reached; ++i) {
      const Trouble trouble = problem.call(which, t + (i - points / 2) * h, order - 1, one.data());
      if (trouble.status != SFDAE_OK && !trouble.is_recoverable()) throw Failure(trouble.status, trouble.message());
      reached = trouble.status == SFDAE_OK;
      std::copy(one.begin(), one.end(), samples.begin() + static_cast<std::ptrdiff_t>(i) * count);
    }
    if (!reached) continue;  // out of the domain of the function: closer points
    double error = 0.0;
    DifferenceFormula(points / 2, 1).apply(1, h, samples.data(), count, candidate.data(), &error);
    if (uncertainty >= 0.0 && error >= uncertainty) continue;
    uncertainty = error;
    difference = candidate;
  }
  if (uncertainty < 0.0) return;
  scale = std::max({scale, largest(difference), uncertainty});
  if (scale == 0.0) scale = 1.0;
  const double relative = std::max(uncertainty / scale, least_uncertainty);
  for (int i = 0; i < count; ++i) {
    const std::size_t at = static_cast<std::size_t>(i);
    const double error = std::fabs(supplied[at] - difference[at]) / scale;
    if (worst.function != 0 && error * worst.uncertainty <= worst.error * relative) continue;
    worst = {which, order, i % rows, i / rows, supplied[at], difference[at], error, relative};
  }
}

}  // namespace

DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order) {
  DerivativeMismatch worst;
  // An order is judged by the one below: beyond the first mistake nothing can be said.
  for (int order = 1; order <= max_order && !worst.suspicious(); ++order)
    for (char which : {'E', 'A', 'f'})
      if (!problem.is_constant(which)) compare(problem, which, t, order, worst);
  return worst;
}

}  // namespace sfdae::core
