// Derivatives by finite differences on equidistant points.
//
// [F88] B. Fornberg: Generation of finite difference formulas on arbitrarily spaced grids. Math. Comp. 51, 1988.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

// weights[k * points + i]: weight of the value at nodes[i] in the k-th derivative at `at`, k = 0..highest [F88].
std::vector<double> difference_weights(double at, const std::vector<double>& nodes, int highest);

// Samples of a vector function at t + step * (i - shift), i = 0..points-1, each of `length` values, and the k-th
// derivative at t computed from all of them.
struct DifferenceFormula {
  static constexpr int points = 9;  // order 8 for the first derivative, and six derivatives with correct digits
  explicit DifferenceFormula(int shift, int highest);
  // error: largest estimated error of an entry, from the formula with two points less and from rounding.
  void apply(int k, double step, const double* samples, int length, double* derivative, double* error) const;

 private:
  // The derivative of one entry for step 1, and its error.
  struct Entry {
    double value, error;
  };
  Entry differentiate(int k, const double* samples, int stride) const;
  std::vector<double> all_, inner_;  // weights with all points and without the outer two, for step 1
};

// Shift for points around a point with so much room below and above; the step is reduced if the points need more.
int fitting_shift(double below, double above, double& step);

}  // namespace sfdae::core
