// Descriptor system of a solver's problem at a point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linear/descriptor_system.h"
#include "solver/solver.h"

namespace sfdae::core {

// Throws Failure, also for an invalid choice.
DescriptorSystem linearized(Solver& solver, const sfdae_linearization& choice);

}  // namespace sfdae::core
