// The equations of sensitivities at one point of x, in null-space form with a right-hand side for each parameter.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/parameter_series.h"
#include "reduction/stored_elimination.h"
#include "sensitivity/extended_sensitivity_step.h"
#include "sensitivity/linearized_point.h"
#include "starts/consistent_values.h"

namespace sfdae::core {

class SensitivityPoint final : public LinearizedPoint {
 public:
  // Matrices that are the same at all points are eliminated once, until forget().
  PointStatus linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);
  void forget() { constant_matrices_ = -1; }

  // Same by the minimal extension, which gives T2 and xp in place of an elimination: for steps alone, as there is no
  // form. Not possible: see there.
  PointStatus linearize(AnalyzedEquations& equations, ParameterSeries& parameters, ExtendedSensitivityStep& extension,
                        const Place& place, Arena& arena);

  ConstView xp() const { return xp_; }
  ConstView Zf() const { return Zf_; }  // d x count
  // S += T2 z with Z1^T E T2 z = q, E that of the jet.
  void add_along_T2(ConstView q, View S, Arena& arena) const;
  // Relative contradiction of redundant equations.
  double inconsistency() const { return inconsistency_; }
  // The constraints for column j.
  ConstrainedPoint constraints_of(int j, const Units& units, Arena& arena);

 private:
  PointStatus eliminate(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);
  PointStatus transform(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);
  void take_columns(Arena& arena);
  PointStatus take_right_hand_sides(ParameterSeries& parameters);
  void take_column(int j, Arena& arena);

  Matrix f_, f_hat_, slope_f_;  // (mu + 1) m x count; transformed by the elimination, Z^T f; of level 0 at x'
  Matrix level_0_f_;            // where nothing is eliminated
  Matrix xp_, Zf_;
  double inconsistency_ = 0.0;
  long constant_matrices_ = -1;  // those eliminated, as the problem numbers them; -1: none
  StoredElimination elimination_;
  std::vector<double> transformed_;
};

}  // namespace sfdae::core
