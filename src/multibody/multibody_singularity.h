// The singular configuration of a mechanical system nearest in time, estimated from one point.
//
// Along the motion the constraints are C + tau C' to first order, C' by a difference along (1, S v), and singular for
// tau = -1 / mu with the real eigenvalues mu of C' Q2 (C Q2)^-1, Q2 the range of C^T. Units of rows do not matter: a
// row that vanishes counts as one that depends on others. If C behaves as (t* - t)^p, as with p = 1/2 when a chain is
// stretched, tau = (t* - t) / p (docs/design/singular_points.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_equations.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_ranks.h"

namespace sfdae::core {

struct NearbySingularity {
  double t = 0.0;  // before or after the point; infinite: none
  int row = -1;    // the constraint that turns or shrinks fastest
  // is_of_positions: g_q is singular there; is_of_velocities: C is.
  bool is_of_positions = false, is_of_velocities = false;
};

// point: with terms and rows.
NearbySingularity nearby_singularity(const MultibodyPoint& point, const MultibodyRanks& ranks,
                                     MultibodyEquations& equations, Arena& arena);

}  // namespace sfdae::core
