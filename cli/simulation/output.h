// Rows of the trajectory, and what is watched along it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/discrete.h"
#include "simulation/simulation.h"

namespace sfdae::cli {

class Output {
 public:
  Output(const System& system, bool keeps_aliases, Discrete& discrete, Result& result);

  // Appends a row; eliminated variables are filled in. Variables outside of their bounds become warnings, once each.
  void add(Values& values);

 private:
  void check_bounds(const Values& values);

  const System& system_;
  Discrete& discrete_;
  Result& result_;
  Tape bounds_;               // min and max of each variable that is checked
  std::vector<int> columns_;  // variables of the model
  std::vector<char> is_outside_;
};

}  // namespace sfdae::cli
