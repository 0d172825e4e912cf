// Tolerances and the weighted norm of the error test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

struct Tolerances {
  std::vector<double> rtol, atol;  // n each
};

class ErrorWeights {
 public:
  void set(const Tolerances& tolerances);
  // weight_i = reduced (rtol_i |x_i| + atol_i). reduced = min(1, 4 tol^(1/6)) removes the growth of error / tolerance
  // with tightness (measured on 288 runs of two families; a constant factor does not).
  void update(const double* x);
  // max_i |e_i| / weight_i. A component whose weight is zero must have no error.
  double norm(const double* e) const;
  // Step size at which x changes by half the geometric mean of its size and its tolerance.
  double first_step(const double* x, const double* xdot) const;
  // Component at which norm() is attained.
  int worst(const double* e) const;
  // Largest of rounding errors of x against the tolerances; above 1 they cannot be met.
  double rounding(const double* x) const;
  // Weight of component i as the user gave it.
  double tolerance(int i, const double* x) const;

 private:
  std::vector<double> rtol_, atol_, reduction_, inverse_;
};

}  // namespace sfdae::core
