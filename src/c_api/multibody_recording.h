// Multibody systems from what users give: callbacks, or formulas that are recorded.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "multibody/multibody_problem.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

// `problem` has been checked. Failure, with a public status, for mistakes in recording.
std::unique_ptr<MultibodyProblem> multibody_problem(const sfdae_multibody_problem& problem);

}  // namespace sfdae::core
