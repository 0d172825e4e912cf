// The user's events and what an integration remembers of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "integrate/events.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// Lives longer than an integration: what has fired does not fire again after a restart at the same point.
struct Events {
  Events(sfdae_event_function user_function, void* user_data, std::vector<int> directions)
      : function(user_function), user(user_data), search(std::move(directions)) {}

  sfdae_event_function function;
  void* user;
  EventSearch search;
  void resize(std::size_t n);

  struct Point {
    std::vector<double> x, xdot;
  };
  // At the point searched last, at a candidate, at the one determined last, and roughly at others.
  Point searched, candidate, now, rough;
  double t_now = 0.0;
  std::vector<double> g_now, g_rough;
  std::vector<double> rough_error;  // of g at rough points of the last step, where it matters
};

// A new integration begins, or one without them goes on.
void forget_search(Events& events);
// A checkpoint does not fit as it is one of an integration without events, or with them. Throws Failure.
[[noreturn]] void throw_events_differ(bool are_set);

}  // namespace sfdae::core
