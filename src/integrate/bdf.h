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

#include "integrate/step_control.h"
#include "integrate/stepper.h"

namespace sfdae::core {

class Bdf final : public Stepper {
 public:
  explicit Bdf(int max_order = max_bdf_order) : max_order_(max_order) {}

  void set_options(const StepOptions& options) override;
  double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) override;
  Tightening tightening() const override { return Tightening::sixth_root; }
  void start(StrangenessFreeSystem& system, const StartingPoint& point, double h) override;
  StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) override;
  void commit() override;
  void withdraw() override { control_ = control_before_; }
  void reduce_after_failure(double h) override { next_step_ = control_.failed(h); }

  double t() const override { return times_[0]; }
  const std::vector<double>& x() const override { return x_[0]; }
  double tried_t() const override { return tried_t_; }
  const std::vector<double>& tried_x() const { return tried_x_; }
  double next_step() const override { return next_step_; }
  void set_next_step(double h) override { next_step_ = h; }
  double last_step() const override { return last_step_; }
  int order() const override { return last_order_; }
  int next_order() const override { return control_.order(); }
  int failures_in_a_row() const override { return control_.failures_in_a_row(); }
  double leading_coefficient() const override { return leading_coefficient_; }
  const std::vector<double>& error() const override { return error_; }
  // The polynomials of the last step.
  void interpolate(double t, double* w, double* x, double* xdot) override;
  void archive(Archive& archive, const StrangenessFreeSystem& system) override;

 private:
  static constexpr int capacity = max_bdf_order + 3;
  void resize(std::size_t n, std::size_t size_w);
  void place_fictitious_point(double h);
  void compute_differences(int count);
  Guess guess(const StrangenessFreeSystem& system, int degree, ErrorWeights& weights);
  double estimate_errors(StrangenessFreeSystem& system, double h, int order, bool fixed_leading,
                         const ErrorWeights& weights, LocalTerms& terms);

  int max_order_;
  // History, newest first: points_ of them are valid. The oldest at the start is fictitious: it carries the slope.
  std::array<double, capacity> times_{};
  std::array<std::vector<double>, capacity> w_, x_;
  int points_ = 0;
  bool fictitious_ = false;
  std::vector<double> slope_w_, slope_x_;

  // Divided differences of w (and of x where there is a free part) over the newest points.
  std::array<std::vector<double>, capacity> dw_, dx_;
  bool needs_x_ = false;  // the history of x beside that of w: free part, guesses
  std::vector<double> guess_, guess_before_;

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
