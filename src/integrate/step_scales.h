// Sizes of the components of x over a step, which its tolerances are relative to.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/error_weights.h"
#include "integrate/radau_node.h"

namespace sfdae::core {

class StepScales {
 public:
  void resize(std::size_t n);
  // Tolerances for what is larger at either end of a step. Where a component runs through zero, its size nearby is
  // what it changes by.
  void update(ErrorWeights& weights, const RadauNode& start, const RadauNode& end);

 private:
  std::vector<double> largest_, nearby_;
};

}  // namespace sfdae::core
