// Where an attempted step ends.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "integrate/stepper.h"

namespace sfdae::core {

struct StepBounds {
  double direction;             // +1 or -1
  double tout;                  // the next output
  std::optional<double> limit;  // no step goes beyond
  bool never_pass_output;       // steps end at tout instead of being interpolated
};

struct StepTarget {
  double t;
  double uncut;  // the step wanted, if it was cut short at tout, else 0

  // By more than what nearly there means; h: the step that is left.
  bool is_cut_short(double h) const;
};

// The end of a step that is to have this size, or what limits it.
StepTarget choose_target(const StepState& state, double size, const StepBounds& bounds);

}  // namespace sfdae::core
