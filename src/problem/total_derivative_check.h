// Compares total derivatives that a callback supplies along a jet with differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/callback_problem.h"
#include "problem/difference_comparison.h"

namespace sfdae::core {

// derivatives: x, x', ..., x^(max_order + 1) at t, n x (max_order + 2). The worst mismatch of the orders
// 0..max_order. Throws Failure if the callback fails otherwise than for want of an order.
DerivativeMismatch check_total_derivatives(CallbackProblem& problem, double t, const double* derivatives,
                                           int max_order);

}  // namespace sfdae::core
