// Events in the driver: the user's functions along the last step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/step_event_values.h"
#include "watch/events.h"

namespace sfdae::core {

// Begins at t; span: the interval of interest.
void start_search(const SearchedStep& step, double t, double span);
// Searches from the end of the last search to tout, or to the end of the step if that comes first: true if there is an
// event.
bool search_step(const SearchedStep& step, double tout);

// Computes x' of the point searched last if that was found without. Throws Failure.
void complete_slopes(const SearchedStep& step);

bool has_searched_to(const Events* events, double t);
// The point searched last; no event before it has been missed.
void return_searched_point(const Events& events, double& t, double* x, double* xdot);

// n: size of x. Throws Failure if a checkpoint is that of an integration with other events.
void archive_events(Archive& archive, Events& events, std::size_t n, double& span);
// Throws Failure for a checkpoint of an integration without events if there are events, or the opposite.
[[noreturn]] void throw_events_differ(bool are_set);

}  // namespace sfdae::core
