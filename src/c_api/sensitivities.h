// Sensitivities that a solver was asked for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "integrate/integration.h"
#include "sfdae/sensitivity.h"

struct sfdae_solver;

namespace sfdae::core {

inline constexpr int most_sensitivities = 10000;

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

// Reads what the user says, NULL for the defaults.
CallResult read_sensitivity_options(int count, const sfdae_sensitivity_options* given, SensitivityRequest& request);
// Arguments of gradients.
struct GivenFunctionals {
  int n, num_times;
  const double* t;
  int num_functionals;
  const double* weights;
};
CallResult check_functionals(const GivenFunctionals& given);
// From the next start on; none: no more. An integration under way ends, and the analysis stays where it serves.
void take_sensitivities(sfdae_solver& solver, std::optional<SensitivityRequest> request);
// Those that were asked for go with the integration from its start, at the values found, where the system stands.
// Throws Failure, and there is no integration then.
void carry_sensitivities(sfdae_solver& solver, const ConsistentPoint& found);

}  // namespace sfdae::core
