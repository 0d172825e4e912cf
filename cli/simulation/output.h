// Rows of the trajectory, with checks of the values.
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
  // Throws Failure if a value is not finite, or is not a whole number although its type is Integer.
  void add(Values& values) { add(values, values.t); }
  // The same with another time in the row.
  void add(Values& values, double t);

  // Computes eliminated variables; returns whether add() accepts the values.
  bool is_defined(Values& values) const;

 private:
  bool is_defined(int variable, const Values& values) const;
  void check_values(const Values& values) const;
  std::string cause(int variable, const Values& values) const;
  std::string undefined_operation(int variable, const Values& values) const;
  void check_bounds(const Values& values);

  const System& system_;
  Discrete& discrete_;
  Result& result_;
  Tape bounds_;               // min and max of each variable that is checked
  std::vector<int> columns_;  // variables of the model
  std::vector<char> is_outside_;
};

}  // namespace sfdae::cli
