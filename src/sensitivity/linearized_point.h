// The equations linearized at one point of x, in null-space form: common base of sensitivities and their adjoints.
//
// The constraints are those of the derivative array along the jet: they depend on its derivatives only by factors of
// rows, as F_mu = 0 holds. The differential equations are Z1^T F(t, x, x') = 0 differentiated at the x' of the solution
// or of its discretization, as a jet of level mu may leave derivatives undetermined that F_x contains.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "problem/parameter_series.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "system/jet.h"

namespace sfdae::core {

class LinearizedPoint {
 public:
  // Uses the known ranks, which are decided again if they do not fit. xdot: x' for the differential equations, in the
  // user's units, or null: that of the jet.
  struct Place {
    const Jet& jet;
    const double* xdot;
    const RankSequence& known;
  };

  // mu = 0 and no constraints: nothing is eliminated, T2 = Z1 = I and xp = 0, which are not formed.
  bool is_ordinary() const { return is_ordinary_; }
  // Known before any linearization.
  void take_kind(const AnalyzedEquations& equations);
  // In scaled unknowns: S = xp + T2 z and Z1^T (tau E S' - A S - f) = 0.
  double time_scale() const { return data_.time_scale; }
  int d() const { return is_ordinary_ ? data_.n : has_tangents_ ? tangents_.cols() : form_.d; }
  ConstView T2() const { return has_tangents_ ? ConstView(tangents_) : form_.T2(); }
  ConstView ZE() const { return ZE_; }  // d x n
  ConstView ZA() const { return ZA_; }
  const CallbackError& callback_error() const { return callback_error_; }

 protected:
  // The derivative array along the jet.
  PointStatus evaluate(AnalyzedEquations& equations, const Jet& jet);
  // f: right-hand sides of the derivative array, at least one column; f_hat: these after the elimination. store: null,
  // or receives the elimination.
  struct Reduced {
    ConstView f;
    Matrix& f_hat;
    StoredElimination* store;
  };
  PointStatus reduce(AnalyzedEquations& equations, const RankSequence& known, const Reduced& reduced, Arena& arena);
  // Level 0 alone, with the directions that the constraints admit in tangents_, scaled: Z1 is a basis of E times these,
  // as with the elimination.
  PointStatus evaluate_along_tangents(AnalyzedEquations& equations, const Jet& jet, Arena& arena);
  ConstView Z1() const { return has_tangents_ ? ConstView(Z1_) : form_.Z1(); }
  // E and A of F1. If they contain x', and the place has one of its own, they come from slope_data_.
  PointStatus take_differential(AnalyzedEquations& equations, const Place& place, const ParameterSeries& parameters);
  // Takes the place's own x and x' for all other terms with x'.
  void take_slopes(const Place& place, const ParameterSeries& parameters);
  const TaylorData& differential_data() const { return has_slope_data_ ? slope_data_ : data_; }

  TaylorData data_, slope_data_;
  std::vector<double> slope_jet_;  // x and x' of its own
  bool has_slopes_ = false, has_slope_data_ = false;
  NullSpaceForm form_;
  int rank_E_ = 0;
  double kept_ = 1.0;
  Matrix tangents_;            // n x d; of points evaluated along these
  bool has_tangents_ = false;  // else of the form
  CallbackError callback_error_;

 private:
  PointStatus reduce_by_judgement(AnalyzedEquations& equations, const Reduced& reduced, Arena& arena);

  Matrix ZE_, ZA_, Z1_;
  bool is_ordinary_ = false;
};

}  // namespace sfdae::core
