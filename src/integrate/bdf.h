// Backward differentiation formulas of orders 1 to 5 with variable step, for a strangeness-free system.
//
// The formula differentiates the polynomial through w at the new and at k old points: D_h w = c w + w_rest.
// Variable-coefficient form if the matrices depend on t; fixed leading coefficient, c = alpha_k / h, for constant
// matrices, so that one factorization is reused for all steps of one order and size (docs/design/bdf.md).
//
// [BCP96] K. E. Brenan, S. L. Campbell, L. R. Petzold: Numerical Solution of Initial-Value Problems in
//         Differential-Algebraic Equations. SIAM, 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "integrate/bdf_error_estimate.h"
#include "integrate/bdf_history.h"
#include "integrate/bdf_step.h"
#include "integrate/step_control.h"
#include "integrate/stepper.h"
#include "integrate/taylor_guess.h"

namespace sfdae::core {

class Bdf final : public Stepper {
 public:
  explicit Bdf(int max_order = max_bdf_order) : Stepper(Tightening::sixth_root), max_order_(max_order) {}

  void set_options(const StepOptions& options) override;
  double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) override;
  void start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) override;
  StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) override;
  using Stepper::test_beside;
  StepOutcome test_beside(const LocalTerms& terms, double error) override;
  bool judges_higher_order() const override { return judged_.may_rise; }
  void commit() override;
  void withdraw() override { control_ = control_before_; }
  void reduce_after_failure(double h) override { next_step_ = control_.failed(h); }
  void set_next_step(double h) override { next_step_ = h; }

  StepState state() const override;
  TriedStep tried() const override {
    return {tried_.t, tried_.h, tried_.order, tried_.x.data(), tried_.c, tried_.w_rest.data(), nullptr, nullptr};
  }
  PointsOfCurve points_of_tried() const override;
  const std::vector<double>& x() const override { return history_.x(); }
  const std::vector<double>& tried_x() const override { return tried_.x; }
  const std::vector<double>& error() const override { return estimate_.error(); }
  // Evaluation of the polynomials of the last step.
  void interpolate(const PointValues& point) override;
  bool interpolates_x(ErrorWeights& weights) override;
  Guess guess_within(double t, int order) override;
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights&, const PointValues& point) override {
    return system.move_to(point.t);
  }
  void archive(Archive& archive, const StrangenessFreeSystem& system) override;

 private:
  void resize(const StrangenessFreeSystem& system);
  int degree_within() const { return std::min(std::max(last_.order, 1), history_.points() - 1); }
  void prepare_interpolation();
  void forget_interpolation() {
    has_differences_ = false;
    interpolates_x_.reset();
    guess_.forget_ends();
  }
  Guess guess(const StrangenessFreeSystem& system, ErrorWeights& weights);
  StepOutcome judge(const LocalTerms& terms, double error);
  int degree_of_guess(const StrangenessFreeSystem& system) const;
  double course_of_tried(const double* predicted, int points, const ErrorWeights& weights) const;

  int max_order_;
  BdfHistory history_;
  bool is_linear_ = true;
  bool needs_x_ = false;  // differences of x as well as of w: undetermined part, initial guesses
  BdfStep tried_;
  TaylorGuess guess_;
  BdfErrorEstimate estimate_;
  StepControl control_, control_before_;
  struct Judged {
    LocalTerms terms;
    double error;
    bool may_rise;
  } judged_{};  // the last attempt
  LastStep last_;
  double next_step_ = 0.0;
  // Points within the last step: true if the differences of the history include those of its polynomials and one more;
  // whether its x is accurate, once computed.
  bool has_differences_ = false;
  std::optional<bool> interpolates_x_;
};

}  // namespace sfdae::core
