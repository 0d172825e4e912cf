// gamma and eta of a mechanical system, the rows of s, if its functions do not supply them.
//
// s = d/ds (C v + r) along (t + s, q + s S v) with v held: differences of nine points, separately in t and in q, so
// that limits of t do not affect systems that do not depend on it (docs/design/finite_differences.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_functions.h"
#include "problem/difference_comparison.h"
#include "problem/differences.h"

namespace sfdae::core {

// Size of component j, estimated from the vector.
double unit_of_component(const double* values, int count, int j);
// Time in which no position moves by more than its size in this direction; angles curve within 1.
double time_of_motion(const double* q, const std::vector<double>& direction);

// Increments of lowest-order differences along the motion, and in t before and after the point; 0: none.
struct MultibodyIncrements {
  double along, before, after;
};
// Reduces the wanted increments for limits of t and for independence of t.
MultibodyIncrements increments_at(double t, double along, double in_time, const MultibodyFunctions& functions);

class CurvatureDifferences {
 public:
  // functions: must outlive this object.
  explicit CurvatureDifferences(const MultibodyFunctions& functions);

  bool is_needed() const { return gamma_ || eta_; }
  // s += its rows that are not given. False if a callback fails.
  bool add(const MultibodyArguments& at, const Matrix& S, double* s, CallbackError& error);
  // Increments of lowest-order differences: this fraction of the accurate spacings of the last add.
  MultibodyIncrements rough_increments(double t, double part) const {
    return increments_at(t, part * good_step_, part * good_time_, functions_);
  }
  // s := these rows by differences of lowest order, 0 in others; direction: S v. False if a callback fails.
  bool rough(const MultibodyArguments& at, const std::vector<double>& direction, const MultibodyIncrements& steps,
             double* s, CallbackError& error);

 private:
  // A line from a point along (t_rate, q_rate direction).
  struct Line {
    double t_rate, q_rate;
    const std::vector<double>& direction;
    double step;          // between points on it, to begin with
    double below, above;  // room in both directions
  };

  bool residuals(const MultibodyArguments& at, double* values, CallbackError& error);
  bool residuals_beside(const MultibodyArguments& at, const Line& line, double offset, double* values,
                        CallbackError& error);
  bool improve(int shift, double step, double* derivative);
  bool differentiate(const MultibodyArguments& at, Line& line, double* derivative, CallbackError& error);

  const MultibodyFunctions& functions_;
  bool gamma_, eta_;  // are not given
  Matrix S_, g_q_, H_;
  std::vector<double> direction_;  // S v
  std::vector<double> shifted_q_, shifted_direction_;
  std::vector<DifferenceFormula> formulas_;   // by shift
  double good_step_ = 0.0, good_time_ = 0.0;  // spacings of the last differences along the motion and in t
  std::vector<double> samples_, values_, errors_, along_, in_time_;
};

}  // namespace sfdae::core
