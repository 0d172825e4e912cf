// Consistent positions and velocities of mechanical systems whose first-order equations are solved by another
// formulation than local coordinates.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_model.h"
#include "system/jet.h"

namespace sfdae::core {

// The given x with consistent positions and velocities: those that are consistent but for rounding errors stay, others
// move in the metric of the kinetic energy, with dense matrices. Throws Failure.
std::vector<double> with_consistent_motion(MultibodyProblem& problem, const PointOfInterest& point,
                                           const ModelOptions& options);
// Returns whether positions and velocities are the same except for rounding errors.
bool motion_stays(const MultibodySizes& sizes, const std::vector<double>& from, const std::vector<double>& to);
// For a consistent point of a system whose constraints are independent.
ConstraintsReport constraints_at(MultibodyProblem& problem, const Jet& jet);

}  // namespace sfdae::core
