// Radau IIA methods of orders 1, 5, 9 and 13 with variable step, for a strangeness-free system.
//
// Error estimate: the divided difference of order 2s of w over the last nodes, with their slopes, times the error
// constant; it is guarded by the embedded formula of order s, gamma0 h (w' - u') at the start of the step with u the
// collocation polynomial, whose error is compared with tol^((s+1)/(2s)) [HW99]. Both are mapped to x.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996, section IV.8.
// [HW99] E. Hairer, G. Wanner: Stiff differential equations solved by Radau methods. J. Comput. Appl. Math. 111 (1999).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "integrate/radau_control.h"
#include "integrate/radau_method.h"
#include "integrate/stepper.h"

namespace sfdae::core {

class Radau final : public Stepper {
 public:
  void set_options(const StepOptions& options) override;
  double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) override;
  Tightening tightening() const override { return Tightening::none; }
  void start(StrangenessFreeSystem& system, const StartingPoint& point, double h) override;
  StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) override;
  void commit() override;
  void withdraw() override { control_ = control_before_; }
  void reduce_after_failure(double h) override { next_step_ = control_.failed(h); }

  double t() const override { return nodes_[0].t; }
  const std::vector<double>& x() const override { return nodes_[0].x; }
  double tried_t() const override { return tried_.t; }
  double next_step() const override { return next_step_; }
  void set_next_step(double h) override { next_step_ = h; }
  double last_step() const override { return last_step_; }
  int order() const override { return last_order_; }
  int next_order() const override { return 2 * control_.stages() - 1; }
  int failures_in_a_row() const override { return control_.failures_in_a_row(); }
  double leading_coefficient() const override { return leading_coefficient_; }
  const std::vector<double>& error() const override { return error_; }

  // Hermite polynomials through the last nodes.
  void interpolate(double t, double* w, double* x, double* xdot) override;
  // Where they are not accurate enough, the stages of a step to t are solved instead.
  bool interpolates_well() const override { return count_ > control_.stages(); }
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, double t, double* w, double* x,
                     double* xdot) override;
  int refined_points() const override { return inner_count_; }
  void archive(Archive& archive, const StrangenessFreeSystem& system) override;

 private:
  struct Node {
    double t = 0.0;
    std::vector<double> w, wdot, x, xdot;
  };
  // Nodes kept, the newest first: enough for divided differences of order 2s that include a new one.
  static constexpr int capacity = max_stages + 1;
  // Points within the last step that had to be computed as steps would be, nodes for its polynomial from then on.
  static constexpr int inner_capacity = 6;
  // Distances of nodes relative to the one before.
  static constexpr double coincidence = 0.02;
  static constexpr int table_size = 2 * capacity + 2;

  void resize(std::size_t n, std::size_t size_w);
  int polynomial_of_nodes(const RadauMethod& method);
  int collocation_polynomial();
  int polynomial_of_prediction(const StrangenessFreeSystem& system, const RadauMethod& method);
  // Predicted stages of a step from start to t, for systems that ask for them.
  Guess guess(const StrangenessFreeSystem& system, const RadauMethod& method, const Node& start, double t,
              int degree);
  PointStatus solve_within(StrangenessFreeSystem& system, ErrorWeights& weights, double t);
  int wanted_stages(const StrangenessFreeSystem& system) const;
  void update(ErrorWeights& weights, const Node& start, const Node& end);
  void take_last_stage(const RadauMethod& method, const Node& start, Node& node) const;
  ErrorTerms estimate_errors(StrangenessFreeSystem& system, const ErrorWeights& weights, const RadauMethod& method);
  void decay_of_differences(StrangenessFreeSystem& system, const ErrorWeights& weights, const RadauMethod& method,
                            ErrorTerms& terms);
  // The divided difference of the given order over the new node and the last ones, in units of h: last in the table.
  void hermite_difference(int order);
  // Both ends of the step and the nodes nearest to t; returns how many.
  int choose_nodes(double t);
  void hermite_polynomial(const std::vector<double> Node::*values, const std::vector<double> Node::*slopes,
                          int count);
  void evaluate_hermite(int count, double t, std::size_t size, double* value, double* slope) const;
  void archive(Archive& archive, Node& node, bool with_x);

  StepOptions options_;
  int first_stages_ = 3;
  std::array<Node, capacity> nodes_;
  int count_ = 0;
  std::array<Node, inner_capacity> inner_;
  int inner_count_ = 0;
  Node tried_;
  Node within_, within_from_;  // of steps that outputs cause

  RadauControl control_, control_before_;
  double next_step_ = 0.0, last_step_ = 0.0;
  int last_order_ = 0;
  double tried_h_ = 0.0;
  int tried_stages_ = 3;
  double leading_coefficient_ = std::numeric_limits<double>::infinity();
  // Stages: n x s and leading_size() x s.
  std::vector<double> stage_x_, stage_w_;
  std::vector<double> last_stages_;  // x of the last step
  std::vector<double> error_, largest_x_, scale_x_, columns_, mapped_;
  std::array<std::vector<double>, table_size> table_;  // divided differences
  std::array<double, table_size> table_times_{};
  std::array<const Node*, capacity> chosen_{};
  std::vector<double> guess_, guess_before_, guess_start_;
};

}  // namespace sfdae::core
