// Radau IIA methods of orders 1, 5, 9 and 13 with variable step, for a strangeness-free system.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996, section IV.8.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/algebraic_course.h"
#include "integrate/radau_control.h"
#include "integrate/radau_error_estimate.h"
#include "integrate/radau_history.h"
#include "integrate/radau_output.h"
#include "integrate/radau_stages.h"
#include "integrate/stepper.h"

namespace sfdae::core {

class Radau final : public Stepper {
 public:
  Radau() : Stepper(Tightening::none) {}

  void set_options(const StepOptions& options) override;
  double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) override;
  void start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) override;
  StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) override;
  void commit() override {
    history_.append(tried_, estimate_.interior());
    output_.note_step(history_);
  }
  void withdraw() override { control_ = control_before_; }
  void reduce_after_failure(double h) override { next_step_ = control_.failed(h); }
  void set_next_step(double h) override { next_step_ = h; }
  StepOutcome test_beside(const StrangenessFreeSystem& system, const ErrorTerms& terms) override;

  StepState state() const override;
  PointsOfCurve points_of_tried() const override;
  TriedStep tried() const override {
    return {tried_.end.t,
            tried_.h,
            tried_.method->order(),
            tried_.stages.x.data(),
            0.0,
            nullptr,
            &tried_.method->stages,
            history_.newest().x.data(),
            control_before_.is_rough()};
  }
  const std::vector<double>& x() const override { return history_.newest().x; }
  const std::vector<double>& tried_x() const override { return tried_.end.x; }
  const std::vector<double>& error() const override { return estimate_.error(); }
  void interpolate(const PointValues& point) override { output_.interpolate(history_, workspace_.table, point); }
  bool interpolates_x(ErrorWeights&) override { return output_.interpolates_x(history_); }
  std::optional<double> point_of_test() const override { return output_.point_of_test(history_); }
  bool gives_up_polynomial(ErrorWeights& weights, const double* interpolated, const double* x) override;
  Guess guess_within(double t, int order) override { return output_.guess_within(history_, t, order); }
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point) override {
    return output_.refine(system, weights, point, history_, workspace_);
  }
  void archive(Archive& archive, const StrangenessFreeSystem& system) override;

 private:
  void resize(const StrangenessFreeSystem& system);
  int wanted_stages(const StrangenessFreeSystem& system) const;
  RadauPredictor predictor(const StrangenessFreeSystem& system);
  Guess guess(const StrangenessFreeSystem& system, double t, ErrorWeights& weights);
  ErrorTerms test_error(StrangenessFreeSystem& system, const ErrorWeights& weights);
  StepOutcome judge(const StrangenessFreeSystem& system, const ErrorTerms& terms);
  // Number of points used for extrapolation of x if there are no differential equations.
  int course_points() const { return std::min({history_.count(), options_.max_stages, max_course_points}); }
  double course_of_tried(const double* predicted, const ErrorWeights& weights) const;
  double step_after_acceptance(const StrangenessFreeSystem& system, const ErrorTerms& terms);

  StepOptions options_;
  int first_stages_ = 3;
  RadauHistory history_;
  RadauStep tried_;
  RadauWorkspace workspace_;
  RadauErrorEstimate estimate_;
  ErrorTerms terms_;  // of the step tried last
  RadauOutput output_;
  RadauControl control_, control_before_;
  double next_step_ = 0.0;
};

}  // namespace sfdae::core
