// Results of an integration that stops: status and message.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integrator.h"
#include "system/change_watch.h"

namespace sfdae::core {

CallResult result_of_wrong_direction(double tout, double last_returned);
CallResult result_beyond_stop_time(double tout, double stop_time);
CallResult result_outside_last_step(double t, double start, double end);
CallResult result_of_event(double t) noexcept;
CallResult result_of_stop_request(double t);
CallResult result_of_monitor_stop(double t);
CallResult result_of_many_steps(long max_steps, double tout, double t);
// excess: factor by which tolerances have to be larger.
CallResult result_of_small_tolerances(double t, double excess);
CallResult result_of_ignored_contradictions(double largest);
CallResult result_of_change(const DaeSystem& system, const LocatedChange& change);
// E x jumps at t, or next to it.
[[noreturn]] void throw_jump_with_sensitivities(double t);
CallResult result_without_branches(double t);
CallResult result_of_layers(double t);
CallResult result_of_idle_steps(double t, double since);
// The smallest step fails, but not because of a change of the characteristic values.
CallResult result_of_smallest_step(StepOutcome outcome, const Integrator& integrator);

}  // namespace sfdae::core
