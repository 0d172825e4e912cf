// The unit of time of equations in which x and x', in the sizes of x, have the same effect on them. Searches that weigh
// or choose derivatives use it, so that results do not depend on the user's unit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Point of evaluation. jet: x and x', 2 n values; sizes: n changes of x that matter equally.
struct PointOfUnits {
  double t;
  const double* jet;
  const std::vector<double>& sizes;
};

// Logarithmic mean over the equations that contain both; 1 if there are none. In units of t; powers up to that order
// neither overflow nor underflow.
double time_unit(TaylorEvaluator& evaluator, const PointOfUnits& point, int highest_order);

}  // namespace sfdae::core
