// Derivatives of samples in Chebyshev points, each with its error.
//
// [T13] L. N. Trefethen: Approximation Theory and Approximation Practice. SIAM, 2013.
// [MW11] J. J. More, S. M. Wild: Estimating computational noise. SIAM J. Sci. Comput. 33, 2011.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

namespace sfdae::core {

// The polynomial through samples at the extrema of a Chebyshev polynomial, differentiated at a point of the interval,
// [-1, 1]. At the ends of the interval, where integrations start, it is 20 times as accurate as one through
// equidistant points, in the middle not worse (docs/design/finite_differences.md).
class ChebyshevDifferences {
 public:
  static constexpr int points = 13;
  // Of point i, odd about the middle.
  static double node(int i);
  // Between the points, where both errors that interpolation has first are large.
  static double probe();

  // at: in [-1, 1]; derivatives of orders 0 to highest.
  ChebyshevDifferences(double at, int highest);

  // Samples of `length` entries each, point by point. Derivative k and its error of every entry, judged by its own
  // samples alone: samples that are all equal have derivatives that are exactly zero, those that are not smooth have
  // the error of what makes them rough. half_width: of the interval.
  void apply(int k, double half_width, const double* samples, int length, double* derivative, double* errors) const;
  // What an error of 1 at the probe, of the interpolated values, says of that of derivative k, half_width = 1.
  double error_per_probe(int k) const;
  // Errors of interpolated values by rounding those of the samples; k = 0.
  double value(const double* samples, int stride, double& rounding) const;

 private:
  using Weights = std::array<double, points>;
  struct Formula {
    Weights weights{};
    double norm = 0.0;            // of the weights
    double last[2] = {0.0, 0.0};  // derivatives of the last two Chebyshev polynomials
    double missed = 0.0;          // of what interpolation misses first, the larger one of two
  };
  std::vector<Formula> formulas_;  // by order
};

}  // namespace sfdae::core
