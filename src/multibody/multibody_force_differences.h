// mu' of a mechanical system by differences of mu at neighboring points along the solution.
//
// mu(t, q, v) is smooth off the constraints, too, so that points on the tangent suffice.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_equations.h"
#include "multibody/multibody_partition.h"
#include "multibody/multibody_point.h"

namespace sfdae::core {

class MultibodyForceDifferences {
 public:
  // neighbour: overwritten.
  MultibodyForceDifferences(MultibodyEquations& equations, const Partition& partition, MultibodyPoint& neighbour,
                            Arena& arena)
      : equations_(equations), partition_(partition), neighbour_(neighbour), arena_(arena) {}

  // mudot := mu' by differences of order 4, on the side where evaluation is allowed. time_scale: time in which the
  // solution changes, estimated from steps. False if mu cannot be evaluated nearby. Throws Failure if a callback asks
  // to stop.
  bool derivative(const MultibodyPoint& point, double time_scale, double* mudot);

 private:
  double increment(const MultibodyPoint& point, double time_scale) const;
  PointStatus evaluate(const MultibodyPoint& point, double offset);

  MultibodyEquations& equations_;
  const Partition& partition_;
  MultibodyPoint& neighbour_;
  Arena& arena_;
};

}  // namespace sfdae::core
