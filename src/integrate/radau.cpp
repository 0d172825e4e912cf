// Steps of the Radau IIA methods.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

// Maximum of the first attempt relative to the interval: not a simple fraction, which might be a period of the data
// (docs/design/error_control.md). Its digits are taken from those of e.
constexpr double first_radau_step_fraction = 0.0718281828;
// Tolerances below which more than three stages are used from the start (docs/design/radau.md).
constexpr double tight = 1e-7, very_tight = 1e-9;
// Steps of one stage, used for rough problems, must not grow beyond the scale of the roughness. (Chosen.)
constexpr double rough_growth = 2.0;
// Relative rounding error of differences of times, with a margin.
constexpr double same_step = 1e-6;
// With three or more stages the last step's collocation polynomial is more accurate than one through distant nodes.
constexpr int least_collocation_order = 5;

StageCosts costs_of(const StrangenessFreeSystem& system) {
  StageCosts costs;
  for (int s = 1; s <= max_stages; ++s) costs.work[index(s)] = system.stage_cost(s);
  return costs;
}

}  // namespace

void Radau::set_options(const StepOptions& options) {
  const StepOptions before = options_;
  options_ = options;
  if (history_.count() > 0) {
    // All sizes depend on the numbers of stages at the start.
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
  return std::min(first_radau_step_fraction * span, weights.first_step(x, xdot, 0.5 / s));
}

void Radau::resize(const StrangenessFreeSystem& system) {
  const std::size_t n = index(system.unknowns()), size_w = index(system.leading_size());
  tried_.end.assign_zero(n, size_w);
  tried_.stages.resize(n, size_w, options_.max_stages);
  workspace_.table.resize(std::max(n, size_w), options_.max_stages + 1);
  workspace_.scales.resize(n);
  estimate_.resize(n, size_w, options_.max_stages);
  output_.resize(system, options_.max_stages);
}

void Radau::start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) {
  Radau started = *this;
  started.history_.resize(point.x.size(), point.w.size(), options_);
  started.resize(system);
  started.history_.start(point);
  started.control_.start(options_);
  started.control_.set_stages(std::clamp(first_stages_, options_.min_stages, options_.max_stages));
  started.next_step_ = h;
  *this = std::move(started);
}

StepState Radau::state() const {
  return {history_.newest().t,
          tried_.end.t,
          history_.last(),
          next_step_,
          2 * control_.stages() - 1,
          control_.failures_in_a_row(),
          output_.longest_interpolated(history_, control_.stages()),
          output_.interpolates_well(),
          terms_.error,
          history_.inner_count()};
}

// Without differential equations one stage suffices, because stages are independent.
int Radau::wanted_stages(const StrangenessFreeSystem& system) const {
  return system.differential() == 0 ? 1 : control_.stages();
}

// The collocation polynomial of the last step is more accurate there than one through more distant nodes: 3 and 20
// times with 5 and 7 stages and equal steps (measured). Its derivatives are less accurate if guesses need them.
// Otherwise the polynomial through nodes whose degree fits the method is used, or the tangent if there is only one
// node. Without differential equations slopes are those of steps of one stage, which are less accurate than values.
RadauPredictor Radau::predictor(const StrangenessFreeSystem& system) {
  HermiteTable& table = workspace_.table;
  const RadauNode& newest = history_.newest();
  const LastStep& last = history_.last();
  if (system.differential() == 0) {
    const int points = course_points();
    if (points < 2) return {history_, nullptr};
    table.set_values(history_.newest_nodes(points), newest.t, last.h);
    return {history_, &table};
  }
  if (system.guesses_values() && history_.count() >= 2 && last.order >= least_collocation_order &&
      std::fabs(newest.t - history_.node(1).t - last.h) <= same_step * std::fabs(last.h)) {
    table.set_collocation(history_);
    return {history_, &table};
  }
  const int count = std::min(history_.count(), (tried_.method->s() + 1) / 2);
  if (count < 2) return {history_, nullptr};
  table.set_nodes(history_.newest_nodes(count), Interpolated::x, 2 * count, newest.t, last.h);
  return {history_, &table};
}

Guess Radau::guess(const StrangenessFreeSystem& system, double t, ErrorWeights& weights) {
  if (system.is_linear()) return {};
  const RadauNode& start = history_.newest();
  // The iteration uses the tolerances at the last node, whatever was tried since.
  weights.update(start.x.data());
  Guess prediction =
      workspace_.guess.predict(predictor(system), tried_.method->stages, start.t, t, system.taylor_order());
  prediction.inverse_weights = weights.inverse();
  return prediction;
}

