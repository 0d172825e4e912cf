// Location of the first zero of event functions within an interval, to machine precision.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "watch/determined_values.h"
#include "watch/event_signs.h"
#include "watch/zero_bracket.h"

namespace sfdae::core {

// Interval in which some function loses its sign.
struct ZeroInterval {
  // The point searched last.
  double searched;
  const std::vector<double>& g_searched;
  // Later or the same; rough values show no event up to it.
  double from;
  // Candidate point at the end.
  double to;
  const std::vector<double>& g_to;
};

class ZeroLocation {
 public:
  explicit ZeroLocation(int functions);
  // Finds the first zero with a sign change that counts; the point just after it is the last candidate.
  void find(DeterminedValues& values, const EventSigns& signs, const ZeroInterval& interval);
  // This point, the values there, and the signs watched for it.
  double t() const { return bracket_.after(); }
  const std::vector<double>& g() const { return bracket_.g_after(); }
  const std::vector<int>& watched() const { return watched_; }

 private:
  bool guess(DeterminedValues& values, const ZeroInterval& interval, double& t);
  void place(DeterminedValues& values, double t);
  void include_simultaneous(DeterminedValues& values, const ZeroInterval& interval);

  ZeroBracket bracket_, rough_bracket_;
  std::vector<int> watched_;  // signs that count, otherwise 0
  std::vector<double> trial_, rough_before_, rough_after_;
};

}  // namespace sfdae::core
