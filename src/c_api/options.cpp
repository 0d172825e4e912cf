// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/options.h"

#include <vector>

#include "c_api/codes.h"
#include "linalg/index.h"

namespace sfdae::core {

SolverOptions solver_options(const sfdae_options& o, int n) {
  SolverOptions options;
  ModelOptions& model = options.model;
  IntegrationOptions& integration = options.integration;
  options.xdot_is_guess = o.xdot_is_guess != 0;
  options.checks_derivatives = o.check_derivatives != 0;
  options.has_smooth_conditions = o.conditions == SFDAE_CONDITIONS_SMOOTH;
  model.analysis = {o.max_index, o.reduction == SFDAE_REDUCTION_SVD, o.rank_tol, o.time_scale};
  model.differences = {o.difference_derivatives != 0, o.difference_step, 1.0};
  model.leading = leading_term_of(o.leading_term);
  model.structure = structure_use_of(o.structure);
  model.consistency.kind = initial_values_of(o.initial_values);
  model.consistency.keeps_differentiated = true;
  if (o.initial_values == SFDAE_INITIAL_FIXED)
    for (int i = 0; i < n; ++i) model.consistency.fixed.push_back(static_cast<char>(o.fixed[i]));
  if (o.initial_weights != nullptr) model.consistency.weights.assign(o.initial_weights, o.initial_weights + n);
  const auto tolerance = [n](const double* each, double all) {
    return each != nullptr ? PerComponent(std::vector<double>(each, each + n)) : PerComponent::same(index(n), all);
  };
  model.tolerances = {tolerance(o.rtol_vector, o.rtol), tolerance(o.atol_vector, o.atol)};
  model.analysis.least_useful_pivot = least_useful_pivot(model.tolerances.rtol.different());
  model.ignore_inconsistency = o.ignore_inconsistency != 0;
  model.consistency_tol = o.consistency_tol;
  static_cast<Acceptance&>(integration) = model;
  integration.method = method_of(o.method);
  integration.stepping.max_order = o.max_order;
  integration.stepping.min_stages = o.min_stages;
  integration.stepping.max_stages = o.max_stages;
  integration.interpolates_outputs = o.output == SFDAE_OUTPUT_INTERPOLATED;
  integration.initial_step = o.initial_step;
  integration.max_step = o.max_step;
  if (o.use_stop_time != 0) integration.stop_time = o.stop_time;
  integration.max_steps = o.max_steps;
  options.max_seconds = o.max_seconds;
  integration.monitor = o.monitor;
  integration.monitor_user = o.monitor_user;
  return options;
}

}  // namespace sfdae::core
