// SPDX-License-Identifier: BSD-3-Clause
#include "hybrid/switches.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hybrid/hybrid_sensitivities.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Distance of g from the surface that counts as on it, in margins of the transition.
constexpr double margins_of_surface = 16.0;

// The function g of a surface, and its rate.
struct SurfaceValues {
  double g, rate;
};

SurfaceValues values_at(Switch& surface, const HybridRun& run, const double* x, const double* xdot) {
  double values[2] = {};
  if (surface.evaluate(run.t, x, xdot, values)) return {values[0], values[1]};
  throw Failure(SFDAE_NOT_FINITE, format("the surface of a switch, or its rate, is NaN or Inf at t = %.10g.", run.t));
}

// Values of g for the consistent values of a mode at run.x.
SurfaceValues values_in(HybridSystem& hybrid, int mode, Switch& surface) {
  HybridRun& run = hybrid.run;
  std::vector<double> x(run.x), xdot(run.xdot);
  hybrid.call_with_analysis(mode, run.x.data(), [&](Solver& solver) {
    const Jump jump = solver.jump({run.t, run.toward_from(), run.x.data()});
    std::copy(jump.x.begin(), jump.x.end(), x.begin());
    return solver.make_consistent(run.t, x.data(), xdot.data());
  });
  return values_at(surface, run, x.data(), xdot.data());
}

const Switch::Names& names_wanted(const HybridSystem& hybrid) {
  static const Switch::Names none;
  return hybrid.sensitivities ? hybrid.sensitivities->names : none;
}

}  // namespace

int mode_after(HybridSystem& hybrid, const HybridTransition& transition, int to) {
  Switch& surface = *transition.surface;
  HybridRun& run = hybrid.run;
  if (transition.given.from == surface.modes().sliding) return to;
  const SurfaceValues here = values_at(surface, run, run.x.data(), run.xdot.data());
  const double near = margins_of_surface * transition.margin;
  if (std::fabs(here.g) > near) return to;
  const SurfaceValues beyond = values_in(hybrid, to, surface);
  if (std::fabs(beyond.g - here.g) > near) return to;
  const double onward = transition.given.from == surface.modes().below ? run.direction() : -run.direction();
  if (!(here.rate * onward > 0.0 && beyond.rate * onward < 0.0)) return to;
  run.x.back() = onward * run.direction() > 0.0 ? here.rate / (here.rate - beyond.rate)
                                                : beyond.rate / (beyond.rate - here.rate);
  return surface.modes().sliding;
}

void prepare_sliding(HybridSystem& hybrid, int mode) {
  Switch* surface = hybrid.modes[index(mode)].surface;
  if (surface == nullptr) return;
  HybridRun& run = hybrid.run;
  const Switch::Modes& modes = surface->modes();
  const SurfaceValues below = values_in(hybrid, modes.below, *surface);
  const SurfaceValues above = values_in(hybrid, modes.above, *surface);
  const double a = below.rate * run.direction(), b = above.rate * run.direction();
  if (!(a > 0.0 && b < 0.0))
    throw Failure(
        SFDAE_NO_CONSISTENT_VALUES,
        format(
            "%s: the modes do not lead to the surface from both sides: its function changes by %g per unit of time "
            "in %s, by %g in %s, in the direction of integration. Start in one of them.",
            hybrid.name_of(mode).c_str(), a, hybrid.name_of(modes.below).c_str(), b,
            hybrid.name_of(modes.above).c_str()));
  run.x.back() = a / (a - b);
}

bool is_outdated(const HybridSystem& hybrid, const Switch& surface) {
  return surface.is_outdated(names_wanted(hybrid));
}

void update_switches(HybridSystem& hybrid) {
  for (const std::unique_ptr<Switch>& each : hybrid.switches) {
    if (!is_outdated(hybrid, *each)) continue;
    const int mode = each->modes().sliding;
    try {
      each->update(names_wanted(hybrid));
    } catch (const Failure& failure) {
      throw Failure(failure.status(), hybrid.name_of(mode) + ": " + failure.what());
    }
    hybrid.modes[index(mode)].solver = each->solver();
    // Without the events of the new solver the run cannot continue: after a failure it has ended.
    const bool were_set = std::exchange(hybrid.events_are_set, false);
    const int present = std::exchange(hybrid.run.mode, -1);
    set_events_of(hybrid, mode);
    hybrid.events_are_set = were_set;
    hybrid.run.mode = present;
  }
  const auto has_to_be_asked = [&](const std::unique_ptr<Switch>& each) {
    return each->solver()->sensitivities.has_value() != hybrid.sensitivities.has_value();
  };
  if (std::any_of(hybrid.switches.begin(), hybrid.switches.end(), has_to_be_asked)) ask_for_sensitivities(hybrid);
}

void take_options_of_modes(HybridSystem& hybrid, int mode) {
  if (Switch* surface = hybrid.modes[index(mode)].surface) surface->take_options();
}

}  // namespace sfdae::core
