// A mechanical system given by the user's functions, differentiated where necessary.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_curvature_differences.h"
#include "multibody/multibody_difference_jacobian.h"
#include "multibody/multibody_functions.h"
#include "multibody/multibody_problem.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

class CallbackMultibody final : public MultibodyProblem {
 public:
  explicit CallbackMultibody(const sfdae_multibody_problem& problem);

  bool has_kinematics() const override { return functions_.has_kinematics(); }
  CallbackError constraints(double t, const double* q, double* g) override;
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override;
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override;
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override;
  void check_rates(double t, const double* q) override;
  // The terms that checks of derivatives compare: g, S, g_q, C, r, and the given parts of s.
  CallbackError constraint_terms(double t, const double* q, const double* v, MultibodyTerms& terms);

  const sfdae_multibody_problem& functions() const { return functions_.given(); }

 private:
  MultibodyFunctions functions_;
  CurvatureDifferences curvature_;
  MultibodyDifferenceJacobian jacobian_;
};

}  // namespace sfdae::core
