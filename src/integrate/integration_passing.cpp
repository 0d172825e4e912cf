// Singular points in the driver of the integration: classification, and passage across them
// (docs/design/events_and_switching.md).
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "integrate/integration.h"
#include "integrate/integration_results.h"
#include "integrate/jump_rule.h"
#include "integrate/kinks.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Step size near a singular point, relative to the step that met it first.
constexpr double fine_part = 0.125;
// Distances after the point, relative to the width of the fit, at which a continuation is tried, in this order.
constexpr double parts_after[] = {0.125, 0.25, 0.0625, 0.5};
// Deviations allowed between consistent values and the continuation, and between their derivatives times its width, in
// units of the tolerance plus the expected error.
constexpr double near = 10.0, near_in_slope = 100.0;
// Larger expected errors, in tolerances, do not allow a prediction.
constexpr double unpredictable = 100.0;
// Additional points stored within steps of Radau, because its steps are long.
constexpr int points_within = 5;

// Components that are not smooth get the values at the same distance on the other side of the point.
std::vector<double> guess_at(const CourseData& data, const SmoothCourse& course, double t) {
  const Trail::Node* nearest = &data.trail.newest();
  const double mirrored = 2.0 * data.t - t;
  for (std::size_t k = 0; k < data.trail.count(); ++k)
    if (std::fabs(data.trail.node(k).t - mirrored) < std::fabs(nearest->t - mirrored)) nearest = &data.trail.node(k);
  std::vector<double> x(nearest->x.begin(), nearest->x.end());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (course.degrees[i] >= 0) x[i] = course.fit.evaluate(i, course.degrees[i], t).x;
  return x;
}

// The reason why the point contradicts the smooth continuation; empty if it does not.
std::string contradiction_of(const CourseData& data, const SmoothCourse& course, const ConsistentPoint& point) {
  for (std::size_t i = 0; i < point.x.size(); ++i) {
    if (course.degrees[i] < 0) continue;
    const CourseFit::Accuracy accuracy = course.fit.accuracy(i, point.t);
    if (!(accuracy.error <= unpredictable * data.tolerances[i])) {
      if (data.is_differentiated[i] == 0) continue;
      return format("at t = %.12g x[%d] can be extrapolated to %.2g tolerances only", point.t, static_cast<int>(i),
                    accuracy.error / data.tolerances[i]);
    }
    const CourseFit::Value value = course.fit.evaluate(i, accuracy.degree, point.t);
    const double allowed = data.tolerances[i] + accuracy.error, off = std::fabs(point.x[i] - value.x);
    if (!(off <= near * allowed))
      return format("at t = %.12g the constraints move x[%d] by %.2g tolerances from the smooth continuation",
                    point.t, static_cast<int>(i), off / data.tolerances[i]);
    if (data.is_differentiated[i] == 0) continue;
    const double turned = std::fabs(point.xdot[i] - value.xdot);
    if (!(turned * course.width <= near_in_slope * allowed))
      return format("at t = %.12g the equations give x'[%d] = %.6g, the smooth continuation has %.6g", point.t,
                    static_cast<int>(i), point.xdot[i], value.xdot);
  }
  return {};
}

}  // namespace

void Passage::evaluate(double t, double* x, double* xdot) const {
  const double length = after_.t - before_.t, part = (t - before_.t) / length;
  for (std::size_t i = 0; i < before_.x.size(); ++i) {
    const int degree = course_.degrees[i];
    const auto at = [&](double time) {
      return degree < 0 ? CourseFit::Value{0.0, 0.0} : course_.fit.evaluate(i, degree, time);
    };
    const double off_before = before_.x[i] - at(before_.t).x, off_after = after_.x[i] - at(after_.t).x;
    const CourseFit::Value value = at(t);
    x[i] = value.x + (1.0 - part) * off_before + part * off_after;
    if (xdot != nullptr) xdot[i] = value.xdot + (off_after - off_before) / length;
  }
}

// ---- Approach to the point -------------------------------------------------------------------------------------

// Not stored if singular points cannot be found: this saves memory.
void Integration::start_trail() {
  branches_.fine.reset();
  if (watch_ && !watch_->may_find()) return;
  const std::vector<double>& x = integrator_.stepper->x();
  branches_.trail.start(integrator_.stepper->state().t, x.data(), x.size());
}

// Adds the points of a step that started at `from`.
void Integration::extend_trail(double from) {
  Trail& trail = branches_.trail;
  if (watch_ && !watch_->may_find()) return;
  const double t = integrator_.stepper->state().t;
  if (passes_singular_points() && integrator_.method == Method::radau) {
    std::vector<double> x(integrator_.stepper->x().size());
    for (int k = 1; k <= points_within; ++k) {
      const double at = from + (t - from) * k / (points_within + 1);
      try {
        output_.evaluate_aside(integrator_, {at, true, Slopes::none, false}, options_, x.data(), nullptr);
        trail.add(at, x.data());
      } catch (const Failure& failure) {
        if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
      }
    }
  }
  trail.add(t, integrator_.stepper->x().data());
}

bool Integration::passes_singular_points() const {
  return options_.continuation != nullptr && branches_.passed < options_.max_passed && !companion_ &&
         options_.events == nullptr;
}

// A step of size h from the last point may have met a singular point.
void Integration::refine_steps(double h) {
  if (!passes_singular_points() || branches_.fine) return;
  branches_.fine = Branches::FineSteps{integrator_.stepper->state().t + h, fine_part * std::fabs(h)};
}

