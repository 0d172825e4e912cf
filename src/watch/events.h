// The user's events and their state during integrations.
//
// They outlive an integration: an event that has fired does not fire again after a restart at the same point.
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
  // Begins a step at t, the point searched last: the polynomials of the step are not known yet.
  void begin_step(double t);

  // Tries functions without x' first: those that do not depend on it need x' only at points that are returned.
  bool tries_without_slopes = false;
  bool has_slopes = true;  // for the point searched last

  struct Point {
    std::vector<double> x, xdot;
  };
  // Writes g, which is set to zero before; returns the value of the user's function.
  int evaluate(double t, const Point& point, std::vector<double>& g) const;

  sfdae_event_function function;
  void* user;
  EventSearch search;
  // The point searched last, a candidate, the one determined last, and points with rough values.
  Point searched, candidate, now, rough;
  double t_now = 0.0;
  std::vector<double> g_now, g_rough;
  // Error of g at rough points of the last step, for functions where it matters; infinite: the values are useless.
  std::vector<double> rough_error;
  EventResolution resolution;
};

}  // namespace sfdae::core
