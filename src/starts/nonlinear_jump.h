// The jump of a nonlinear problem from values of other equations to consistent ones: impulses.h, with the equations
// linearized at the point after the jump.
//
// This makes sense if the equations contain impulses, and values that jump, linearly, with factors that neither jump
// nor have impulses themselves: E(x) x' with an E that depends on values that stay. This is tested at points between
// the values before and after the jump, and with impulses smeared over a short time. If it fails, any answer would
// depend on how the switch works inside, and the jump is refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "starts/impulses.h"
#include "starts/linearized_constraints.h"

namespace sfdae::core {

// Point of linearization of the equations of impulses: a jet after the jump, theta (impulses.h), all rows there.
struct JumpPoint {
  Jet jet;
  Matrix theta;
  TaylorData data;
};
// Coefficients of all rows, even those that structural analysis leaves out. rows: factors to be reused, or null.
TaylorData coefficients_of_jump(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Jet& jet,
                                const std::vector<double>* rows, Orders orders);
// The jet after the jump with x anywhere between both sides (part 0: before, 1: after), or far off if there are
// impulses, and with other derivatives: those of a smooth transition that takes a while. strength: how far off.
Jet jet_aside(const LinearizedConstraints::Known& known, const JumpPoint& at, double part, double strength);

// start: a jet consistent up to level mu near `before`, afterwards that of the values after the jump. Throws Failure:
// SFDAE_NO_CONSISTENT_VALUES, errors of callbacks.
Jump find_jump(NonlinearProblem& problem, const LinearizedConstraints::Known& known,
               const std::vector<double>& before, Jet& start);

}  // namespace sfdae::core
