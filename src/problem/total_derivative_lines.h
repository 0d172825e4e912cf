// One-sided comparison of total derivatives that a callback supplies along a jet with its functions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/callback_problem.h"

namespace sfdae::core {

// derivatives: x, x', ..., x^(max_order + 1) at t, n x (max_order + 2). Throws SFDAE_WRONG_DERIVATIVES if a derivative
// of the orders up to max_order contradicts the function beyond doubt.
void demand_total_derivatives(CallbackProblem& problem, double t, double toward, const double* derivatives,
                              int max_order);

}  // namespace sfdae::core
