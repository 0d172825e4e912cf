// Sensitivities that a solver was asked for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/sensitivities.h"

namespace sfdae::core {

struct SensitivityRequest {
  std::vector<int> parameters;     // numbers; -1: start values only
  std::vector<double> directions;  // n x count
  // Empty, or dt/dp of the start: directions are derivatives at the time that moves, and x' goes on after it.
  std::vector<double> shifts;
  // Directions say nothing of the last unknown: what is differentiated stays at the start, even where values have to
  // be accepted.
  bool last_follows = false;
  SensitivityOptions options;
  bool by_adjoint = false;
  long max_kept_steps = 0;  // of the adjoint; 0: all
  int num_of_values = 0;    // the last ones, which are none of parameters, but of values before a transition
  int count() const { return static_cast<int>(parameters.size()); }
};

}  // namespace sfdae::core
