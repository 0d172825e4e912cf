// Tolerances and the weighted norm of the error test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "system/strangeness_free_system.h"
#include "system/tolerances.h"

namespace sfdae::core {

// Adjustment of the tolerances before errors are compared with them.
enum class Tightening {
  none,
  sixth_root  // tol -> tol min(1, 4 tol^(1/6)) removes the growth of error / tolerance of BDF with tightness (measured
              // on 288 runs of two families; a constant factor does not)
};

class ErrorWeights {
 public:
  // safety: a factor of all tolerances, <= 1. Changes nothing if memory is missing.
  void set(const Tolerances& tolerances, Tightening tightening, double safety = 1.0);
  // Lower bounds of the weights (n values, not owned, may change, or null): errors that smaller steps cannot reduce.
  void set_floor(const double* floor) { floor_ = floor; }
  // Upper bounds of the weights (n values, not owned, may change, or null), unless rounding errors are larger.
  void set_ceiling(const double* ceiling) { ceiling_ = ceiling; }
  // Largest ratio of a floor to the weight without it in the last update.
  double floor_ratio() const { return floor_ratio_; }
  // Multiplies the weights by this factor until it is set again.
  void set_part(double part) { part_ = part; }
  double part() const { return part_; }
  // weight_i = rtol_i |x_i| + atol_i, tightened.
  void update(const double* x);
  // Updates weights; scale_i: recent size of component i, to which norm(e, exponent) relates tolerances.
  void update(const double* x, const double* scale);
  // 1 / weight_i, as of the last update.
  const double* inverse() const { return inverse_.data(); }
  // max_i |e_i| / weight_i. A component whose weight is zero must have no error.
  double norm(const double* e) const;
  // Maximum of |e_i| / weight_i for errors that are O(tol^exponent), exponent < 1, if the solution has errors O(tol).
  double norm(const double* e, double exponent) const;
  // Step size at which x changes by half of size^(1 - exponent) tolerance^exponent.
  double first_step(const double* x, const double* xdot, double exponent) const;
  // The smallest tolerance relative to its component.
  double tightest(const double* x) const;
  // Component at which norm() is attained.
  int worst(const double* e) const;
  // Largest ratio of rounding errors of x to the tolerances; above 1 they cannot be met.
  double rounding(const double* x) const;
  // Tolerance of component i as given by the user.
  double tolerance(int i, const double* x) const;

 private:
  double reduction(double tol) const;
  double relative_tolerance(int i, double size) const;

  Tightening tightening_ = Tightening::none;
  double safety_ = 1.0, part_ = 1.0;
  const double *floor_ = nullptr, *ceiling_ = nullptr;
  double floor_ratio_ = 0.0;
  PerComponent rtol_, atol_, reduction_;
  std::vector<double> inverse_;
  // Tolerances relative to the components; only without tightening, because the error norm of BDF does not need them.
  std::vector<double> relative_;
};

}  // namespace sfdae::core
