// Sensitivities that a solver was asked for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/sensitivities.h"
#include "sfdae/sensitivity.h"

struct sfdae_solver;

namespace sfdae::core {

struct SensitivityRequest {
  std::vector<int> parameters;     // numbers; -1: start values only
  std::vector<double> directions;  // n x count
  SensitivityOptions options;
  bool by_adjoint = false;
  long max_kept_steps = 0;  // of the adjoint; 0: all
  int count() const { return static_cast<int>(parameters.size()); }
};

// Those that were asked for go with the integration from its start, where the system stands; x: values found. Throws
// Failure, and there is no integration then.
void carry_sensitivities(sfdae_solver& solver, const std::vector<double>& x);

}  // namespace sfdae::core
