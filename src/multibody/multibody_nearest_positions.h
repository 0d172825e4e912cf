// Positions on the constraints nearest to given ones.
//
// Measured by y in q = given + P y; |y|^2 / 2 + f^T g is stationary there, with forces f of the constraints. A trust
// region method along the constraints finds them, each step of which ends with a return to the constraints. Steps are
// computed by conjugate gradients; second derivatives of g are differences of g_q (docs/design/multibody.md).
//
// [NW06] J. Nocedal, S. J. Wright: Numerical Optimization. Springer, 2006, algorithms 4.1 and 7.2.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_metric.h"
#include "multibody/multibody_position_search.h"

namespace sfdae::core {

class NearestPositions {
 public:
  // search: at positions that fulfil the constraints; this object moves it.
  NearestPositions(MultibodyProblem& problem, const std::vector<double>& given, const PositionMetric& metric,
                   PositionSearch& search);

  // Moves the search to the nearest positions, or as near as possible. Throws Failure as the search does.
  void approach();

 private:
  // A step along the constraints, and the decrease of |y|^2 / 2 to second order.
  struct Step {
    std::vector<double> y;
    double expected = 0.0;
  };
  void linearize();
  std::vector<double> forces() const;
  std::vector<double> open_part(const std::vector<double>& w) const;
  std::vector<double> bend(const std::vector<double>& forces, const std::vector<double>& w);
  Step step_within(double radius, const std::vector<double>& open);
  double gain_of(const Step& step);
  std::vector<double> change() const;

  MultibodyProblem& problem_;
  const std::vector<double>& given_;
  const PositionMetric& metric_;
  PositionSearch& search_;
  std::vector<double> y_;
  Svd B_;  // g_q P, rows of length 1
  int rank_ = 0;
  std::vector<double> units_;  // the lengths of the rows before
  MultibodyTerms beside_;
};

}  // namespace sfdae::core
