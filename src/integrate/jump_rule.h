// What a jump of data does to the solution, and what carries it across a singular point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "system/model.h"

namespace sfdae::core {

class JumpRule {
 public:
  virtual ~JumpRule() = default;
  // The consistent values at the point, where data are those after the jump, for the values before it; the system
  // stands there afterwards. Throws Failure.
  virtual ConsistentPoint values_after(const PointOfInterest& before) = 0;
};

// What carries a solution across a singular point.
class ContinuationRule {
 public:
  virtual ~ContinuationRule() = default;
  // Consistent values near the point, which is after the singular one; nothing of the integration is disturbed. Throws
  // Failure where there are none, or where the characteristic values known do not hold.
  virtual ConsistentPoint look_at(const PointOfInterest& point) = 0;
  // The same, and the system stands there afterwards.
  virtual ConsistentPoint move_to(const PointOfInterest& point) = 0;
};

}  // namespace sfdae::core
