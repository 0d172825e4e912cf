// Derivatives of samples in Chebyshev points.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/chebyshev_differences.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "linalg/index.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

constexpr int chebyshev_points = ChebyshevDifferences::points;
constexpr int degree = chebyshev_points - 1;
// The polynomials of lowest degree that interpolation confuses with others, T_(degree + 1) and T_(degree + 2).
constexpr int highest_degree = degree + 2;
// Rounding errors of samples, as a multiple of those of functions that are accurate to the last bit.
constexpr double sample_roundings = 4.0;

// T_j(node(i)).
double value_of_polynomial(int j, int i) { return std::cos(std::numbers::pi * ((i * j) % (2 * degree)) / degree); }

struct Coefficients {
  // coefficient[j][i]: weight of sample i in the coefficient of T_j in the interpolating polynomial [T13, ch. 4].
  std::array<std::array<double, chebyshev_points>, chebyshev_points> coefficient{};
  double norm[2];  // of the last two rows

  Coefficients() {
    for (int j = 0; j <= degree; ++j)
      for (int i = 0; i <= degree; ++i) {
        const double ends = (j % degree == 0 ? 0.5 : 1.0) * (i % degree == 0 ? 0.5 : 1.0);
        coefficient[index(j)][index(i)] = 2.0 / degree * ends * value_of_polynomial(j, i);
      }
    for (int last = 0; last < 2; ++last) {
      double sum = 0.0;
      for (const double c : coefficient[index(degree - last)]) sum += c * c;
      norm[last] = std::sqrt(sum);
    }
  }
};

const Coefficients& coefficients() {
  static const Coefficients instance;
  return instance;
}

double sum_of(const std::array<double, chebyshev_points>& weights, const double* samples, int stride) {
  double sum = 0.0;
  for (int i = 0; i < chebyshev_points; ++i)
    sum += weights[index(i)] * samples[static_cast<std::ptrdiff_t>(i) * stride];
  return sum;
}

double size_of(const std::array<double, chebyshev_points>& weights, const double* samples, int stride) {
  double sum = 0.0;
  for (int i = 0; i < chebyshev_points; ++i)
    sum += std::fabs(weights[index(i)] * samples[static_cast<std::ptrdiff_t>(i) * stride]);
  return sum;
}

bool are_equal(const double* samples, int stride) {
  for (int i = 1; i < chebyshev_points; ++i)
    if (samples[static_cast<std::ptrdiff_t>(i) * stride] != samples[0]) return false;
  return true;
}

}  // namespace

double ChebyshevDifferences::node(int i) { return std::sin(std::numbers::pi * (degree - 2 * i) / (2.0 * degree)); }

// Errors T_13 - T_11 = -2 sin u sin 12 u and T_14 - T_10 = -2 sin 2u sin 12 u, at cos u. Near the middle between two
// points, but no simple fraction, so that no period fits the points and the probe.
double ChebyshevDifferences::probe() { return 0.3719; }

ChebyshevDifferences::ChebyshevDifferences(double at, int highest) : formulas_(index(highest + 1)) {
  // T_j^(k): 2 x T_j' + ... by differentiating T_(j+1) = 2 x T_j - T_(j-1).
  std::array<double, highest_degree + 1> lower{}, values{};
  for (int k = 0; k <= highest; ++k) {
    lower = values;
    values[0] = k == 0 ? 1.0 : 0.0;
    values[1] = k == 0 ? at : k == 1 ? 1.0 : 0.0;
    for (int j = 1; j < highest_degree; ++j)
      values[index(j + 1)] = 2.0 * at * values[index(j)] + 2.0 * k * lower[index(j)] - values[index(j - 1)];
    Formula& formula = formulas_[index(k)];
    double squares = 0.0;
    for (int i = 0; i < chebyshev_points; ++i) {
      double& weight = formula.weights[index(i)];
      for (int j = 0; j <= degree; ++j) weight += coefficients().coefficient[index(j)][index(i)] * values[index(j)];
      squares += weight * weight;
    }
    formula.norm = std::sqrt(squares);
    for (int last = 0; last < 2; ++last) formula.last[last] = values[index(degree - last)];
    for (int d = 1; d <= 2; ++d)
      formula.missed = std::max(formula.missed, std::fabs(values[index(degree + d)] - values[index(degree - d)]));
  }
}

void ChebyshevDifferences::apply(int k, double half_width, const double* samples, int length, double* derivative,
                                 double* errors) const {
  const Formula& formula = formulas_[index(k)];
  const double scale = std::pow(half_width, -k);
  for (int entry = 0; entry < length; ++entry) {
    const double* s = samples + entry;
    derivative[entry] = errors[entry] = 0.0;
    if (are_equal(s, length)) continue;
    derivative[entry] = sum_of(formula.weights, s, length) * scale;
    // The truncation error is smaller than the contribution of the last two coefficients. Independent errors of the
    // samples show there, too, while those of a smooth function are small (as differences of high order in [MW11]): the
    // larger one of two estimates of their deviation is rarely small by chance.
    double truncation = 0.0, deviation = 0.0;
    for (int last = 0; last < 2; ++last) {
      const double c = std::fabs(sum_of(coefficients().coefficient[index(degree - last)], s, length));
      truncation += c * std::fabs(formula.last[last]);
      deviation = std::max(deviation, c / coefficients().norm[last]);
    }
    const double rounding = sample_roundings * unit_roundoff * size_of(formula.weights, s, length);
    errors[entry] = (std::max(truncation, deviation * formula.norm) + rounding) * std::fabs(scale);
  }
}

double ChebyshevDifferences::error_per_probe(int k) const {
  static const double at_probe = ChebyshevDifferences(probe(), 0).formulas_.front().missed;
  return formulas_[index(k)].missed / at_probe;
}

double ChebyshevDifferences::value(const double* samples, int stride, double& rounding) const {
  const Weights& weights = formulas_.front().weights;
  rounding = sample_roundings * unit_roundoff * size_of(weights, samples, stride);
  return sum_of(weights, samples, stride);
}

}  // namespace sfdae::core
