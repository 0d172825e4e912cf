// Search for events along an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/event_search.h"

#include <cmath>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

EventSearch::EventSearch(std::vector<int> directions)
    : signs_(std::move(directions)),
      g_(index(signs_.count()), 0.0),
      trial_(g_),
      intervals_(signs_.count()),
      location_(signs_.count()) {}

void EventSearch::start(EventValues& values, double t, double rounding) {
  values.determine(t, true, trial_.data());
  if (t != t_) forget_event();
  start_ = t;
  start_rounding_ = rounding;
  signs_.start(trial_);
  values.keep();
  move_on(values, t, trial_);
  started_ = true;
}

void EventSearch::move_on(EventValues& values, double t, const std::vector<double>& g) {
  signs_.update(values, g);
  values.accept();
  t_ = t;
  g_ = g;
}

bool EventSearch::search(EventValues& user_values, double end, int depth) {
  DeterminedValues values(user_values);
  forget_event();
  intervals_.start(t_, g_, end);
  values.determine(end, true, intervals_.to().g);
  while (!intervals_.is_empty()) {
    if (intervals_.must_split(signs_, depth)) {
      intervals_.split(values);
      continue;
    }
    EventSample& to = intervals_.to();
    if (intervals_.has_one() || signs_.is_suspicious(to.g)) {
      if (!values.is_at(to.t)) values.determine(to.t, true, to.g);
      values->keep();
      if (signs_.is_event(to.g)) {
        if (locate(values, to)) return true;
        // The zero belongs to the start; the rest of the interval remains.
        intervals_.begin_at(t_, g_);
        continue;
      }
      move_on(user_values, to.t, to.g);
    }
    intervals_.pass();
  }
  return false;
}

// False if the zero found belongs to the start.
bool EventSearch::locate(DeterminedValues& values, const EventSample& to) {
  location_.find(values, signs_, {t_, g_, intervals_.from().t, to.t, to.g});
  const bool is_at_start = std::fabs(location_.t() - start_) <= start_rounding_;
  const bool has_fired = signs_.disarm(location_.watched(), {g_, to.g, location_.g()}, is_at_start);
  move_on(values.source(), location_.t(), location_.g());
  return has_fired;
}

void EventSearch::archive(Archive& archive) {
  archive.small(started_);
  for (double* value : {&t_, &start_, &start_rounding_}) archive.real(*value);
  archive.reals(g_.data(), g_.size());
  signs_.archive(archive);
}

}  // namespace sfdae::core
