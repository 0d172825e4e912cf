// Intervals of a search for events.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/event_intervals.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Halvings beyond the requested ones, if a function might dip through zero between two points. (Chosen.)
constexpr int more_halvings = 8;

}  // namespace

EventIntervals::EventIntervals(int functions) {
  from_.g.assign(index(functions), 0.0);
  pending_.resize(max_pending);
  for (EventSample& sample : pending_) {
    sample.g.resize(index(functions));
    sample.bend.resize(index(functions));
  }
}

void EventIntervals::start(double t, const std::vector<double>& g, double end) {
  begin_at(t, g);
  num_pending_ = 1;
  pending_[0].t = end;
  pending_[0].depth = 0;
}

void EventIntervals::begin_at(double t, const std::vector<double>& g) {
  from_.t = t;
  from_.g = g;
}

void EventIntervals::pass() {
  const EventSample& end = to();
  begin_at(end.t, end.g);
  --num_pending_;
}

// Between two points of one sign a parabola with second difference `bend` over twice the interval comes closer to zero
// by bend / 8 than its ends do; the factor of 4 is a margin for functions that are not parabolas.
bool EventIntervals::must_split(const EventSigns& signs, int depth) const {
  const EventSample& to = pending_[num_pending_ - 1];
  const double middle = from_.t + 0.5 * (to.t - from_.t);
  if (middle == from_.t || middle == to.t || num_pending_ == pending_.size()) return false;
  if (to.depth < depth) return true;
  if (to.depth >= depth + more_halvings || to.depth == 0) return false;
  for (std::size_t i = 0; i < to.g.size(); ++i) {
    if (signs.is_lost(i, to.g[i]) || signs.is_rounding(i, from_.g[i], to.g[i])) continue;
    if (std::min(std::fabs(from_.g[i]), std::fabs(to.g[i])) < 0.5 * to.bend[i]) return true;
  }
  return false;
}

void EventIntervals::split(DeterminedValues& values) {
  EventSample& to = pending_[num_pending_ - 1];
  EventSample& middle = pending_[num_pending_++];
  middle.t = from_.t + 0.5 * (to.t - from_.t);
  if (!values->approximate(middle.t, middle.g.data())) values.determine(middle.t, true, middle.g);
  middle.depth = ++to.depth;
  for (std::size_t i = 0; i < to.g.size(); ++i)
    middle.bend[i] = to.bend[i] = std::fabs(from_.g[i] - 2.0 * middle.g[i] + to.g[i]);
}

}  // namespace sfdae::core