// Limit of the next step near a suspected singular point.
double Integration::fine_step(double size) {
  if (!branches_.fine) return size;
  if (integrator_.has_passed(branches_.fine->until)) {
    branches_.fine.reset();
    return size;
  }
  return std::min(size, branches_.fine->step);
}

// ---- At the point ----------------------------------------------------------------------------------------------

CourseData Integration::course_data() {
  const std::vector<double>& x = integrator_.stepper->x();
  CourseData data{branches_.trail, change_->t, integrator_.direction, std::vector<double>(x.size()),
                  std::vector<char>(x.size(), 0)};
  for (std::size_t i = 0; i < x.size(); ++i) {
    data.tolerances[i] = integrator_.weights.tolerance(static_cast<int>(i), x.data());
    if (!(data.tolerances[i] > 0.0)) data.tolerances[i] = unit_roundoff * std::max(std::fabs(x[i]), 1.0);
  }
  // If too few are known, as at points where E loses rank, all components must be smooth.
  std::vector<char>& flags = data.is_differentiated;
  const bool is_known = integrator_.system.find_differentiated(flags.data());
  const auto found = std::count(flags.begin(), flags.end(), char{1});
  if (!is_known || found == 0 || found < integrator_.system.differential())
    std::fill(flags.begin(), flags.end(), char{1});
  return data;
}

// Empty if the point has been passed.
std::optional<CallResult> Integration::meet_change() {
  const CourseData data = course_data();
  const std::optional<SmoothCourse> course = smooth_course(data);
  SingularPoint point;
  point.t = change_->t;
  point.part = change_->part != SingularPart::unknown ? change_->part : integrator_.system.vanishing_part();
  point.t_before = point.t_after = integrator_.stepper->state().t;
  classify(data, course, point);
  branches_.refusal.clear();
  if (passes_singular_points()) {
    if (point.kind == SingularKind::crossing && course && pass(data, *course, point)) return std::nullopt;
    if (branches_.refusal.empty()) branches_.refusal = "the solution is not smooth there, as far as can be told";
  }
  branches_.point = point;
  CallResult result = result_of_change(integrator_.system, *change_);
  if (!integrator_.system.is_linear()) result.message += description(point);
  if (!branches_.refusal.empty()) result.message += " It was not passed: " + branches_.refusal + ".";
  return result;
}

// Steps from the last point fail for unknown reasons: if a smooth continuation is confirmed, it was a singular point.
bool Integration::has_passed_obstacle() {
  if (!passes_singular_points()) return false;
  const std::optional<SingularPoint> before = branches_.point;
  const double t = integrator_.stepper->state().t;
  change_ = LocatedChange{t, t, {}, 0.0, SingularPart::unknown};
  if (!meet_change()) return true;
  change_.reset();
  branches_.point = before;
  return false;
}

bool Integration::pass(const CourseData& data, const SmoothCourse& course, SingularPoint& point) {
  const double direction = integrator_.direction, t_last = integrator_.stepper->state().t;
  const auto go_to = [&](double t) {
    const double toward = t + direction * course.width;
    if (!((t - t_last) * direction >= 0.0)) return false;
    const std::optional<double> kink = next_kink(options_, {t_last, t, direction}, std::fabs(t - t_last));
    if ((options_.stop_time && (*options_.stop_time - t) * direction < 0.0) ||
        (kink && (*kink - t) * direction < 0.0)) {
      branches_.refusal = "stop_time or a breakpoint is too near";
      return false;
    }
    // If the point was found late, the step provides the values.
    const std::vector<double> guess = t == t_last ? integrator_.stepper->x() : guess_at(data, course, t);
    try {
      const ConsistentPoint found = options_.continuation->look_at({t, toward, guess.data()});
      branches_.refusal = contradiction_of(data, course, found);
    } catch (const Failure& failure) {
      if (failure.status() == SFDAE_STOPPED || failure.status() == SFDAE_CALLBACK_STOPPED) throw;
      branches_.refusal = format("at t = %.12g: ", t) + failure.what();
      while (!branches_.refusal.empty() && branches_.refusal.back() == '.') branches_.refusal.pop_back();
    }
    if (!branches_.refusal.empty()) return false;
    go_on_from(options_.continuation->move_to({t, toward, guess.data()}), course, point);
    return true;
  };
  if (std::any_of(std::begin(parts_after), std::end(parts_after),
                  [&](double part) { return go_to(data.t + direction * part * course.width); }))
    return true;
  // A step has led far beyond a point that was found late.
  return (t_last - data.t) * direction > 0.0 && go_to(t_last);
}

void Integration::go_on_from(const ConsistentPoint& after, const SmoothCourse& course, SingularPoint& point) {
  Stepper& stepper = *integrator_.stepper;
  const double direction = integrator_.direction;
  Passage passage(course, {stepper.state().t, stepper.x()}, {after.t, after.x});
  resize_workspace();
  integrator_.start(after.t, after.x, after.xdot, options_);
  integrator_.must_restart = false;
  approach_.reset();
  change_.reset();
  if (watch_) watch_->start(direction);
  point.t_after = after.t;
  point.is_passed = true;
  branches_.point = point;
  branches_.passage.emplace(std::move(passage));
  ++branches_.passed;
  start_trail();
  record_passage(after.t);
}

void Integration::record_passage(double t_after) {
  const std::shared_ptr<SolutionPieces> solution = recording_.solution.lock();
  if (!solution || !recording_.is_on) return;
  const auto sample = [&](double t, double* x) {
    branches_.passage->evaluate(t, x, nullptr);
    return true;
  };
  add_piece(*solution, {solution->end(), t_after, true, sample, {}});
}

}  // namespace sfdae::core
