// Comparison of derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/difference_comparison.h"
#include "problem/linear_problem.h"

namespace sfdae::core {

// The worst mismatch, measured by error / uncertainty, of orders 1..max_order near t. Throws Failure if a callback
// fails for another reason than a missing order.
DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order);

// One-sided check from t, up to the times given, with a few evaluations if all is right. Throws SFDAE_WRONG_DERIVATIVES
// if a derivative contradicts the function beyond doubt.
void demand_derivatives(LinearProblem& problem, double t, double toward, int max_order);

}  // namespace sfdae::core
