// Signs with which event functions are armed.
//
// A function is armed, with a sign, once it is clearly nonzero. An event is the change from that sign to zero or to the
// other sign; it disarms the function. Therefore no event is reported twice, and a function that is zero or dominated
// by roundoff reports none (docs/design/events_and_switching.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "watch/event_values.h"

namespace sfdae::core {

class EventSigns {
 public:
  // directions[i]: 0, or +1 / -1 if only rising / falling zeros count, in the direction of integration.
  explicit EventSigns(std::vector<int> directions);
  int count() const { return static_cast<int>(directions_.size()); }
  // Zeros of function i fire even if they belong to the start: the function is clearly nonzero there.
  void set_clear_at_start(std::size_t i) { is_clear_at_start_[i] = 1; }

  // Start with values g: functions that fired must leave zero before they are armed, unless set_clear_at_start().
  void start(const std::vector<double>& g);
  // Update at the point searched now. Sign changes that do not count are followed silently; functions that have left
  // zero are armed.
  void update(EventValues& values, const std::vector<double>& g);

  // True if function i is armed with a sign; functions dominated by roundoff have none.
  bool is_armed(std::size_t i) const { return signs_[i] != 0; }
  // True if both values of function i are within the measured rounding errors.
  bool is_rounding(std::size_t i, double g, double other_g) const;
  // True if function i has lost the sign with which it is armed.
  bool is_lost(std::size_t i, double g) const;
  // is_suspicious(): the values of g need accurate evaluation. is_event(): they show an event.
  bool is_suspicious(const std::vector<double>& g) const;
  bool is_event(const std::vector<double>& g) const;
  // The signs of functions whose loss counts, 0 for others.
  void watch(std::vector<int>& watched) const;

  // Values of g at both ends of the interval with the event, and at the event.
  struct Surroundings {
    const std::vector<double>& before;
    const std::vector<double>& after;
    const std::vector<double>& at;
  };
  // Disarms the watched functions that have lost their signs; they fire unless the zero belongs to the start. Returns
  // true if any fires.
  bool disarm(const std::vector<int>& watched, const Surroundings& g, bool is_at_start);

  // +1 rising, -1 falling, for the event found last; otherwise 0.
  const std::vector<int>& fired() const { return fired_; }
  void forget_event();
  void archive(Archive& archive);

 private:
  bool counts(std::size_t i) const { return directions_[i] == 0 || directions_[i] == -signs_[i]; }
  double threshold_after_event(std::size_t i, double g) const;

  std::vector<int> directions_;
  std::vector<char> is_clear_at_start_;
  std::vector<int> signs_, fired_;        // signs_: 0 if not armed; armed above threshold_
  std::vector<int> vain_;                 // failed attempts to arm a function since the start or its event
  std::vector<double> threshold_, size_;  // size_: of g around its event
  std::vector<double> noise_;
};

}  // namespace sfdae::core
