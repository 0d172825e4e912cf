// Rules for jumps of data and for singular points: values of the solution after them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "linalg/matrix.h"
#include "system/dae_system.h"
#include "system/jump.h"
#include "system/model.h"

namespace sfdae::core {

// Changes of E x at jumps of data that do not count, in tolerances: a thousand of them, as those of a staircase, add up
// to one tolerance. (Chosen.)
inline constexpr double negligible_jump = 1e-3;

class JumpRule {
 public:
  virtual ~JumpRule() = default;
  // Consistent values at the point, with data after the jump, from the values before it; the system is there
  // afterwards. Throws Failure.
  virtual ConsistentPoint values_after(const PointOfInterest& before) = 0;
  // The nearest consistent values with the same data, valid if no impulse is needed. The system is there afterwards.
  // Throws Failure.
  virtual ConsistentPoint values_near(const PointOfInterest& before) = 0;
  // The consistent point with data as before the jump; does not affect the integration. Throws Failure.
  virtual ConsistentPoint values_before(const PointOfInterest& before) = 0;
  // Derivatives of the values after the last jump, n x directions. False if the equations do not determine them. Throws
  // Failure.
  virtual bool differentiate(const MovingJump& jump, View after) = 0;

  // The values near those before if E x stays there within `none` tolerances, otherwise those after impulses.
  // tolerance: of a component, at this x. The system has these equations. Throws Failure.
  using Tolerance = std::function<double(int i, const double* x)>;
  ConsistentPoint values(const PointOfInterest& before, DaeSystem& system, const Tolerance& tolerance, double none);
};

// Rule for the continuation of a solution across a singular point.
class ContinuationRule {
 public:
  virtual ~ContinuationRule() = default;
  // Consistent values near the point, which lies after the singular one; does not affect the integration. Throws
  // Failure if there are none, or if the known characteristic values do not hold.
  virtual ConsistentPoint look_at(const PointOfInterest& point) = 0;
  // The same values; the system is there afterwards.
  virtual ConsistentPoint move_to(const PointOfInterest& point) = 0;
};

}  // namespace sfdae::core
