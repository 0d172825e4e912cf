// Positions near those given that fulfil the constraints.
//
// q moves by dq = P y. Each constraint is measured in units of its gradient there, c_i = g_i / |row i of g_q P|, which
// is, to first order, how far it is from holding: Gauss-Newton steps of least |y|, and where these do not help, as near
// singular configurations, steps that are damped (Levenberg-Marquardt), which does constraints no harm that depend on
// each other only where they hold.
//
// [NW06] J. Nocedal, S. J. Wright: Numerical Optimization. Springer, 2006, section 10.3.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/dense.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

class PositionSearch {
 public:
  // tolerance: of positions; what is far below it is as good as nothing.
  PositionSearch(MultibodyProblem& problem, double t, double tolerance);

  // All throw Failure for errors of callbacks that a smaller change cannot avoid.
  void move_to(const std::vector<double>& q);
  // Along columns of P. False if no positions near these are found that fulfil the constraints, in so many iterations.
  bool approach(const Matrix& P, int most);

  // With terms and rows at the positions reached.
  const MultibodyPoint& point() const { return point_; }
  const std::vector<double>& q() const { return point_.q; }
  bool holds_to_rounding() const { return positions_hold_to_rounding(point_); }
  // In units of the gradients.
  std::vector<double> residuals() const;
  // Whether no change, however small, makes residuals smaller.
  bool is_stationary(const Matrix& P) const;

 private:
  // g_q P, rows of length 1, and c.
  struct Linear {
    Matrix B;
    std::vector<double> units, c;
  };
  Linear linear_along(const Matrix& P) const;
  bool improve(const Matrix& P);
  double residual_at(const std::vector<double>& q, const std::vector<double>& units);

  MultibodyProblem& problem_;
  double tolerance_;
  MultibodyPoint point_;
};

// Gives rows length 1, where they do not vanish, and returns their lengths before.
std::vector<double> scale_rows(Matrix& A);
// Of singular values sorted by size: how many are larger than a part of the first.
int rank_of(const Svd& A, double part);

}  // namespace sfdae::core
