// Intervals of a search for events that are halved where functions might come down to zero within them.
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

  // One interval, from t to end; the values at its end are up to the caller.
  void start(double t, const std::vector<double>& g, double end);
  bool is_empty() const { return num_pending_ == 0; }
  bool has_one() const { return num_pending_ == 1; }
  // Both ends of the first interval.
  const EventSample& from() const { return from_; }
  EventSample& to() { return pending_[num_pending_ - 1]; }

  bool must_split(const EventSigns& signs, int depth) const;
  void split(DeterminedValues& values);
  // The first interval begins later, or at its end: that is, goes on with the next one.
  void begin_at(double t, const std::vector<double>& g);
  void pass();

 private:
  // Right ends at a time: the depths of the search and what comes on top of them fit by far (5 + 8).
  static constexpr int max_pending = 24;

  EventSample from_;
  std::vector<EventSample> pending_;  // right ends, the nearest last
  std::size_t num_pending_ = 0;
};

}  // namespace sfdae::core
