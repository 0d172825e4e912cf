// Comparison of total derivatives that a callback supplies along a jet with differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/callback_problem.h"
#include "problem/difference_comparison.h"

namespace sfdae::core {

// derivatives: x, x', ..., x^(max_order + 1) at t, n x (max_order + 2). Returns the worst mismatch of the orders
// 0..max_order. Throws Failure if the callback fails for another reason than a missing order.
DerivativeMismatch check_total_derivatives(CallbackProblem& problem, double t, const double* derivatives,
                                           int max_order);

}  // namespace sfdae::core
