// Comparison of user-supplied derivatives with differences.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/difference_comparison.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "linalg/rank.h"
#include "problem/differences.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

constexpr int formula_points = DifferenceFormula::points;
// Spacings of the points from the widest down by factors of 4, to 4e-13; the one with the smallest estimated error
// counts.
constexpr double widest_spacing = 0.1;
constexpr double spacing_ratio = 4.0;
constexpr int spacings = 20;
// Differences may share their truncation error with their estimate, so smaller uncertainties are raised to this one.
// Three digits above rounding, by judgement.
constexpr double least_uncertainty = 1e3 * unit_roundoff;
// Rounding errors of the points where functions are called, relative to the unit.
constexpr double roundings_of_points = 4.0;

double largest(const std::vector<double>& v) { return max_abs({v.data(), static_cast<int>(v.size()), 1, 1}); }

struct Differences {
  std::vector<double> values;
  double error = -1.0;  // estimated, absolute; negative: there are none
};

Differences best_differences(int count, double unit, const OffsetFunction& function) {
  const std::size_t size = index(count);
  std::vector<double> candidate(size), samples(size * formula_points), one(size);
  Differences best;
  double h = widest_spacing * unit;
  for (int attempt = 0; attempt < spacings; ++attempt, h /= spacing_ratio) {
    bool reached = true;
    for (int i = 0; i < formula_points && reached; ++i) {
      const CallbackError callback_error = function((i - formula_points / 2) * h, one.data());
      if (callback_error.status != SFDAE_OK && !callback_error.is_recoverable()) callback_error.raise();
      reached = callback_error.status == SFDAE_OK;
      std::copy(one.begin(), one.end(), samples.begin() + static_cast<std::ptrdiff_t>(i) * count);
    }
    if (!reached) continue;  // out of the domain of the function: closer points
    double error = 0.0;
    DifferenceFormula(formula_points / 2, 1).apply(1, h, samples.data(), count, candidate.data(), &error);
    // The points themselves are rounded; for functions of low degree the formula may not notice it.
    error = std::max(error, roundings_of_points * unit_roundoff * unit / h * largest(candidate));
    if (best.error >= 0.0 && error >= best.error) continue;
    best = {candidate, error};
  }
  return best;
}

}  // namespace

std::string name_of(const DerivativeMismatch& mismatch) {
  switch (mismatch.function) {
    case 'G': return "constraint_jacobian (g_q)";
    case 'T': return "constraint_rate (g_t)";
    case 'C': return "constraint_curvature (gamma)";
    case 'H': return "nonholonomic_curvature (eta)";
    case 'x': return format("derivative %d of F_x", mismatch.order);
    case 'd': return format("derivative %d of F_xdot", mismatch.order);
    default: return format("derivative %d of %c", mismatch.order, mismatch.function);
  }
}

void compare_with_differences(const SuppliedDerivative& supplied, double unit, const OffsetFunction& function,
                              DerivativeMismatch& worst) {
  const int count = static_cast<int>(supplied.values.size());
  const Differences differences = best_differences(count, unit, function);
  if (differences.error < 0.0) return;
  double scale = std::max({largest(supplied.values), largest(differences.values), differences.error});
  if (scale == 0.0) scale = 1.0;
  const double relative = std::max(differences.error / scale, least_uncertainty);
  for (int i = 0; i < count; ++i) {
    const std::size_t at = index(i);
    const double error = std::fabs(supplied.values[at] - differences.values[at]) / scale;
    if (worst.function != 0 && error * worst.uncertainty <= worst.error * relative) continue;
    worst = {supplied.function,
             supplied.order,
             i % supplied.rows,
             supplied.first_column + i / supplied.rows,
             supplied.values[at],
             differences.values[at],
             error,
             relative};
  }
}

}  // namespace sfdae::core
