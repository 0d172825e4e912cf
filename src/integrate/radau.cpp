// Radau IIA methods with variable step and order.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau.h"

#include <algorithm>
#include <cmath>

#include "integrate/newton_polynomial.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// The first attempt in units of the interval, at most: no simple fraction, which might be a period of the data.
constexpr double first_step_fraction = 0.0718281828;
// Tolerances that call for more than three stages from the start.
constexpr double tight = 1e-7, very_tight = 1e-9;
// The embedded error may be this large in units of tol^((s+1)/(2s)). Measured on 287 runs of three families with s = 3
// alone and with all s: errors of a tenth of the tolerance in the mean, up to 7 where the coefficients turn fast.
// More stages need less, as their order at the nodes relies on smooth coefficients, of which the divided difference of w
// tells nothing.
constexpr double embedded_limit(int s, bool beside_difference) {
  return s == 3 ? (beside_difference ? 0.4 : 0.08) : s == 5 ? 0.012 : 0.003;
}
// Steps of one stage, the choice for rough problems, must not grow over what makes them rough.
constexpr double rough_growth = 2.0;

StageCosts costs_of(const StrangenessFreeSystem& system) {
  if (system.stage_cost(1) <= 0.0)
    return costs_of_reductions(system.unknowns(), system.differential() + system.undetermined());
  StageCosts costs;
  for (int s = 1; s <= max_stages; ++s) costs.work[index(s)] = system.stage_cost(s);
  return costs;
}

}  // namespace

void Radau::set_options(const StepOptions& options) {
  const StepOptions before = options_;
  options_ = options;
  if (count_ > 0) {
    // Everything has been sized for the numbers of stages of the start.
    options_.min_stages = before.min_stages;
    options_.max_stages = before.max_stages;
    options_.interpolates = before.interpolates;
  }
  control_.set_options(options_);
}

// Sized for the embedded estimate, h^(s+1) ~ tol^((s+1)/(2s)), which is measured then.
double Radau::first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) {
  const double tol = weights.tightest(x);
  first_stages_ = tol > tight ? 3 : tol > very_tight ? 5 : 7;
  const int s = std::clamp(first_stages_, options_.min_stages, options_.max_stages);
  return std::min(first_step_fraction * span, weights.first_step(x, xdot, 0.5 / s));
}

void Radau::resize(std::size_t n, std::size_t size_w) {
  const auto resize_node = [&](Node& node) {
    for (Vector* v : {&node.w, &node.wdot}) v->assign(size_w, 0.0);
    for (Vector* v : {&node.x, &node.xdot}) v->assign(n, 0.0);
  };
  for (int i = 0; i <= options_.max_stages; ++i) resize_node(nodes_[index(i)]);
  if (options_.interpolates)
    for (Node& node : inner_) resize_node(node);
  for (Node* node : {&within_, &within_from_}) resize_node(*node);
  resize_node(tried_);
  const std::size_t stages = index(options_.max_stages);
  for (Vector* v : {&error_, &largest_x_, &scale_x_}) v->assign(n, 0.0);
  stage_x_.assign(n * stages, 0.0);
  last_stages_.assign(n * stages, 0.0);
  stage_w_.assign(size_w * stages, 0.0);
  columns_.assign(size_w * (stages + 2), 0.0);
  mapped_.assign(n * (stages + 2), 0.0);
  for (int i = 0; i < 2 * (options_.max_stages + 1); ++i) table_[index(i)].resize(std::max(n, size_w));
}

void Radau::start(StrangenessFreeSystem&, const StartingPoint& point, double h) {
  resize(point.x.size(), point.w.size());
  nodes_[0] = {point.t, point.w, point.wdot, point.x, point.xdot};
  count_ = 1;
  inner_count_ = 0;
  control_.start(options_);
  control_.set_stages(std::clamp(first_stages_, options_.min_stages, options_.max_stages));
  next_step_ = h;
  last_step_ = 0.0;
  last_order_ = 0;
  leading_coefficient_ = std::numeric_limits<double>::infinity();
}

