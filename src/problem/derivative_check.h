// Compares derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/linear_problem.h"

namespace sfdae::core {

struct DerivativeMismatch {
  char function = 0;  // 'E', 'A', 'f'; 0: nothing compared
  int order = 0, row = 0, column = 0;
  double supplied = 0.0, difference = 0.0;
  double error = 0.0;        // |supplied - difference| relative to the size of the derivatives compared
  double uncertainty = 0.0;  // of the difference, likewise
  bool suspicious() const { return error > 100.0 * uncertainty; }
};

// The worst mismatch, measured by error / uncertainty, of orders 1..max_order near t. Throws Failure if a callback
// fails otherwise than for want of an order.
DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order);

}  // namespace sfdae::core
