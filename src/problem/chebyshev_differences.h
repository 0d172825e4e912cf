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
  // Position of point i, odd about the middle.
  static double node(int i);
  // A position between the points at which the first two interpolation errors are large.
  static double probe();

  // at: in [-1, 1]; derivatives of orders 0 to highest.
  ChebyshevDifferences(double at, int highest);

  // samples: of `length` entries each, point by point. Computes derivative k of every entry and its error, estimated
  // from the entry's own samples alone: samples that are all equal have derivatives that are exactly zero; roughness of
  // samples increases the error. half_width: of the interval.
  void apply(int k, double half_width, const double* samples, int length, double* derivative, double* errors) const;
  // Error of derivative k for an error of 1 of the interpolated values at the probe, for half_width = 1.
  double error_per_probe(int k) const;
  // Interpolated value (k = 0); rounding: its error from rounding errors of the samples.
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
