// Positions near given ones that fulfil the constraints.
//
// q moves by dq = P y. Each constraint is measured in units of its gradient there, c_i = g_i / |row i of g_q P|, its
// distance to first order. Steps are Gauss-Newton steps of least |y|, or, if these fail, as near singular
// configurations, damped ones (Levenberg-Marquardt), which also suit constraints that depend on each other only where
// they hold.
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
  // tolerance: of positions; values far below it are negligible.
  PositionSearch(MultibodyProblem& problem, double t, double tolerance);

  // All functions throw Failure for errors of callbacks that a smaller change cannot avoid.
  void move_to(const std::vector<double>& q);
  // Moves along columns of P. False if at most `most` iterations do not find positions nearby that fulfil the
  // constraints.
  bool approach(const Matrix& P, int most);

  // The present point, with terms and rows.
  const MultibodyPoint& point() const { return point_; }
  const std::vector<double>& q() const { return point_.q; }
  bool holds_to_rounding() const { return positions_hold_to_rounding(point_); }
  // In units of the gradients.
  std::vector<double> residuals() const;
  // Returns whether no change, however small, reduces residuals.
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

// Scales nonzero rows to length 1, and returns their former lengths.
std::vector<double> scale_rows(Matrix& A);
// Number of singular values, sorted by size, that are larger than a fraction of the first.
int rank_of(const Svd& A, double part);

}  // namespace sfdae::core
