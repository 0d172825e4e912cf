// A listed elimination (planned_lu.h) of several matrices side by side, one in each lane.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/lanes.h"
#include "linalg/planned_lu.h"

namespace sfdae::core {

class PlannedLanes {
 public:
  // X := A^-1 B, b and x: one column after the other, without overlap. values: in the order of the pattern. False:
  // pivots are unsuitable for one of the matrices, which have to be solved one by one. Allocates only for new sizes.
  bool solve(const EliminationList& list, const LaneBlock* values, const LaneBlock* b, int count, LaneBlock* x);

 private:
  LaneArray scaled_, values_,
      inverse_;                 // in the order of the pattern; pivots, entries of rows, multipliers; of the pivots
  LaneArray b_, y_, r_, sums_;  // by steps, columns side by side
};

}  // namespace sfdae::core