// Without differential equations the stages do not depend on each other.
int Radau::wanted_stages(const StrangenessFreeSystem& system) const {
  return system.differential() == 0 ? 1 : control_.stages();
}

namespace {

// slope := sum_j weights[j stride] (values_j - start) / h, values_j the columns of `values`.
void slope_of_stages(int s, const double* weights, int stride, const Vector& start, const Vector& values, double h,
                     double* slope) {
  const std::size_t size = start.size();
  std::fill_n(slope, size, 0.0);
  for (int j = 0; j < s; ++j) {
    const double weight = weights[j * stride] / h;
    const double* column = values.data() + size * index(j);
    for (std::size_t r = 0; r < size; ++r) slope[r] += weight * (column[r] - start[r]);
  }
}

}  // namespace

// For x, of a degree that fits the method; returns it, 0 if there are too few nodes.
int Radau::polynomial_of_nodes(const RadauMethod& method) {
  const int count = std::min(count_, (method.s() + 1) / 2);
  if (count < 2) return 0;
  for (int i = 0; i < count; ++i) chosen_[index(i)] = &nodes_[index(i)];
  hermite_polynomial(&Node::x, &Node::xdot, count);
  return 2 * count - 1;
}

// The collocation polynomial of the last step errs less there than one through nodes farther away: 3 and 20 times with
// 5 and 7 stages and equal steps. Its derivatives are worse, where guesses need them.
int Radau::polynomial_of_prediction(const StrangenessFreeSystem& system, const RadauMethod& method) {
  constexpr int least_order = 5;
  constexpr double same = 1e-6;
  const bool has_collocation = system.guesses_values() && count_ >= 2 && last_order_ >= least_order &&
                               std::fabs(nodes_[0].t - nodes_[1].t - last_step_) <= same * std::fabs(last_step_);
  return has_collocation ? collocation_polynomial() : polynomial_of_nodes(method);
}

// By the polynomial in the table of the given degree; degree 0: by the tangent.
Guess Radau::guess(const StrangenessFreeSystem& system, const RadauMethod& method, const Node& start, double t,
                   int degree) {
  const int order = system.taylor_order(), s = method.s();
  const std::size_t n = start.x.size(), block = n * index(order + 1);
  if (guess_.size() < block * index(s)) guess_.resize(block * index(s));
  for (Vector* v : {&guess_before_, &guess_start_})
    if (v->size() < block) v->resize(block);
  const auto evaluate = [&](double at, double* to) {
    if (degree == 0) {
      std::fill_n(to, block, 0.0);
      for (std::size_t r = 0; r < n; ++r) to[r] = nodes_[0].x[r] + (at - nodes_[0].t) * nodes_[0].xdot[r];
      if (order > 0) std::copy_n(nodes_[0].xdot.data(), n, to + n);
      return;
    }
    newton_taylor(table_, table_times_, degree, (at - nodes_[0].t) / last_step_, order, n, to);
    double power = 1.0;
    for (int k = 1; k <= order; ++k) {
      power *= last_step_;
      for (std::size_t r = 0; r < n; ++r) to[n * index(k) + r] /= power;
    }
  };
  for (int i = 0; i < s; ++i)
    evaluate(i == s - 1 ? t : start.t + method.stages.c[index(i)] * (t - start.t), guess_.data() + block * index(i));
  evaluate(nodes_[0].t, guess_before_.data());
  if (count_ >= 2) evaluate(nodes_[1].t, guess_start_.data());
  Guess result;
  result.taylor = guess_.data();
  result.taylor_before = guess_before_.data();
  return result;
}

