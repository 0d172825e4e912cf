// Tolerances and the weighted norm of the error test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "system/strangeness_free_system.h"
#include "system/tolerances.h"

namespace sfdae::core {

// What is done with the tolerances before errors are tested against them.
enum class Tightening {
  none,
  sixth_root  // tol -> tol min(1, 4 tol^(1/6)) removes the growth of error / tolerance of BDF with tightness (measured
              // on 288 runs of two families; a constant factor does not)
};

class ErrorWeights {
 public:
  // safety: a factor of all tolerances, <= 1. Everything is as before where memory is missing.
  void set(const Tolerances& tolerances, Tightening tightening, double safety = 1.0);
  // Weights are never less than these errors (n values that live on and may change, or null), which smaller steps
  // cannot reduce.
  void set_floor(const double* floor) { floor_ = floor; }
  // Weights are never more than these (n values that live on and may change, or null), unless rounding errors are.
  void set_ceiling(const double* ceiling) { ceiling_ = ceiling; }
  // Of the last update: the largest floor over the weight without it.
  double floor_ratio() const { return floor_ratio_; }
  // Weights are that part of what they would be, until another one is set.
  void set_part(double part) { part_ = part; }
  double part() const { return part_; }
  // weight_i = rtol_i |x_i| + atol_i, tightened.
  void update(const double* x);
  // Updates weights; scale_i: size of component i nearby, for what norm(e, exponent) takes to be relative to it.
  void update(const double* x, const double* scale);
  // 1 / weight_i, as of the last update.
  const double* inverse() const { return inverse_.data(); }
  // max_i |e_i| / weight_i. A component whose weight is zero must have no error.
  double norm(const double* e) const;
  // The largest of such ratios for errors that are O(tol^exponent) where the solution has errors O(tol), exponent <
  // 1.
  double norm(const double* e, double exponent) const;
  // Step size at which x changes by half of size^(1 - exponent) tolerance^exponent.
  double first_step(const double* x, const double* xdot, double exponent) const;
  // The smallest tolerance relative to the component.
  double tightest(const double* x) const;
  // Component at which norm() is attained.
  int worst(const double* e) const;
  // Largest of rounding errors of x against the tolerances; above 1 they cannot be met.
  double rounding(const double* x) const;
  // Weight of component i as the user gave it.
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
  // Tolerances relative to the components: of those that are not tightened, as the errors of BDF are not measured by
  // them.
  std::vector<double> relative_;
};

}  // namespace sfdae::core
