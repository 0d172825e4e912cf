// Finite-difference Jacobian of the iterated residuals of a mechanical system.
//
// It affects convergence only, not the solution, so differences of lowest order suffice. As s is the derivative of C v
// + r along (1, S v) with v held, its derivative by v is dC/dt + (C v + r)_q S and needs no differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_curvature_differences.h"
#include "multibody/multibody_functions.h"

namespace sfdae::core {

class MultibodyDifferenceJacobian {
 public:
  // Both arguments must outlive this object.
  MultibodyDifferenceJacobian(MultibodyFunctions& functions, CurvatureDifferences& curvature);

  // With v' = a and mu held; terms: those of the state. False if a callback fails.
  bool evaluate(const MultibodyState& state, const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                CallbackError& error);

 private:
  // Residuals that the iteration solves for.
  struct Residuals {
    explicit Residuals(const MultibodySizes& sizes);
    std::vector<double> force;         // f - M a - C^T mu
    std::vector<double> acceleration;  // C a + s, without those parts of s that are differences
    std::vector<double> velocity;      // C v + r
    std::vector<double> kinematics;    // S v
  };
  // Point of the Jacobian, with the values that are held.
  struct Point {
    MultibodyArguments at;
    const double* a;
    const double* mu;
    MultibodyIncrements steps;  // of those parts of s that are differences
  };

  // These return false if a callback fails.
  bool residuals(const MultibodyArguments& at, const double* a, const double* mu, Residuals& result,
                 CallbackError& error);
  bool add_rate_of_C(const MultibodyArguments& at, const MultibodyIncrements& steps, View rate, CallbackError& error);
  // Moves component j to a value at which `evaluate` succeeds; returns the offset, or 0.
  template <class Evaluate>
  double move(const double* values, int j, std::vector<double>& moved, CallbackError& error, Evaluate evaluate);
  bool position_column(const Point& point, int j, MultibodyJacobian& jacobian, CallbackError& error);
  bool add_rough_column(const Point& point, int j, double offset, View column, CallbackError& error);
  bool velocity_column(const MultibodyArguments& at, int j, const std::vector<double>& forces, View force_v,
                       CallbackError& error);

  MultibodyFunctions& functions_;
  CurvatureDifferences& curvature_;
  MultibodyTerms probe_;           // at other points
  std::vector<double> direction_;  // S v
  std::vector<double> shifted_q_;
  Residuals base_, moved_;
  std::vector<double> moved_q_, moved_v_, rough_base_, rough_moved_;
};

}  // namespace sfdae::core
