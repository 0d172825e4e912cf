// The jump of a nonlinear problem from values of other equations to consistent ones: impulses.h, with the equations
// linearized at the point after the jump.
//
// That makes sense where impulses, and what jumps, are in the equations linearly, with factors that neither jump nor have
// impulses themselves: E(x) x' with an E that depends on what stays. That is tested at points between the values before
// and after the jump, and with impulses smeared over a short time; where it is not so, there is no answer that does not
// depend on how the switch works inside, and the jump is refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "system/impulses.h"
#include "system/linearized_constraints.h"

namespace sfdae::core {

// start: a jet consistent up to level mu near `before`. Throws Failure: SFDAE_NO_CONSISTENT_VALUES, errors of callbacks.
Jump find_jump(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Jet& start,
               const std::vector<double>& before);

}  // namespace sfdae::core
