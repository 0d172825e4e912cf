// What a jump of data does to the solution, and what carries it across a singular point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "linalg/matrix.h"
#include "system/dae_system.h"
#include "system/jump.h"
#include "system/model.h"

namespace sfdae::core {

class JumpRule {
 public:
  virtual ~JumpRule() = default;
  // The consistent values at the point, where data are those after the jump, for the values before it; the system
  // stands there afterwards. Throws Failure.
  virtual ConsistentPoint values_after(const PointOfInterest& before) = 0;
  // The consistent values nearest to those before it, with the same data: what they are where no impulse is needed. The
  // system stands there afterwards. Throws Failure.
  virtual ConsistentPoint values_near(const PointOfInterest& before) = 0;
  // The consistent point there, with data as they are before the jump; nothing of an integration is disturbed. Throws
  // Failure.
  virtual ConsistentPoint values_before(const PointOfInterest& before) = 0;
  // How the values after the last jump move, n x directions. False where the equations do not say it. Throws Failure.
  virtual bool differentiate(const MovingJump& jump, View after) = 0;

  // The values near those before where E x can stay, else those after impulses. tolerance: of a component, at this x.
  // The system is that of these equations. Throws Failure.
  using Tolerance = std::function<double(int i, const double* x)>;
  ConsistentPoint values(const PointOfInterest& before, DaeSystem& system, const Tolerance& tolerance);
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
