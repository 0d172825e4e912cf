// A mechanical system of the core from the struct that users fill.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "c_api/record_multibody.h"
#include "multibody/multibody_callbacks.h"

namespace sfdae_test {

inline std::unique_ptr<sfdae::core::MultibodyProblem> problem_of(const sfdae_multibody_problem& problem) {
  if (problem.equations != nullptr) return sfdae::core::record_multibody(problem);
  return std::make_unique<sfdae::core::CallbackMultibody>(problem);
}

}  // namespace sfdae_test
