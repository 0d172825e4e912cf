// A mechanical system given by recorded formulas.
//
// Along q(t + s) = q + q_1 s + q_2 s^2 with q_1 = S v and 2 q_2 = S a + (dS/dt) v the constraints are
// g + g_1 s + g_2 s^2 with g_1 = G v + g_t and 2 g_2 = G a + gamma: without a, g_2 gives gamma. As the derivative of
// g_k by q_j is (g_q)_(k-j), Taylor coefficients of g_q are all that an iteration's Jacobian needs of the
// constraints (docs/design/multibody.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "multibody/multibody_formulas.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_recorded_balance.h"
#include "multibody/multibody_recorded_lanes.h"
#include "multibody/multibody_recorded_terms.h"
#include "problem/nonlinear_problem.h"

namespace sfdae::core {

class RecordedMultibody final : public MultibodyProblem {
 public:
  // The recorder cannot be used afterwards.
  RecordedMultibody(Recorder& recorder, MultibodyFormulas formulas);
  // A copy shares the recording.
  RecordedMultibody(const RecordedMultibody&) = default;

  bool has_kinematics() const override { return kinematics_.has_value(); }
  CallbackError constraints(double t, const double* q, double* g) override;
  bool constraints_on_both_levels(const MultibodyLevels& at, CallbackError& error) override;
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override;
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override;
  bool has_lanes() const override { return !kinematics_ && !nonholonomic_; }
  void prepare_lanes(MultibodyLaneTerms& terms) override { lanes_.prepare(formulas_of_lanes(), terms); }
  bool at_velocities(int count, const LaneBlock* t, const LaneBlock* qv, MultibodyLaneTerms& terms) override;
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override;
  TaylorEvaluator* evaluator() override { return &terms_.evaluator(); }
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() const override;
  void parameters_changed() override;
  int num_parameters() const { return num_parameters_; }
  // first_order_equations() of multibody_formulas.h, with the present values of parameters.
  std::unique_ptr<RecordedProblem> first_order_problem();
  std::shared_ptr<const Record> first_order_record() const;

 private:
  void allocate();
  RecordedLanes::Formulas formulas_of_lanes() const {
    return {terms_, constraints_ ? &*constraints_ : nullptr, sizes().positions, rheonomic_};
  }

  // An error with the time t set.
  CallbackError begin(double t) const;
  // Sets the jets, with v_1 (null: 0); q_2 = (dS/dt v + S v_1) / 2 remains to be computed if S is not the identity.
  void set_jet(const double* q, const double* v, const double* v_1, const MultibodyTerms& terms);
  // g, g_q, G and g_t along q_jet_, order 2; or with q_1 = 0, lower orders.
  bool evaluate_constraints(int order, MultibodyTerms& terms, CallbackError& error);

  bool linearize_kinematics(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);
  bool linearize_holonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);
  bool linearize_nonholonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian, CallbackError& error);

  int num_parameters_;      // the user's
  bool rheonomic_ = false;  // g depends on t
  RecordedTerms terms_;     // M, S, H, h, f
  RecordedLanes lanes_;
  // g; S v; H v + h.
  std::optional<TaylorEvaluator> constraints_, kinematics_, nonholonomic_;
  std::optional<RecordedBalance> balance_;  // there from the end of the constructor on
  struct Recording {
    Recorder recorder;
    MultibodyFormulas formulas;
  };
  std::shared_ptr<const Recording> recording_;  // the formulas
  std::vector<double> q_jet_;                   // nq x 4
  std::vector<double> jet_;                     // of (q, v): (nq + nv) x 3
  std::vector<double> g_jet_;                   // nl x 3
  std::vector<double> rates_;                   // S v or H v + h, and their first coefficients
  std::vector<double> gradients_;
  Matrix rate_q_, rate_v_;  // derivatives of 2 q_2 by q and v
};

}  // namespace sfdae::core
