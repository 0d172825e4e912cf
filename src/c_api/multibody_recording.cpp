// Multibody systems from what users give.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/multibody_recording.h"

#include "problem/failure.h"
#include "problem/multibody_callbacks.h"

namespace sfdae::core {

std::unique_ptr<MultibodyProblem> multibody_problem(const sfdae_multibody_problem& problem) {
  if (problem.equations != nullptr)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "recorded multibody systems are not supported yet.");
  return std::make_unique<CallbackMultibody>(problem);
}

}  // namespace sfdae::core
