// Intervals of an event search, halved where event functions might reach zero inside.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "watch/determined_values.h"
#include "watch/event_signs.h"

namespace sfdae::core {

struct EventSample {
  double t = 0.0;
  int depth = 0;                // how often the interval in front of it was halved
  std::vector<double> g, bend;  // bend: second difference of g over the interval that was halved
};

class EventIntervals {
 public:
  explicit EventIntervals(int functions);

  // Starts with one interval, from t to end; the caller sets the values at its end.
  void start(double t, const std::vector<double>& g, double end);
  bool is_empty() const { return num_pending_ == 0; }
  bool has_one() const { return num_pending_ == 1; }
  // Both ends of the first interval.
  const EventSample& from() const { return from_; }
  EventSample& to() { return pending_[num_pending_ - 1]; }

  bool must_split(const EventSigns& signs, int depth) const;
  void split(DeterminedValues& values);
  // Moves the start of the first interval, or removes the interval: then the next one is the first.
  void begin_at(double t, const std::vector<double>& g);
  void pass();

 private:
  // Maximum of right ends at a time; a search halves intervals at most 12 + 8 times.
  static constexpr int max_pending = 24;

  EventSample from_;
  std::vector<EventSample> pending_;  // right ends, the nearest last
  std::size_t num_pending_ = 0;
};

}  // namespace sfdae::core
