// The unit of time of equations: that in which x and x' of the sizes of x matter to them as much as each other.
// Searches that weigh or choose derivatives use it, as what they find must not depend on the unit that the user has
// chosen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/taylor_evaluator.h"

namespace sfdae::core {

// Where equations are looked at: jet: x and x', 2 n values; sizes: n changes of x that matter alike.
struct PointOfUnits {
  double t;
  const double* jet;
  const std::vector<double>& sizes;
};

// The mean of the equations that contain both, of logarithms; 1 where there is none. In units of t; powers up to that
// order neither overflow nor vanish.
double time_unit(TaylorEvaluator& evaluator, const PointOfUnits& point, int highest_order);

}  // namespace sfdae::core
