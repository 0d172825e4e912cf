// What a jump of data does to the solution.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "system/model.h"

namespace sfdae::core {

class JumpRule {
 public:
  virtual ~JumpRule() = default;
  // The consistent values at the point, where data are those after the jump, for the values before it; the system stands
  // there afterwards. Throws Failure.
  virtual ConsistentPoint values_after(const PointOfInterest& before) = 0;
};

}  // namespace sfdae::core
