// Common functions of integrators.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/stepper.h"

namespace sfdae::core {

std::optional<StepOutcome> failed_outcome(PointStatus status) {
  switch (status) {
    case PointStatus::callback_error: return StepOutcome::callback_error;
    case PointStatus::changed: return StepOutcome::changed;
    case PointStatus::leading_changed: return StepOutcome::leading_changed;
    case PointStatus::singular: return StepOutcome::singular;
    case PointStatus::not_converged: return StepOutcome::not_converged;
    case PointStatus::ok: break;
  }
  return std::nullopt;
}

}  // namespace sfdae::core
