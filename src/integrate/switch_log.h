// Switches of conditions in recorded equations along a run, and the time in which x moves along their surfaces.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "expression/passed_switch.h"

namespace sfdae::core {

class SwitchLog {
 public:
  void note(std::vector<PassedSwitch> passed, bool jumps) {
    for (PassedSwitch& each : passed) {
      each.jumps = jumps;
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
  std::vector<PassedSwitch> all_;
  long jumps_ = 0;
  double sliding_ = 0.0;
};

}  // namespace sfdae::core