StepOutcome Radau::attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) {
  control_before_ = control_;
  if (control_.is_rough()) count_ = 1;
  const RadauMethod& method = radau_method(wanted_stages(system));
  const Node& last = nodes_[0];
  const int s = method.s();
  tried_h_ = t - last.t;
  tried_stages_ = s;
  Guess prediction;
  if (!system.is_linear()) {
    // Iterations are judged by the tolerances at the last node, whatever was tried since.
    weights.update(last.x.data());
    prediction = guess(system, method, last, t, polynomial_of_prediction(system, method));
    prediction.inverse_weights = weights.inverse();
  }
  const StageEquations equations{method.stages, last.t, t, last.w.data(), last.x.data(), prediction};
  const PointStatus status = system.solve_stages(equations, stage_x_.data(), stage_w_.data(), tried_.t);
  if (const auto failure = failed_outcome(status)) return *failure;
  const std::size_t n = last.x.size();
  if (!all_finite(stage_x_.data(), n * index(s))) return StepOutcome::not_finite;
  take_last_stage(method, last, tried_);
  system.correct_slopes(tried_.wdot.data(), tried_.xdot.data());
  update(weights, last, tried_);
  const ErrorTerms terms = estimate_errors(system, weights, method);
  if (!(terms.error <= 1.0)) {
    next_step_ = control_.rejected(tried_h_, terms);
    return StepOutcome::error_too_large;
  }
  const StageCosts costs = costs_of(system);
  next_step_ = system.differential() == 0 ? control_.accepted_without_error(tried_h_)
                                          : control_.accepted(tried_h_, terms, costs, system.is_constant());
  if (s == 1 && system.differential() > 0)
    next_step_ = std::copysign(std::min(std::fabs(next_step_), rough_growth * std::fabs(tried_h_)), tried_h_);
  return StepOutcome::accepted;
}

// Tolerances for what is larger at either end of a step. Where a component runs through zero, its size nearby is what it
// changes by.
void Radau::update(ErrorWeights& weights, const Node& start, const Node& end) {
  const double h = end.t - start.t;
  for (std::size_t i = 0; i < end.x.size(); ++i) {
    largest_x_[i] = std::max(std::fabs(start.x[i]), std::fabs(end.x[i]));
    scale_x_[i] = std::max({largest_x_[i], std::fabs(h * start.xdot[i]), std::fabs(h * end.xdot[i])});
  }
  weights.update(largest_x_.data(), scale_x_.data());
}

// The last stage of a step from `start` as a node; its time is set.
void Radau::take_last_stage(const RadauMethod& method, const Node& start, Node& node) const {
  const int s = method.s();
  const std::size_t n = start.x.size(), size_w = start.w.size();
  std::copy_n(stage_x_.data() + n * index(s - 1), n, node.x.data());
  std::copy_n(stage_w_.data() + size_w * index(s - 1), size_w, node.w.data());
  const double* last_row = method.stages.D.data() + (s - 1);
  slope_of_stages(s, last_row, s, start.w, stage_w_, node.t - start.t, node.wdot.data());
  slope_of_stages(s, last_row, s, start.x, stage_x_, node.t - start.t, node.xdot.data());
}

ErrorTerms Radau::estimate_errors(StrangenessFreeSystem& system, const ErrorWeights& weights,
                                  const RadauMethod& method) {
  ErrorTerms terms;
  if (system.differential() == 0) {
    std::fill(error_.begin(), error_.end(), 0.0);
    return terms;
  }
  const int s = method.s();
  const std::size_t n = nodes_[0].x.size(), size_w = nodes_[0].w.size();
  // The embedded formula: gamma0 h (w' - u') at the start.
  double* embedded = columns_.data();
  slope_of_stages(s, method.slope_at_start.data(), 1, nodes_[0].w, stage_w_, tried_h_, embedded);
  const double factor = tried_h_ / method.stages.gamma;
  for (std::size_t i = 0; i < size_w; ++i) embedded[i] = factor * (nodes_[0].wdot[i] - embedded[i]);
  const bool has_difference = count_ >= s && s > 1;
  if (has_difference) {
    hermite_difference(2 * s);
    std::copy_n(table_[index(2 * s)].data(), size_w, columns_.data() + size_w);
  }
  system.error_in_x(columns_.data(), has_difference ? 2 : 1, mapped_.data());
  const double* difference = mapped_.data() + n;
  std::copy_n(mapped_.data(), n, error_.data());
  if (s == 1) {
    // h (w' - u') = - h^2 w'' up to higher orders.
    terms.decay[2] = 0.5 * weights.norm(mapped_.data());
    terms.error = method.error_constant * terms.decay[2];
    terms.exponent = 2;
  } else {
    const double guard = weights.norm(mapped_.data(), (s + 1.0) / (2.0 * s)) / embedded_limit(s, has_difference);
    if (has_difference) terms.decay[index(2 * s)] = weights.norm(difference);
    const double by_difference = has_difference ? method.error_constant * terms.decay[index(2 * s)] : 0.0;
    terms.error = std::max(guard, by_difference);
    terms.exponent = guard > by_difference ? s + 1 : 2 * s;
    if (terms.exponent == 2 * s) std::copy_n(difference, n, error_.data());
  }
  if (control_.may_change_stages() && terms.error <= 1.0) decay_of_differences(system, weights, method, terms);
  return terms;
}

