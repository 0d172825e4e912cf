// Consistent discrete and continuous values at the start.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/discrete.h"
#include "simulation/initialization.h"
#include "simulation/switches.h"

namespace sfdae::cli {

class InitialState {
 public:
  // modes: with the free parameters among the unknowns.
  InitialState(const System& system, Modes& modes, LibraryCalls& calls, Switches& switches, Discrete& discrete)
      : system_(system), modes_(modes), calls_(calls), switches_(switches), discrete_(discrete) {}

  // Throws Failure.
  void find(double t, Values& values, std::vector<std::string>& warnings);

 private:
  void set_start_values(double t, Values& values) const;
  std::vector<Condition> reinitializations(Values& values);

  const System& system_;
  Modes& modes_;
  LibraryCalls& calls_;
  Switches& switches_;
  Discrete& discrete_;
};

}  // namespace sfdae::cli
