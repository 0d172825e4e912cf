// The stages of an implicit Runge-Kutta step for the extension with few states: Newton's method, with the equations
// linearized at each stage.
//
// With the states x_j held, the equations of stage i determine all other unknowns and the slopes x_j': H_i is the matrix with the
// states held, T_i = -H_i^-1 (derivatives by the states) says what moves with them, and its rows B_i of the slopes leave
//
//    sum_k D_ik / h dz_k - B_i dz_i = slopes of H_i^-1 r_i,
//
// s d equations for the changes dz of the states of all stages, which are solved as they are. One linearization for all stages
// (extension_stages.h) has to be solved with s (n + sum c) unknowns, and contracts slowly where the solution turns within a step,
// as those of mechanisms do (docs/decisions/62-stages-with-few-states.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/extension_linearization.h"
#include "extension/minimal_extension.h"
#include "linalg/matrix.h"
#include "linalg/recorded_elimination.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class LocalStages {
 public:
  explicit LocalStages(MinimalExtension& extension) : extension_(extension) {}

  // Few states among not too many equations.
  bool is_of_use(int s) const;
  // At the jets of all stages, with the states of `linearization`. Not ok: the error, or `singular`.
  PointStatus linearize(const StageEquations& equations, const std::vector<Jet>& jets,
                        ExtensionLinearization& linearization, CallbackError& error);
  // r: residuals times -1 by rows, a column for each stage; becomes the changes by slots, those of x_j in place of x_j' of the
  // states.
  void solve(View r);
  // T of the last stage: by slots, a column for each state.
  ConstView end_tangents() const { return tangents(s_ - 1); }

 private:
  bool choose_pivots(const StateChoice& choice);
  bool take_pivots(const ExtensionLinearization& linearization);
  bool factor(int stage, const StateChoice& choice, const ExtensionDerivatives& derivatives);
  void make_tangents(int stage, const StateChoice& choice);
  bool factor_coupled(const StageEquations& equations);
  ConstView tangents(int stage) const {
    return {tangents_.data() + index(stage) * index(q_) * index(d_), q_, d_, q_ > 0 ? q_ : 1};
  }
  double* factors(int stage) { return factors_.data() + index(stage) * elimination_.fill(); }

  MinimalExtension& extension_;
  int s_ = 0, q_ = 0, d_ = 0;
  RecordedElimination elimination_;
  long pivots_of_ = -1;  // the number of the linearization whose pivots they are
  std::vector<int> slope_slots_;
  std::vector<double> values_, factors_, tangents_;
  std::vector<double> coupled_, z_;  // s d equations
  std::vector<int> pivots_;
};

}  // namespace sfdae::core
