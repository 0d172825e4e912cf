// The user's events and what an integration remembers of them.
//
// They live longer than an integration: what has fired does not fire again after a restart at the same point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "sfdae/sfdae.h"
#include "watch/event_resolution.h"
#include "watch/event_search.h"

namespace sfdae::core {

struct Events {
  Events(sfdae_event_function user_function, void* user_data, std::vector<int> directions)
      : function(user_function), user(user_data), search(std::move(directions)) {}
  void resize(std::size_t n);
  // At t, which has been searched last: nothing is known of the polynomials of the step yet.
  void begin_step(double t);

  // Functions are tried without x' first: those that do not depend on it need none, but at points that are returned.
  bool tries_without_slopes = false;
  bool has_slopes = true;  // the point searched last

  struct Point {
    std::vector<double> x, xdot;
  };
  // Writes g, filled with zeros before; returns what the user's function does.
  int evaluate(double t, const Point& point, std::vector<double>& g) const;

  sfdae_event_function function;
  void* user;
  EventSearch search;
  // At the point searched last, at a candidate, at the one determined last, and roughly at others.
  Point searched, candidate, now, rough;
  double t_now = 0.0;
  std::vector<double> g_now, g_rough;
  // Of g at rough points of the last step, where it matters; beyond all numbers: they say nothing.
  std::vector<double> rough_error;
  EventResolution resolution;
};

}  // namespace sfdae::core
