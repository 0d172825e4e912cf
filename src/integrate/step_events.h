// Events in the driver: the user's functions along the last step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/step_event_values.h"
#include "watch/events.h"

namespace sfdae::core {

// Begins at t; span: the interval of interest.
void start_search(const SearchedStep& step, double t, double span);
// From where the last search ended up to tout, or to the end of the step if that comes first: whether there is an
// event.
bool search_step(const SearchedStep& step, double tout);

// x' of the point searched last, where that was found without. Throws Failure.
void complete_slopes(const SearchedStep& step);

bool has_searched_to(const Events* events, double t);
// The point searched last, in front of which no event has been left out.
void return_searched_point(const Events& events, double& t, double* x, double* xdot);

// n: size of x. Throws Failure if a checkpoint is that of an integration with other events.
void archive_events(Archive& archive, Events& events, std::size_t n, double& span);
// A checkpoint does not fit as it is one of an integration without events, or with them. Throws Failure.
[[noreturn]] void throw_events_differ(bool are_set);

}  // namespace sfdae::core
