// Checks of what users pass in.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "integrate/integration.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

inline CallResult illegal_argument(std::string message) { return {SFDAE_ILLEGAL_ARGUMENT, std::move(message)}; }

// SFDAE_OK, SFDAE_ILLEGAL_ARGUMENT or SFDAE_EMPTY_PROBLEM, and what is wrong.
CallResult check_problem(const sfdae_linear_problem& problem);
CallResult check_problem(const sfdae_nonlinear_problem& problem);
CallResult check_problem(const sfdae_multibody_problem& problem);
// n: number of unknowns, for the vectors.
CallResult check_options(const sfdae_options& options, int n);

}  // namespace sfdae::core
