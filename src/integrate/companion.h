// Companions of the steps of x, computed after each step: sensitivities, or data for adjoints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integrator.h"
#include "integrate/stepper.h"

namespace sfdae::core {

// Outcome of a step tried. refused: nothing more was computed; reduced: the next step was made smaller; withdrawn:
// undone after success; taken; failed: for reasons that may not recur.
enum class AttemptEnd : char { refused, reduced, withdrawn, taken, failed };

// Allowed relative contradiction of redundant equations differentiated by parameters.
inline constexpr double contradiction_of_derivatives = 1e-6;

class Companion {
 public:
  virtual ~Companion() = default;

  // Starts at the last point of the integrator, where its history starts. Throws Failure.
  virtual void start(const Integrator& integrator) = 0;
  // Called before the integrator tries a step to t. An exception changes nothing.
  virtual void prepare(Integrator& /*integrator*/, const IntegrationOptions& /*options*/, double /*t*/) {}
  // Notes the outcome of an attempt that is not taken; may be called repeatedly with later outcomes.
  virtual void note(AttemptEnd) {}
  // Companion computation for a step that the integrator has tried successfully. Any outcome but accepted withdraws the
  // attempt. An exception does so, too, and the next call tries that step again.
  virtual StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) = 0;
  // Called after the step was taken.
  virtual void commit(Integrator& integrator) = 0;
};

// D_h x at the end of a BDF step, or at stage i; n values.
void discretized_slope(const TriedStep& tried, int i, std::vector<double>& xdot);

}  // namespace sfdae::core
