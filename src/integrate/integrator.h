// An integrator at work on a system: the stepper of the method at present and the weights of its error test.
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

  // Without a point to start from; the method is bdf afterwards, or radau.
  void create(Method wanted, const IntegrationOptions& options);
  // Everything is as before where memory is missing.
  void set_options(const IntegrationOptions& options);
  // At the consistent point (t, x) with derivative xdot, where the system stands.
  void start(double t, const std::vector<double>& x, const std::vector<double>& xdot,
             const IntegrationOptions& options);
  // From the last point, with the method at present or another one. Throws Failure; then, and where memory is
  // missing, the history is as before.
  void restart(Method wanted, const IntegrationOptions& options);

  bool has_passed(double t) const { return (stepper->state().t - t) * direction >= 0.0; }
  // Times of this distance, between t and tout, are told apart.
  static double resolution(double t, double tout);
  // Steps from t toward tout are not shorter: what begins at 0 may take place in much shorter times than what ends at
  // tout.
  static double smallest_step(double t, double tout);

  DaeSystem& system;
  double direction;
  Method method = Method::bdf;
  std::unique_ptr<Stepper> stepper;
  ErrorWeights weights;
  double first_step = 0.0;  // the size that a start is tried with, unless the user gives one
  // The history does not fit the system any more, or its next step says nothing about the solution.
  bool must_restart = false;
  Contradictions contradictions;
  DifferenceCheck differences;  // of the point accepted last
};

}  // namespace sfdae::core
