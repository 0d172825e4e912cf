// Backward differentiation formulas of orders 1 to 5 with variable step, for a strangeness-free system.
//
// The formula differentiates the polynomial through w at the new and at k old points: D_h w = c w + w_rest.
// Variable-coefficient form where the matrices change with t anyway; fixed leading coefficient, c = alpha_k / h, for
// constant matrices, so that one factorization serves all steps of one order and size.
//
// [BCP96] K. E. Brenan, S. L. Campbell, L. R. Petzold: Numerical Solution of Initial-Value Problems in
//         Differential-Algebraic Equations. SIAM, 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "integrate/error_weights.h"
#include "integrate/step_control.h"
#include "reduction/strangeness_free_system.h"

namespace sfdae::core {

enum class StepOutcome {
  accepted,
  error_too_large,
  singular,    // the matrix of the step
  not_finite,  // overflow on the way
  trouble, changed, leading_changed  // as PointStatus
};

class Bdf {
 public:
  // First step of size h from (t, x) with slopes xdot = x' and wdot = (W x)'; w = W x.
  void start(StrangenessFreeSystem& system, double t, const std::vector<double>& x, const std::vector<double>& xdot,
             const std::vector<double>& w, const std::vector<double>& wdot, double h, int max_order);

  // Tries one step from the last point to t; commit() makes an accepted one the last point. next_step() tells
  // the size to try next, accepted or not.
  StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights);
  void commit();
  // Gives up an attempt for reasons of the caller's (a smaller step is wanted).
  void withdraw() { control_ = control_before_; }
  // After trouble: next_step() becomes smaller.
  void reduce_after_failure(double h) { next_step_ = control_.failed(h); }

  void set_max_order(int max_order) { control_.set_max_order(max_order); }

  double t() const { return times_[0]; }
  const std::vector<double>& x() const { return x_[0]; }
  double tried_t() const { return tried_t_; }
  const std::vector<double>& tried_x() const { return tried_x_; }
  double next_step() const { return next_step_; }
  void set_next_step(double h) { next_step_ = h; }
  int order() const { return last_order_; }
  int next_order() const { return control_.order(); }
  double last_step() const { return last_step_; }
  int failures_in_a_row() const { return control_.failures_in_a_row(); }
  // Of the last step; infinite before the first.
  double leading_coefficient() const { return leading_coefficient_; }
  const std::vector<double>& error() const { return error_; }  // of the last attempt, mapped to x

  // The polynomials of the last step at t: w, x (inaccurate in its constraints) and x'.
  void interpolate(double t, double* w, double* x, double* xdot);

 private:
  static constexpr int capacity = max_bdf_order + 3;
  void place_fictitious_point(double h);
  void compute_differences(int count);
  double estimate_errors(StrangenessFreeSystem& system, double h, int order, bool fixed_leading,
                         const ErrorWeights& weights, LocalTerms& terms);

  // History, newest first: points_ of them are valid. The oldest at the start is fictitious: it carries the slope.
  std::array<double, capacity> times_{};
  std::array<std::vector<double>, capacity> w_, x_;
  int points_ = 0;
  bool fictitious_ = false;
  std::vector<double> slope_w_, slope_x_;

  // Divided differences of w (and of x where there is a free part) over the newest points.
  std::array<std::vector<double>, capacity> dw_, dx_;
  bool has_free_part_ = false;

  StepControl control_, control_before_;
  LocalTerms terms_{};
  double next_step_ = 0.0, last_step_ = 0.0;
  int last_order_ = 0;
  double tried_t_ = 0.0, tried_h_ = 0.0;
  double tried_c_ = 0.0, leading_coefficient_ = std::numeric_limits<double>::infinity();
  int tried_order_ = 1;
  std::vector<double> tried_x_, tried_w_, w_rest_, x_rest_, predicted_, difference_, error_, mapped_;
  std::vector<double> differences_, mapped_differences_;  // of the orders around the present one, a column each
};

}  // namespace sfdae::core
