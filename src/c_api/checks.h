// Checks of user input.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sfdae/sfdae.h"

namespace sfdae::core {

// These throw Failure, SFDAE_ILLEGAL_ARGUMENT or SFDAE_EMPTY_PROBLEM, with a message.
void check_problem(const sfdae_linear_problem& problem);
void check_problem(const sfdae_nonlinear_problem& problem);
void check_problem(const sfdae_multibody_problem& problem);
// n: number of unknowns, for the vectors.
void check_options(const sfdae_options& options, int n);

}  // namespace sfdae::core