// Divided differences of orders 1 ... s over the start and the stages, in units of h.
void Radau::decay_of_differences(StrangenessFreeSystem& system, const ErrorWeights& weights,
                                 const RadauMethod& method, ErrorTerms& terms) {
  const int s = method.s();
  const std::size_t n = nodes_[0].x.size(), size_w = nodes_[0].w.size();
  const auto node = [&](int i) { return i == 0 ? 0.0 : method.stages.c[index(i - 1)]; };
  // Column i: over the nodes i - k, ..., i; in the end column k has order k.
  std::copy_n(nodes_[0].w.data(), size_w, columns_.data());
  std::copy_n(stage_w_.data(), size_w * index(s), columns_.data() + size_w);
  for (int k = 1; k <= s; ++k)
    for (int i = s; i >= k; --i) {
      double* to = columns_.data() + size_w * index(i);
      const double* earlier = to - size_w;
      const double per_gap = 1.0 / (node(i) - node(i - k));
      for (std::size_t r = 0; r < size_w; ++r) to[r] = (to[r] - earlier[r]) * per_gap;
    }
  system.error_in_x(columns_.data() + size_w, s, mapped_.data());
  for (int k = 1; k <= s; ++k) terms.decay[index(k)] = weights.norm(mapped_.data() + n * index(k - 1));
}

void Radau::hermite_difference(int order) {
  // Times in units of the step, so that nothing overflows.
  const std::size_t size = tried_.w.size();
  for (int i = 0; i <= order; ++i) {
    const Node& node = i < 2 ? tried_ : nodes_[index(i / 2 - 1)];
    const bool is_slope = i % 2 == 1;
    table_times_[index(i)] = (node.t - tried_.t) / tried_h_;
    const double unit = is_slope ? tried_h_ : 1.0;
    const double* from = (is_slope ? node.wdot : node.w).data();
    for (std::size_t r = 0; r < size; ++r) table_[index(i)][r] = unit * from[r];
  }
  divided_differences(table_, table_times_, order + 1, size);
}

void Radau::commit() {
  count_ = std::min(count_ + 1, options_.max_stages + 1);
  std::rotate(nodes_.begin(), nodes_.begin() + count_ - 1, nodes_.begin() + count_);
  std::swap(nodes_[0], tried_);
  // Divided differences over points that nearly coincide would be rounding errors.
  if (count_ >= 3 && std::fabs(nodes_[0].t - nodes_[1].t) < coincidence * std::fabs(nodes_[1].t - nodes_[2].t)) {
    std::rotate(nodes_.begin() + 1, nodes_.begin() + 2, nodes_.begin() + count_);
    --count_;
  }
  inner_count_ = 0;
  std::swap(stage_x_, last_stages_);
  last_step_ = tried_h_;
  last_order_ = 2 * tried_stages_ - 1;
  leading_coefficient_ = radau_method(tried_stages_).stages.gamma / tried_h_;
}

}  // namespace sfdae::core
