// Conversion of the public structs of problems to models of the core.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "sfdae/sfdae.h"
#include "solver/formulated_model.h"

namespace sfdae::core {

// The problems have been checked. Throws Failure, with a public status, for mistakes in recording.
std::unique_ptr<FormulatedModel> make_model(const sfdae_linear_problem& problem);
// Recorded equations that are linear become a linear model.
std::unique_ptr<FormulatedModel> make_model(const sfdae_nonlinear_problem& problem);
std::unique_ptr<FormulatedModel> make_model(const sfdae_multibody_problem& problem);

LinearFunctions functions_of(const sfdae_linear_problem& problem);

}  // namespace sfdae::core
