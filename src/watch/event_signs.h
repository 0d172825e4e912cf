// Event functions with the signs that they are armed with.
//
// A function is armed, with a sign, once it is clearly not zero. An event is the change from that sign to zero or to
// the other sign; it disarms the function. So nothing happens twice, and a function that is zero, or nothing but
// rounding errors, is silent (docs/design/events_and_switching.md).
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
  // Zeros of function i fire even if they belong to the start: it is clearly not zero there.
  void set_clear_at_start(std::size_t i) { is_clear_at_start_[i] = 1; }

  // At a start with values g: those that fired have to leave zero before they are armed, unless they are clear there.
  void start(const std::vector<double>& g);
  // At a point that is searched now. Changes that do not count are followed silently; functions that have left zero
  // are armed.
  void update(EventValues& values, const std::vector<double>& g);

  // Whether function i has a sign to lose: functions that are nothing but rounding errors have none.
  bool is_armed(std::size_t i) const { return signs_[i] != 0; }
  // Whether values of function i are nothing but rounding errors, as far as these have been measured.
  bool is_rounding(std::size_t i, double g, double other_g) const;
  // Whether function i has lost the sign that it is armed with.
  bool is_lost(std::size_t i, double g) const;
  // Whether the values of g are worth a closer look, and whether some event shows in them.
  bool is_suspicious(const std::vector<double>& g) const;
  bool is_event(const std::vector<double>& g) const;
  // The signs of functions whose loss counts, 0 for others.
  void watch(std::vector<int>& watched) const;

  // The values of g around an event: at both ends of the interval searched, and at its place.
  struct Surroundings {
    const std::vector<double>& before;
    const std::vector<double>& after;
    const std::vector<double>& at;
  };
  // Disarms the functions watched that have lost their signs; they fire unless the zero belongs to the start. Returns
  // true if any fires.
  bool disarm(const std::vector<int>& watched, const Surroundings& g, bool is_at_start);

  // +1 rising, -1 falling, for the event found last; 0 else.
  const std::vector<int>& fired() const { return fired_; }
  void forget_event();
  void archive(Archive& archive);

 private:
  bool counts(std::size_t i) const { return directions_[i] == 0 || directions_[i] == -signs_[i]; }
  double threshold_after_event(std::size_t i, double g) const;

  std::vector<int> directions_;
  std::vector<char> is_clear_at_start_;
  std::vector<int> signs_, fired_;        // signs_: 0 for functions not armed, which are armed above threshold_
  std::vector<int> vain_;                 // attempts in vain to arm a function, since the start or its event
  std::vector<double> threshold_, size_;  // size_: of g around its event
  std::vector<double> noise_;
};

}  // namespace sfdae::core
