// What goes along with the steps of x, after each of them: sensitivities, or what their adjoints need.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integrate/integrator.h"
#include "integrate/stepper.h"

namespace sfdae::core {

// What has become of a step that was tried: nothing further was done after a failure, or the next one was made
// smaller; it was withdrawn after success; taken; or failed for reasons that need not come again.
enum class AttemptEnd : char { refused, reduced, withdrawn, taken, failed };

// Of redundant equations differentiated by parameters, relative: they contradict each other where a parameter changes.
inline constexpr double contradiction_of_derivatives = 1e-6;

class Companion {
 public:
  virtual ~Companion() = default;

  // At the last point of the integrator, whose history starts there. Throws Failure.
  virtual void start(const Integrator& integrator) = 0;
  // The integrator is going to try a step to t. Nothing has changed where that throws.
  virtual void prepare(Integrator& /*integrator*/, const IntegrationOptions& /*options*/, double /*t*/) {}
  // What has become of it, if it is not taken; more than once where more has been done.
  virtual void note(AttemptEnd) {}
  // Of the step that the integrator has tried with success; any other outcome: the attempt is withdrawn. The same
  // where it throws, and the next call tries that step again.
  virtual StepOutcome attempt(Integrator& integrator, const Tolerances& tolerances) = 0;
  // The step tried has been taken.
  virtual void commit(Integrator& integrator) = 0;
};

// D_h x at the end of a step of BDF, or at stage i; n values.
void discretized_slope(const TriedStep& tried, int i, std::vector<double>& xdot);

}  // namespace sfdae::core
