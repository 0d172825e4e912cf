// The equations of sensitivities at one point of x, in null-space form with a right-hand side for each parameter.
//
// The constraints are those of the derivative array along the jet: they depend on its derivatives only by factors of rows,
// as F_mu = 0 holds. The differential equations are Z1^T F(t, x, x') = 0 differentiated where x' is that of the solution or
// of its discretization: a jet of level mu leaves some derivatives open that F_x may contain.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "problem/parameter_series.h"
#include "reduction/null_space_form.h"
#include "system/analyzed_equations.h"
#include "system/consistent_values.h"
#include "system/jet.h"

namespace sfdae::core {

class SensitivityPoint {
 public:
  // With the ranks known; they are judged anew where they do not fit. xdot: x' for the differential equations, in the user's
  // units, or null: that of the jet.
  struct Place {
    const Jet& jet;
    const double* xdot;
    const RankSequence& known;
  };
  PointStatus linearize(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place, Arena& arena);

  // mu = 0 and no constraints: nothing is eliminated, T2 = Z1 = I and xp = 0, which are not formed.
  bool is_ordinary() const { return is_ordinary_; }
  // Of scaled unknowns: S = xp + T2 z and Z1^T (tau E S' - A S - f) = 0.
  double time_scale() const { return data_.time_scale; }
  int d() const { return is_ordinary_ ? data_.n : form_.d; }
  ConstView T2() const { return form_.T2(); }
  ConstView xp() const { return xp_; }
  ConstView ZE() const { return ZE_; }  // d x n
  ConstView ZA() const { return ZA_; }
  ConstView Zf() const { return Zf_; }  // d x count
  // S += T2 z with Z1^T E T2 z = q, E that of the jet.
  void add_along_T2(ConstView q, View S, Arena& arena) const;
  // Contradiction of redundant equations, relative.
  double inconsistency() const { return inconsistency_; }
  const CallbackError& callback_error() const { return callback_error_; }
  // The constraints for column j.
  ConstrainedPoint constraints_of(int j, const Units& units, Arena& arena);

 private:
  PointStatus reduce(AnalyzedEquations& equations, const RankSequence& known, Arena& arena);
  PointStatus reduce_by_judgement(AnalyzedEquations& equations, Arena& arena);
  PointStatus take_differential(AnalyzedEquations& equations, ParameterSeries& parameters, const Place& place);
  void resize();
  void take_column(int j, Arena& arena);

  TaylorData data_, slope_data_;
  NullSpaceForm form_;
  Matrix f_, f_hat_, slope_f_;  // (mu + 1) m x count; transformed by the elimination, Z^T f; of level 0 at x'
  Matrix xp_, ZE_, ZA_, Zf_;
  std::vector<double> slope_jet_;
  bool is_ordinary_ = false;
  int rank_E_ = 0;
  double kept_ = 1.0, inconsistency_ = 0.0;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
