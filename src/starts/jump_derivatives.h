// Derivatives of the values after a jump by impulses with respect to those before it, its time and parameters.
//
// With theta as in impulses.h the jump is F_mu(t, x, y) = 0 and R_p = sum_{j >= p} (E_{j-p} + A_{j-p-1} / j) theta_j
// = 0, theta_0 = x - x-. Along a direction (dt, dp, dx-)
//
//     dx = xp + x' dt + T2 z,   sum_{j >= p} (E_{j-p} + A_{j-p-1} / j) dtheta_j + R_p,x dx + R_p,p dp + R_p,t dt = 0,
//       dtheta_0 = dx - dx-
//
// with xp of the differentiated derivative array: one least squares problem for z, dtheta_1, ..., dtheta_mu, with all
// directions as right-hand sides. The result has to hold with the coefficients of other jets, too, as the jump itself
// has to (nonlinear_jump.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "problem/impulse_slopes.h"
#include "problem/parameter_series.h"
#include "starts/impulses.h"
#include "starts/linearized_constraints.h"

namespace sfdae::core {

class JumpDerivatives {
 public:
  JumpDerivatives(RecordedProblem& problem, std::vector<int> parameters);

  const std::vector<int>& parameters() const { return parameters_; }
  // after: derivatives of the values after it, n x directions. at: a jet consistent up to level mu with these values.
  // False if no derivative is certain to be right. Throws Failure if the equations cannot be evaluated, or the jump
  // cannot be solved for.
  bool find(const LinearizedConstraints::Known& known, const Jet& at, const MovingJump& moving, View after);

 private:
  struct Solution;
  struct Slopes;
  struct Motion;
  bool solve_jump(const LinearizedConstraints::Known& known, const MovingJump& moving,
                  LinearizedConstraints& constraints, Solution& solution);
  bool find_slopes(const LinearizedConstraints::Known& known, const Solution& at, const MovingJump& moving,
                   Slopes& slopes);
  bool find_particular(const Solution& at, const MovingJump& moving, LinearizedConstraints& constraints, View dx);
  bool holds_aside(const LinearizedConstraints::Known& known, const Solution& at, const MovingJump& moving,
                   const Motion& motion);

  RecordedProblem& problem_;
  std::vector<int> parameters_;
  ParameterSeries series_;
  ImpulseSlopes formulas_;
  Arena arena_;
};

}  // namespace sfdae::core
