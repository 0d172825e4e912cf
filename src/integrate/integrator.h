// Integrator of a system: the stepper of the current method and the weights of its error test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "integrate/contradictions.h"
#include "integrate/difference_check.h"
#include "integrate/error_weights.h"
#include "integrate/integration_options.h"
#include "integrate/stepper.h"
#include "system/dae_system.h"

namespace sfdae::core {

struct Integrator {
  // direction: +1 or -1.
  Integrator(DaeSystem& its_system, double its_direction) : system(its_system), direction(its_direction) {}

  // Creates a stepper without a starting point; the method is bdf afterwards, or radau.
  void create(Method wanted, const IntegrationOptions& options);
  // Changes nothing if memory is missing.
  void set_options(const IntegrationOptions& options);
  // Starts at the consistent point (t, x) with derivative xdot, the current point of the system.
  void start(double t, const std::vector<double>& x, const std::vector<double>& xdot,
             const IntegrationOptions& options);
  // Restarts from the last point, with the current method or another one. Throws Failure; then, and if memory is
  // missing, the history is unchanged.
  void restart(Method wanted, const IntegrationOptions& options);

  bool has_passed(double t) const { return (stepper->state().t - t) * direction >= 0.0; }
  // Smallest resolved difference of times between t and tout.
  static double resolution(double t, double tout);
  // Minimum size of steps from t toward tout: near 0 it is much smaller than the rounding errors of tout.
  static double smallest_step(double t, double tout);

  DaeSystem& system;
  double direction;
  Method method = Method::bdf;
  std::unique_ptr<Stepper> stepper;
  ErrorWeights weights;
  double first_step = 0.0;  // initial step size unless the user gives one
  // The history no longer fits the system, or its next step size is unsuitable.
  bool must_restart = false;
  Contradictions contradictions;
  DifferenceCheck differences;  // of the point accepted last
};

}  // namespace sfdae::core