StepOutcome Radau::attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) {
  control_before_ = control_;
  const bool follows_course = !system.is_linear() && system.differential() == 0;
  if (control_.is_rough() && !follows_course) history_.forget_past();
  const RadauMethod& method = radau_method(wanted_stages(system));
  const RadauNode& start = history_.newest();
  tried_.method = &method;
  tried_.h = t - start.t;
  const StageEquations equations{method.stages,  start.t,        t,
                                 start.w.data(), start.x.data(), guess(system, t, weights)};
  RadauStages& stages = tried_.stages;
  const PointStatus status = system.solve_stages(equations, stages.x.data(), stages.w.data(), tried_.end.t);
  if (const auto failure = failed_outcome(status)) return *failure;
  if (!all_finite(stages.x.data(), start.x.size() * index(method.s()))) return StepOutcome::not_finite;
  stages.take_end(method, start, tried_.end);
  system.correct_slopes(tried_.end.wdot.data(), tried_.end.xdot.data());
  workspace_.scales.update(weights, start, tried_.end);
  const double deviation = follows_course ? course_of_tried(equations.guess.taylor, weights) : 0.0;
  if (deviation > 1.0 && control_.failures_in_a_row() < most_course_refusals) {
    next_step_ = control_.failed(tried_.h);
    return StepOutcome::error_too_large;
  }
  terms_ = test_error(system, weights);
  const StepOutcome outcome = judge(system, terms_);
  if (follows_course && outcome == StepOutcome::accepted)
    next_step_ = course_growth(deviation, course_points() - 1) * tried_.h;
  return outcome;
}

PointsOfCurve Radau::points_of_tried() const {
  const StageMethod& method = tried_.method->stages;
  const RadauNode& start = history_.newest();
  PointsOfCurve points;
  points.add(start.t, start.x.data());
  points.add(tried_.end.t, tried_.end.x.data());
  for (int i = 0; i + 1 < method.s; ++i)
    points.add(start.t + method.c[index(i)] * tried_.h, tried_.stages.x.data() + index(i) * start.x.size());
  return points;
}

double Radau::course_of_tried(const double* predicted, const ErrorWeights& weights) const {
  TriedCourse course{{}, course_points(), predicted, tried_.end.x};
  for (int i = 0; i < course.count; ++i) course.past[index(i)] = &history_.node(i).x;
  return course_deviation(course, weights);
}

StepOutcome Radau::judge(const StrangenessFreeSystem& system, const ErrorTerms& terms) {
  if (!(terms.error <= 1.0)) {
    next_step_ = control_.rejected(tried_.h, terms);
    return StepOutcome::error_too_large;
  }
  next_step_ = step_after_acceptance(system, terms);
  return StepOutcome::accepted;
}

// Repeats the decision about the attempt, as if x had these errors, too.
StepOutcome Radau::test_beside(const StrangenessFreeSystem& system, const ErrorTerms& terms) {
  control_ = control_before_;
  return judge(system, larger_of(terms_, terms));
}

ErrorTerms Radau::test_error(StrangenessFreeSystem& system, const ErrorWeights& weights) {
  ErrorTerms terms = estimate_.estimate(system, history_, tried_, weights, workspace_.table);
  if (system.differential() > 0 && control_.may_change_stages() && terms.error <= 1.0)
    estimate_.add_decay(system, history_, tried_, weights, terms);
  return terms;
}

double Radau::step_after_acceptance(const StrangenessFreeSystem& system, const ErrorTerms& terms) {
  const double h = tried_.h;
  if (system.differential() == 0) return control_.accepted_without_error(h);
  const double next = control_.accepted(h, terms, costs_of(system), system.is_constant());
  return tried_.method->s() > 1 ? next : std::copysign(std::min(std::fabs(next), rough_growth * std::fabs(h)), h);
}

bool Radau::gives_up_polynomial(ErrorWeights& weights, const double* interpolated, const double* x) {
  if (!output_.interpolates_well()) return false;
  workspace_.scales.update(weights, history_.node(1), history_.newest());
  return output_.gives_up_polynomial(history_, weights, interpolated, x);
}

void Radau::archive(Archive& archive, const StrangenessFreeSystem& system) {
  RadauHistory::Extent extent = history_.extent(options_);
  archive.small(extent.nodes, extent.order, extent.inner, first_stages_, options_.min_stages, options_.max_stages);
  if (archive.is_reading()) {
    const auto is_number = [](int s) { return s >= 1 && s <= max_stages && s % 2 == 1; };
    if (!is_number(options_.min_stages) || !is_number(options_.max_stages) ||
        options_.min_stages > options_.max_stages || !is_number(first_stages_))
      throw DamagedArchive();
    history_.set_extent(extent, system, options_);
    control_.set_options(options_);
    resize(system);
  }
  control_.archive(archive);
  archive.real(next_step_);
  const bool is_linear = system.is_linear();
  // Initial guesses extrapolate x.
  const bool with_x = options_.interpolates || !is_linear;
  const bool with_polynomial = (options_.interpolates || system.guesses_values()) && history_.last().order > 0;
  history_.archive(archive, extent, {with_x, with_polynomial, is_linear});
  if (archive.is_reading()) output_.note_step(history_);
}

}  // namespace sfdae::core
