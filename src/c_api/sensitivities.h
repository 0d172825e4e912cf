// User input for sensitivities.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integration_options.h"
#include "sfdae/sensitivity.h"
#include "solver/sensitivity_request.h"

namespace sfdae::core {

inline constexpr int most_sensitivities = 10000;

// Reads the user's options, NULL for the defaults.
void read_sensitivity_options(int count, const sfdae_sensitivity_options* given, SensitivityRequest& request);
// Arguments of gradients.
struct GivenFunctionals {
  int n, num_times;
  const double* t;
  int num_functionals;
  const double* weights;
};
void check_functionals(const GivenFunctionals& given);

}  // namespace sfdae::core
