// Events in the driver.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_events.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>

#include "linalg/index.h"
#include "linalg/rank.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Zeros this near to the start, in units of rounding errors of times, belong to the start. (Chosen: typical errors of
// the interval of interest and of the user's times.)
constexpr double start_width = 100.0;
// The last step counts as entirely unsearched from this part on, because of rounding errors of its ends.
constexpr double whole_step = 1.0 - 1e-10;
// Places in the last step, as parts from its end, at which errors of rough values are measured: not the middle or nodes
// of a search. (Chosen.)
constexpr double measured_places[] = {0.4, 0.73, 0.17};
// Halvings of a step without differential equations, whose length is unlimited: only a search resolves it.
constexpr int halvings_of_search = 5;

// At least half of the points at which a polynomial of the step's order can oscillate; more follow where g bends.
int halvings_of_step(int order) { return order <= 2 ? 2 : order <= 5 ? 3 : 4; }

// Halvings for the interval from `from` to `to` within the last step.
int halvings(const Integrator& integrator, const EventResolution& resolution, double from, double to) {
  const LastStep last = integrator.stepper->state().last;
  if (integrator.system.differential() == 0) return halvings_of_search;
  const int whole = std::max(halvings_of_step(last.order), resolution.halvings());
  const double part = std::fabs((to - from) / last.h);
  if (!(part < 1.0)) return whole;
  const double fewer = part > 0.0 ? std::max<double>(-whole, std::ceil(std::log2(part))) : -whole;
  return std::max(1, whole + static_cast<int>(fewer));
}

// Number of the places above: at least one for Radau's long steps; none for BDF if the end is as expected.
std::size_t places_to_measure(const SearchedStep& step, StepEventValues& values) {
  const StepState state = step.integrator.stepper->state();
  if (step.events.resolution.is_suspicious(state.last.h)) return std::size(measured_places);
  const bool is_expected = values.is_expected(state.t);
  if (step.integrator.method != Method::radau) return is_expected ? 0 : 1;
  return is_expected ? 1 : std::size(measured_places);
}

// When a long step follows short ones the polynomial may be too inaccurate to show zeros: testing it costs Radau one
// reduction, and improving it the stages of up to three points.
void refine_polynomial(const SearchedStep& step) {
  const StepState state = step.integrator.stepper->state();
  if (state.interpolates_well) return;
  Events::Point& rough = step.events.rough;
  int refined = state.refined_points;
  for (double part : {0.5, 0.25, 0.75}) {
    step.output.refine(step.integrator, state.t - part * state.last.h, rough.x.data(), rough.xdot.data());
    const int now = step.integrator.stepper->state().refined_points;
    if (now == refined) return;
    refined = now;
  }
}

}  // namespace

void start_search(const SearchedStep& step, double t, double span) {
  step.events.resize(index(step.integrator.system.unknowns()));
  step.events.resolution.start();
  StepEventValues values(step);
  step.events.search.start(values, t, start_width * 2.0 * unit_roundoff * std::max(std::fabs(t), span));
}

bool search_step(const SearchedStep& step, double tout) {
  const Integrator& integrator = step.integrator;
  EventSearch& search = step.events.search;
  const StepState state = integrator.stepper->state();
  const double from = search.t(), to = integrator.has_passed(tout) ? tout : state.t;
  if (!((to - from) * integrator.direction > 0.0)) return false;
  StepEventValues values(step);
  const bool is_new_step = std::fabs(state.t - from) >= whole_step * std::fabs(state.last.h);
  if (is_new_step && integrator.system.differential() > 0) {
    if (integrator.method == Method::radau) refine_polynomial(step);
    step.events.begin_step(from);
    step.events.resolution.look_at([&](std::size_t i) { return search.is_armed(i); });
    if (step.events.resolution.is_misleading(state.last.h)) values.distrust();
    else values.measure_rough_error(std::span(measured_places).first(places_to_measure(step, values)));
  }
  return search.search(values, to, halvings(integrator, step.events.resolution, from, to));
}

void complete_slopes(const SearchedStep& step) {
  Events& events = step.events;
  if (events.has_slopes) return;
  Events::Point& rough = events.rough;
  step.output.evaluate(step.integrator, {step.place_of(events.search.t()), false, Slopes::wanted}, step.options,
                       rough.x.data(), rough.xdot.data());
  events.searched.xdot = rough.xdot;
  events.has_slopes = true;
}

bool has_searched_to(const Events* events, double t) {
  return events != nullptr && events->search.is_started() && events->search.t() == t;
}

void return_searched_point(const Events& events, double& t, double* x, double* xdot) {
  t = events.search.t();
  std::copy(events.searched.x.begin(), events.searched.x.end(), x);
  std::copy(events.searched.xdot.begin(), events.searched.xdot.end(), xdot);
}

void archive_events(Archive& archive, Events& events, std::size_t n, double& span) {
  int count = events.search.count();
  archive.small(count);
  if (count != events.search.count())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the checkpoint is one of an integration with %d events, but %d are set.", count,
                         events.search.count()));
  archive.real(span);
  events.search.archive(archive);
  if (!events.search.is_started()) return;
  if (archive.is_reading()) {
    events.resize(n);
    events.has_slopes = true;
  }
  archive.reals(events.searched.x, n);
  archive.reals(events.searched.xdot, n);
  archive.reals(events.rough_error, index(count));
  events.resolution.archive(archive);
}

void throw_events_differ(bool are_set) {
  throw Failure(SFDAE_ILLEGAL_ARGUMENT, are_set
                                            ? "the checkpoint is one of an integration without events: remove them, "
                                              "restore, and set them again."
                                            : "the checkpoint is one of an integration with events: call "
                                              "sfdae_set_events first.");
}

}  // namespace sfdae::core
