// Changes of the characteristic values along the way: noticed between steps, located.
//
// A value that vanishes at an isolated point leaves traces: the sign of det[E1; A2] (bases aligned from step to step),
// or smallest kept values of the rank decisions, or sizes of rows, that would run straight through zero if one of them
// had its sign changed. These are only suspicions; locate() confirms them by narrowing the point down.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "reduction/linear_system.h"

namespace sfdae::core {

struct LocatedChange {
  double t_before = 0.0;  // the values known still hold here
  double t = 0.0;
  CharacteristicValues new_values;
};

class ChangeWatch {
 public:
  // The current point of the system is the first one of an integration in the given direction.
  void start(LinearSystem& system, double direction);
  // Looks for a change between the point accepted last, t_last, and the current one, at every point that the step went
  // through.
  std::optional<LocatedChange> find(LinearSystem& system, double t_last);
  // The current point of the system is accepted.
  void accept(const LinearSystem& system);
  void archive(Archive& archive, const LinearSystem& system);
  // Looks for the change between left and right. right_fails: other values hold at right.
  static std::optional<LocatedChange> locate(LinearSystem& system, double left, double right, bool right_fails);

 private:
  struct Sample {
    double t = 0.0;
    std::vector<double> values;  // kept values of A^ and E T2, then row norms
  };
  static void keep(const LinearSystem::Trace& trace, Sample& sample);
  static bool breaks_trend(const Sample& older, const Sample& last, const LinearSystem::Trace& now);
  Sample older_, last_;
  Sample trend_[2];
  LinearSystem::Trace now_;
  int samples_ = 0;
};

}  // namespace sfdae::core
