// Events in the driver: the user's functions along the last step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/integration_events.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "integrate/integration.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Relative changes of x, x' and t that rounding errors may amount to.
constexpr double rounding_unit = 8.0 * unit_roundoff;
// Rough values of g are trusted where they are larger than their error by this factor: it is measured at one point.
constexpr double clearly_wrong = 8.0;
// Zeros this near to the start, in units of the rounding errors of times, are zeros at the start.
constexpr double start_width = 100.0;

// Writes g, filled with zeros before; returns what the callback does.
int call(const Events& events, double t, const Events::Point& point, std::vector<double>& g) {
  std::fill(g.begin(), g.end(), 0.0);
  return events.function(t, point.x.data(), point.xdot.data(), g.data(), events.user);
}

// Rounding errors as they might be, the same in every run.
class RandomSigns {
 public:
  double changed(double value) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX generator
    return value * (1.0 + (state_ >> 63 != 0 ? rounding_unit : -rounding_unit));
  }

 private:
  std::uint64_t state_ = 1;
};

Failure failure_of(int status, double t, const std::vector<double>& g) {
  if (status < 0)
    return Failure(SFDAE_CALLBACK_STOPPED, format("the event function returned %d at t = %.15g.", status, t));
  if (status > 0)
    return Failure(
        SFDAE_CALLBACK_FAILED,
        format("the event function returned %d at t = %.15g: it must be defined on the solution.", status, t));
  const auto bad = std::find_if(g.begin(), g.end(), [](double value) { return !std::isfinite(value); });
  return Failure(SFDAE_NOT_FINITE, format("g[%d] of the event function is %g at t = %.15g.",
                                          static_cast<int>(bad - g.begin()), *bad, t));
}

}  // namespace

void Events::resize(std::size_t n) {
  for (Point* point : {&searched, &candidate, &now, &rough}) {
    point->x.resize(n);
    point->xdot.resize(n);
  }
  for (std::vector<double>* g : {&g_now, &g_rough, &rough_error}) g->resize(index(search.count()));
}

void forget_search(Events& events) { events.search.reset(); }

void throw_events_differ(bool are_set) {
  throw Failure(SFDAE_ILLEGAL_ARGUMENT, are_set
                                            ? "the checkpoint is one of an integration without events: remove them, "
                                              "restore, and set them again."
                                            : "the checkpoint is one of an integration with events: call "
                                              "sfdae_set_events first.");
}

class Integration::StepValues final : public EventValues {
 public:
  explicit StepValues(Integration& integration) : integration_(integration), events_(*integration.options_.events) {}

  bool approximate(double t, double* g) override {
    // Without differential equations steps go anywhere at once, and a polynomial says nothing.
    if (integration_.system_.differential() == 0) return false;
    Events::Point& rough = events_.rough;
    integration_.stepper_->interpolate({t, integration_.scratch_w_.data(), rough.x.data(), rough.xdot.data()});
    if (!all_finite(rough.x.data(), rough.x.size()) || !all_finite(rough.xdot.data(), rough.xdot.size()))
      return false;
    const int status = call(events_, t, rough, events_.g_rough);
    stop_if_asked(t);
    // What violates the constraints a little may be where g is not defined.
    if (status != 0 || !all_finite(events_.g_rough.data(), events_.g_rough.size())) return false;
    for (std::size_t i = 0; i < events_.g_rough.size(); ++i)
      if (std::fabs(events_.g_rough[i]) < clearly_wrong * events_.rough_error[i]) return false;
    std::copy(events_.g_rough.begin(), events_.g_rough.end(), g);
    return true;
  }

  // Steps are as long as w = W x allows; algebraic components may vary faster, and their polynomials show nothing then.
  void measure_rough_error(double t) {
    std::vector<double>& error = events_.rough_error;
    std::fill(error.begin(), error.end(), 0.0);
    if (!approximate(t, error.data())) return;
    integration_.want_exact_slopes(false);
    integration_.evaluate(t, false, events_.now.x.data(), events_.now.xdot.data());
    integration_.want_exact_slopes(true);
    const bool is_known =
        call(events_, t, events_.now, events_.g_now) == 0 && all_finite(events_.g_now.data(), events_.g_now.size());
    for (std::size_t i = 0; i < error.size(); ++i) {
      const double difference = std::fabs(error[i] - events_.g_now[i]);
      const bool matters = is_known && difference > 1e-4 * std::max(std::fabs(error[i]), std::fabs(events_.g_now[i]));
      error[i] = matters ? difference : 0.0;
    }
  }

  void determine(double t, bool may_improve, double* g) override {
    integration_.evaluate(t, may_improve, events_.now.x.data(), events_.now.xdot.data());
    events_.t_now = t;
    const int status = call(events_, t, events_.now, events_.g_now);
    stop_if_asked(t);
    if (status != 0 || !all_finite(events_.g_now.data(), events_.g_now.size()))
      throw failure_of(status, t, events_.g_now);
    std::copy(events_.g_now.begin(), events_.g_now.end(), g);
  }

