// Compares derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/difference_comparison.h"
#include "problem/linear_problem.h"

namespace sfdae::core {

// The worst mismatch, measured by error / uncertainty, of orders 1..max_order near t. Throws Failure if a callback
// fails otherwise than for want of an order.
DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order);

// The same from one side of t, up to the times given, with a few evaluations, as long as all is right. Throws
// SFDAE_WRONG_DERIVATIVES where a derivative contradicts the function beyond doubt.
void demand_derivatives(LinearProblem& problem, double t, double toward, int max_order);

}  // namespace sfdae::core
