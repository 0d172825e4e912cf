// Metric of changes of positions and velocities of a mechanical system.
//
// Velocities by the kinetic energy, |dv|^2 = dv^T M dv, if M is symmetric and positive definite: constraints then
// change them as their impulse would, M dv = -C^T p, in any coordinates. Positions by W = M if q' = v; else a change
// has a part S w and one that no velocity leads to, as the length of a quaternion, which is measured with the masses of
// the single components:
//
//     W = B^T M B + R^T D R,   B = S^+,   R = I - S B,   D the diagonal of B^T M B
//
// Without such an M, or with weights w_i of the user, |dx|^2 = sum (dx_i / w_i)^2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_problem.h"
#include "starts/consistent_values.h"

namespace sfdae::core {

// dx = P y for changes of the components that are not fixed, |y| their size, and y = R dx.
struct Metric {
  Matrix P, R;
};

// Adds columns of the identity, the directions for changes of single components.
struct PositionMetric : Metric {
  Matrix open;
};

// terms: those at a position.
PositionMetric position_metric(const MultibodyTerms& terms, const ConsistencyRequest& request);
Metric velocity_metric(const MultibodyTerms& terms, const ConsistencyRequest& request);

}  // namespace sfdae::core
