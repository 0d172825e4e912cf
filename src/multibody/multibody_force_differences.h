// mu' of a mechanical system by differences of mu at neighbouring points along the solution.
//
// mu(t, q, v) is smooth beside the constraints, too, so that points on the tangent will do.
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

  // mudot := mu' by differences of order 4, on the side that may be evaluated. time_scale: in which the solution
  // changes, as far as steps know. False if mu is not to be had near by. Throws Failure where a callback asks to
  // stop.
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
