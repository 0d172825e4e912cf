// Switches of conditions in recorded equations along a run, and the time in which x moves along their surfaces.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "expression/passed_switch.h"

namespace sfdae::core {

class SwitchLog {
 public:
  void note(std::vector<PassedSwitch> passed, bool jumps) {
    for (PassedSwitch& each : passed) {
      each.jumps = jumps;
      each.condition = number_of(each);
      all_.push_back(std::move(each));
    }
    if (jumps) ++jumps_;
  }
  void note_motion_along_surfaces(double duration) { sliding_ += duration; }

  // In the order in which they were passed.
  const std::vector<PassedSwitch>& all() const { return all_; }
  // The number of times at which x jumps.
  long jumps() const { return jumps_; }
  double time_along_surfaces() const { return sliding_; }

 private:
  // Conditions are numbered in the order of their first switches.
  int number_of(const PassedSwitch& passed) {
    const std::pair condition(passed.record.get(), passed.node);
    return numbers_.try_emplace(condition, static_cast<int>(numbers_.size())).first->second;
  }

  std::vector<PassedSwitch> all_;
  std::map<std::pair<const Record*, int>, int> numbers_;
  long jumps_ = 0;
  double sliding_ = 0.0;
};

}  // namespace sfdae::core
