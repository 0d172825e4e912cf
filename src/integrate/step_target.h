// End of an attempted step.
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
  double uncut;  // the step size wanted if the step was cut short at tout, otherwise 0

  // True if the cut is more than negligible; h: size of the remaining step.
  bool is_cut_short(double h) const;
};

// End of a step of this size, subject to the bounds.
StepTarget choose_target(const StepState& state, double size, const StepBounds& bounds);

}  // namespace sfdae::core
