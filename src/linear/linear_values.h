// Consistent initial values of a linear problem.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linear/linear_system.h"
#include "starts/consistent_values.h"
#include "system/consistency_request.h"

namespace sfdae::core {

ConstrainedPoint constraints_of(LinearSystem& system);

// Makes x (n values) consistent at the point the system was moved to. Throws Failure SFDAE_INCONSISTENT_VALUES or
// SFDAE_FIXED_VALUES and leaves x as it was then.
ConsistencyResult make_consistent(LinearSystem& system, const ConsistencyRequest& request, std::vector<double>& x);
// The same with the constraints of the current system.
ConsistencyResult make_consistent(LinearSystem& system, const ConstrainedPoint& constraints,
                                  const ConsistencyRequest& request, std::vector<double>& x);

}  // namespace sfdae::core
