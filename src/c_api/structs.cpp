// Defaults of the public structs.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/structs.h"

#include "integrate/step_control.h"
#include "system/stage_method.h"

namespace sfdae::core {

sfdae_linear_problem default_problem() {
  sfdae_linear_problem problem{};
  problem.size = sizeof problem;
  return problem;
}

sfdae_nonlinear_problem default_nonlinear_problem() {
  sfdae_nonlinear_problem problem{};
  problem.size = sizeof problem;
  return problem;
}

sfdae_multibody_problem default_multibody_problem() {
  sfdae_multibody_problem problem{};
  problem.size = sizeof problem;
  problem.coordinates = SFDAE_COORDINATES_ORTHOGONAL;
  return problem;
}

sfdae_options default_options() {
  sfdae_options options{};
  options.size = sizeof options;
  options.rtol = 1e-6;
  options.atol = 1e-6;
  options.max_index = 5;
  options.reduction = SFDAE_REDUCTION_STAGED;
  options.initial_values = SFDAE_INITIAL_NEAREST;
  options.consistency_tol = 1e-8;
  options.max_order = max_bdf_order;
  options.max_steps = 100000;
  options.leading_term = SFDAE_LEADING_AUTOMATIC;
  options.method = SFDAE_METHOD_BDF;
  options.min_stages = 1;
  options.max_stages = max_stages;
  options.output = SFDAE_OUTPUT_CONSISTENT;
  options.check_derivatives = 1;
  options.structure = SFDAE_STRUCTURE_AUTOMATIC;
  options.conditions = SFDAE_CONDITIONS_EVENTS;
  return options;
}

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_linear_problem_init(sfdae_linear_problem* problem, size_t size) {
  return initialize(problem, size, default_problem());
}
int sfdae_nonlinear_problem_init(sfdae_nonlinear_problem* problem, size_t size) {
  return initialize(problem, size, default_nonlinear_problem());
}
int sfdae_multibody_problem_init(sfdae_multibody_problem* problem, size_t size) {
  return initialize(problem, size, default_multibody_problem());
}
int sfdae_structure_init(sfdae_structure* structure, size_t size) {
  sfdae_structure empty{};
  empty.doubtful_block = -1;
  return initialize(structure, size, empty);
}

int sfdae_multibody_report_init(sfdae_multibody_report* report, size_t size) {
  return initialize(report, size, sfdae_multibody_report{});
}
int sfdae_options_init(sfdae_options* options, size_t size) { return initialize(options, size, default_options()); }
int sfdae_characteristics_init(sfdae_characteristics* characteristics, size_t size) {
  return initialize(characteristics, size, sfdae_characteristics{});
}
int sfdae_decision_init(sfdae_decision* decision, size_t size) {
  return initialize(decision, size, sfdae_decision{});
}
int sfdae_change_init(sfdae_change* change, size_t size) { return initialize(change, size, sfdae_change{}); }
int sfdae_initial_report_init(sfdae_initial_report* report, size_t size) {
  return initialize(report, size, sfdae_initial_report{});
}
int sfdae_statistics_init(sfdae_statistics* statistics, size_t size) {
  return initialize(statistics, size, sfdae_statistics{});
}
int sfdae_derivative_check_init(sfdae_derivative_check* check, size_t size) {
  return initialize(check, size, sfdae_derivative_check{});
}

}  // extern "C"
