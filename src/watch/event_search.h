// Search for events: zeros of functions g(t) along an integration, found in the order of their occurrence and located
// to machine precision. It is independent of the integrators.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "watch/determined_values.h"
#include "watch/event_intervals.h"
#include "watch/event_signs.h"
#include "watch/zero_location.h"

namespace sfdae::core {

class EventSearch {
 public:
  // directions[i]: 0, or +1 / -1 if only rising / falling zeros count, in the direction of integration.
  explicit EventSearch(std::vector<int> directions);
  int count() const { return signs_.count(); }
  void set_clear_at_start(std::size_t i) { signs_.set_clear_at_start(i); }

  // Begins at t. Zeros within `rounding` of t belong to the start. Functions that fired at t are not armed there.
  void start(EventValues& values, double t, double rounding);
  // Searches from the end of the last search to `end`: returns true if there is an event, and t() is on it or just
  // after it; else t() = end. If an evaluation fails, it throws and changes nothing. depth: minimum number of halvings.
  bool search(EventValues& values, double end, int depth);

  bool is_started() const { return started_; }
  void reset() { started_ = false; }
  double t() const { return t_; }
  bool is_armed(std::size_t i) const { return signs_.is_armed(i); }
  // Values at the point searched last.
  const std::vector<double>& g() const { return g_; }
  // +1 rising, -1 falling, for the event found last; otherwise 0.
  const std::vector<int>& fired() const { return signs_.fired(); }
  void forget_event() { signs_.forget_event(); }
  void archive(Archive& archive);

 private:
  void move_on(EventValues& values, double t, const std::vector<double>& g);
  bool locate(DeterminedValues& values, const EventSample& to);

  EventSigns signs_;
  bool started_ = false;
  // The point searched last.
  double t_ = 0.0;
  std::vector<double> g_;
  double start_ = 0.0, start_rounding_ = 0.0;
  std::vector<double> trial_;  // g at a start that may fail
  // State of the current search.
  EventIntervals intervals_;
  ZeroLocation location_;
};

}  // namespace sfdae::core
