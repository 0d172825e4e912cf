// Sizes of the components of x over a step, to which tolerances are relative.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/error_weights.h"
#include "integrate/radau_node.h"

namespace sfdae::core {

class StepScales {
 public:
  void resize(std::size_t n);
  // Sets weights for the larger of the values at both ends of a step. For a component that passes through zero, its
  // change over the step counts as its size nearby.
  void update(ErrorWeights& weights, const RadauNode& start, const RadauNode& end);

 private:
  std::vector<double> largest_, nearby_;
};

}  // namespace sfdae::core
