// The descriptor system of a solver's problem at a point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "c_api/solver.h"
#include "linear/descriptor_system.h"

namespace sfdae::core {

// Throws Failure, also for what is wrong with the choice.
DescriptorSystem linearized(sfdae_solver& solver, const sfdae_linearization& choice);

// Of theory.cpp: the solution at t, within the last step of an integration or at the point of the analysis. Throws
// Failure.
std::vector<double> solution_at(sfdae_solver& solver, double t);

}  // namespace sfdae::core
