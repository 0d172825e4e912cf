// The balance of forces of a mechanical system, f - M a - C^T mu with a and mu held, and its derivatives.
//
// a and mu are parameters, so that the backward sweep meets only nodes that depend on q and v.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "multibody/multibody_formulas.h"
#include "multibody/multibody_problem.h"

namespace sfdae::core {

class RecordedBalance {
 public:
  RecordedBalance(Recorder& recorder, const MultibodyFormulas& formulas, bool has_kinematics, bool is_rheonomic);

  // Derivatives by q and v at the state; false if they cannot be evaluated at error.t. Those of g_q^T lambda are left
  // to subtract_curvature. jet: of (q, v), to first order.
  bool differentiate(const double* jet, const MultibodyState& state, const MultibodyTerms& terms,
                     MultibodyJacobian& jacobian, CallbackError& error);
  // force_q -= S^T (lambda^T g)_qq, with lambda of the last differentiate.
  bool subtract_curvature(const double* q, const MultibodyTerms& terms, View force_q, CallbackError& error);

  // The first parameters become those of another evaluator.
  void copy_parameters(const TaylorEvaluator& from, int count);

 private:
  // Parameters whose values are those of a vector that is held.
  struct Held {
    std::vector<int> a, kappa, p, lambda;  // indices of parameters
  };

  MultibodySizes sizes_;
  bool has_kinematics_, is_rheonomic_;
  std::optional<TaylorEvaluator> balance_, curvature_;  // what the balance depends on; lambda^T g
  Held held_;
  std::vector<int> curved_;  // j where lambda^T g is not linear in q_j
  std::vector<double> q_jet_;
  std::vector<double> reactions_, in_time_;  // p = g_q^T lambda; first coefficients that come from t + s
  std::vector<double> gradients_, curvature_gradients_;
};

}  // namespace sfdae::core
