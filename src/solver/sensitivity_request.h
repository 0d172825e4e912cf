// Sensitivities requested from a solver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/sensitivities.h"

namespace sfdae::core {

struct SensitivityRequest {
  std::vector<int> parameters;     // numbers; -1: start values only
  std::vector<double> directions;  // n x count
  // Empty, or dt/dp of the start: directions are derivatives at the moving time, followed by motion with x'.
  std::vector<double> shifts;
  // Directions do not include the last unknown: differential variables stay at the start, even if values are accepted
  // as given.
  bool last_follows = false;
  SensitivityOptions options;
  bool by_adjoint = false;
  long max_kept_steps = 0;  // of the adjoint; 0: all
  int num_of_values = 0;    // the last ones; not parameters, but columns for values before a transition
  int count() const { return static_cast<int>(parameters.size()); }
};

}  // namespace sfdae::core
