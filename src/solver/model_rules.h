// Rules of a solver's model for jumps of data and for singular points.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "integrate/jump_rule.h"

namespace sfdae::core {

struct Solver;

// Jumps of data at breakpoints: by impulses of the equations.
class JumpsOfModel final : public JumpRule {
 public:
  explicit JumpsOfModel(Solver& solver) : solver_(solver) {}
  ConsistentPoint values_after(const PointOfInterest& before) override;
  ConsistentPoint values_near(const PointOfInterest& before) override;
  ConsistentPoint values_before(const PointOfInterest& before) override;
  bool differentiate(const MovingJump& jump, View after) override;
  void forget() { last_.reset(); }

  struct Crossed {
    double t;
    std::vector<double> before, after, impulse;
  };
  const std::optional<Crossed>& last() const { return last_; }

 private:
  Solver& solver_;
  std::optional<Crossed> last_;
};

// Continuation across a singular point: the consistent values nearest to the smooth continuation.
class ContinuationOfModel final : public ContinuationRule {
 public:
  explicit ContinuationOfModel(Solver& solver) : solver_(solver) {}
  ConsistentPoint look_at(const PointOfInterest& point) override;
  ConsistentPoint move_to(const PointOfInterest& point) override;

 private:
  ModelOptions options() const;

  Solver& solver_;
};

}  // namespace sfdae::core
