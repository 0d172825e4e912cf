// What goes along with the steps of x, after each of them: sensitivities, or what their adjoints need.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integrator.h"
#include "integrate/stepper.h"

namespace sfdae::core {

class Companion {
 public:
  virtual ~Companion() = default;

  // At the last point of the integrator, whose history starts there. Throws Failure.
  virtual void start(const Integrator& integrator) = 0;
  // Of the step that the integrator has tried with success; any other outcome: the attempt is withdrawn. The same where it
  // throws, and the next call tries that step again.
  virtual StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) = 0;
  // The step tried has been taken.
  virtual void commit(Integrator& integrator) = 0;
};

// D_h x at the end of a step of BDF, or at stage i; n values.
void discretized_slope(const TriedStep& tried, int i, std::vector<double>& xdot);

}  // namespace sfdae::core