  // The largest change among several: a single one may cancel by chance.
  void rounding(double* noise) override {
    constexpr int patterns = 8;
    std::fill_n(noise, events_.g_now.size(), 0.0);
    RandomSigns signs;
    const auto change = [&signs](const std::vector<double>& values, std::vector<double>& changed) {
      for (std::size_t i = 0; i < values.size(); ++i) changed[i] = signs.changed(values[i]);
    };
    for (int k = 0; k < patterns; ++k) {
      change(events_.now.x, events_.rough.x);
      change(events_.now.xdot, events_.rough.xdot);
      const int status = call(events_, signs.changed(events_.t_now), events_.rough, events_.g_rough);
      if (status != 0 || !all_finite(events_.g_rough.data(), events_.g_rough.size())) continue;
      for (std::size_t i = 0; i < events_.g_now.size(); ++i)
        noise[i] = std::max(noise[i], std::fabs(events_.g_rough[i] - events_.g_now[i]));
    }
  }

  void keep() override { events_.candidate = events_.now; }
  void accept() override { std::swap(events_.searched, events_.candidate); }

 private:
  void stop_if_asked(double t) {
    if (integration_.system_.stop_is_requested())
      throw Failure(SFDAE_STOPPED,
                    format("stopped on request in the event function at t = %.15g; the call can be repeated.", t));
  }

  Integration& integration_;
  Events& events_;
};

// Half of the points that a polynomial of the step's order can swing through, at least; more follow where g bends. Steps
// without differential equations are not limited by anything: there the points are those of a search.
int Integration::halvings_for_events(double from, double to) const {
  const int order = stepper_->state().last.order;
  if (system_.differential() == 0) return 5;
  const int whole = order <= 2 ? 2 : order <= 5 ? 3 : 4;
  const double part = std::fabs((to - from) / stepper_->state().last.h);
  return part < 1.0 ? std::max(1, whole + std::max(-whole, static_cast<int>(std::ceil(std::log2(part))))) : whole;
}

// Where a long step comes after short ones the polynomial may be too rough to show whether there are zeros: it costs
// Radau one reduction a step to know, and the stages of up to three points to make up for it.
void Integration::refine_for_events() {
  Events& events = *options_.events;
  for (double part : {0.5, 0.25, 0.75}) {
    const int before = stepper_->state().refined_points;
    const double t = stepper_->state().t - part * stepper_->state().last.h;
    const PointValues point{t, scratch_w_.data(), events.rough.x.data(), events.rough.xdot.data()};
    stepper_->interpolate(point);
    const PointStatus status = stepper_->refine(system_, weights_, point);
    if (status == PointStatus::callback_error && !system_.callback_error().is_recoverable())
      throw Failure(system_.callback_error().status, system_.callback_error().message());
    if (stepper_->state().refined_points == before) return;
  }
}

void Integration::start_events() {
  Events& events = *options_.events;
  events.resize(index(system_.unknowns()));
  StepValues values(*this);
  const double rounding = start_width * 2.0 * unit_roundoff * std::max(std::fabs(last_returned_), span_);
  events.search.start(values, last_returned_, rounding);
}

std::optional<CallResult> Integration::search_events(double tout) {
  if (options_.events == nullptr) return std::nullopt;
  Events& events = *options_.events;
  if (!events.search.is_started()) start_events();
  const double from = events.search.t(), to = has_passed(tout) ? tout : stepper_->state().t;
  if (!((to - from) * direction_ > 0.0)) return std::nullopt;
  const bool is_new_step =
      std::fabs(stepper_->state().t - from) >= (1.0 - 1e-10) * std::fabs(stepper_->state().last.h);
  StepValues values(*this);
  if (is_new_step && method_ == Method::radau && system_.differential() > 0) {
    refine_for_events();
    values.measure_rough_error(stepper_->state().t - 0.4 * stepper_->state().last.h);
  }
  if (!events.search.search(values, to, halvings_for_events(from, to))) return std::nullopt;
  return CallResult{SFDAE_EVENT, format("event at t = %.15g: sfdae_get_events reports which. Advance again to go on.",
                                        events.search.t())};
}

bool Integration::has_searched_to(double t) const {
  return options_.events != nullptr && options_.events->search.is_started() && options_.events->search.t() == t;
}

void Integration::return_searched_point(double& t, double* x, double* xdot) const {
  const Events& events = *options_.events;
  t = events.search.t();
  std::copy(events.searched.x.begin(), events.searched.x.end(), x);
  std::copy(events.searched.xdot.begin(), events.searched.xdot.end(), xdot);
}

CallResult Integration::interpolate(double t, double* x, double* xdot) {
  const double end = stepper_->state().t, start = end - stepper_->state().last.h;
  if ((t - start) * direction_ < 0.0 || (end - t) * direction_ < 0.0)
    return {SFDAE_ILLEGAL_ARGUMENT,
            format("t = %.15g lies outside of the last step, from %.15g to %.15g.", t, start, end)};
  const std::size_t n = index(system_.unknowns());
  std::vector<double> values(n), slopes(n);
  evaluate(t, true, values.data(), slopes.data());
  std::copy(values.begin(), values.end(), x);
  std::copy(slopes.begin(), slopes.end(), xdot);
  return {};
}

void Integration::archive_events(Archive& archive) {
  Events& events = *options_.events;
  int count = events.search.count();
  archive.small(count);
  if (count != events.search.count())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the checkpoint is one of an integration with %d events, but %d are set.", count,
                         events.search.count()));
  archive.real(span_);
  events.search.archive(archive);
  if (!events.search.is_started()) return;
  const std::size_t n = index(system_.unknowns());
  if (archive.is_reading()) events.resize(n);
  archive.reals(events.searched.x, n);
  archive.reals(events.searched.xdot, n);
  archive.reals(events.rough_error, index(count));
}

}  // namespace sfdae::core
