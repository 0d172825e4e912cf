// The user's functions of a mechanical system: called, checked, counted, differentiated where necessary.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_problem.h"
#include "problem/differences.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

MultibodySizes sizes_of(const sfdae_multibody_problem& problem);

class CallbackMultibody final : public MultibodyProblem {
 public:
  explicit CallbackMultibody(const sfdae_multibody_problem& problem);

  bool has_kinematics() const override { return functions_.kinematics != nullptr; }
  CallbackError constraints(double t, const double* q, double* g) override;
  CallbackError at_position(double t, const double* q, MultibodyTerms& terms) override;
  CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) override;
  CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                          MultibodyJacobian& jacobian) override;
  void check_rates(double t, const double* q) override;

  const sfdae_multibody_problem& functions() const { return functions_; }

 private:
  struct Point {
    double t;
    const double* q;
    const double* v;
  };
  // A line from a point along (t_rate, S v).
  struct Line {
    double t_rate, q_rate;
    double step;          // between points on it, to begin with
    double below, above;  // room in both directions
  };
  // What an iteration solves.
  struct Residuals {
    explicit Residuals(const MultibodySizes& sizes);
    std::vector<double> force;         // f - M a - C^T mu
    std::vector<double> acceleration;  // C a + s, without those parts of s that are differences
    std::vector<double> velocity;      // C v + r
    std::vector<double> kinematics;    // S v
  };
  // Of low-order differences along the motion and in t.
  struct Increments {
    double along, before, after;
  };
  // Where a Jacobian is wanted, with what is held.
  struct LinearizationPoint {
    Point at;
    const double* a;
    const double* mu;
    Increments steps;
  };

  // These return false if a callback fails.
  template <class Call>
  bool checked(const char* name, double t, View result, CallbackError& error, Call call);
  bool call(const char* name, sfdae_position_function function, const Point& at, View result, CallbackError& error);
  bool call(const char* name, sfdae_velocity_function function, const Point& at, View result, CallbackError& error);
  bool evaluate_mass(const Point& at, Matrix& M, CallbackError& error);
  // S, g_q, C, r.
  bool evaluate_constraints(const Point& at, MultibodyTerms& terms, CallbackError& error);
  // Those parts of s that are given.
  bool evaluate_curvatures(const Point& at, double* s, CallbackError& error);

  bool needs_differences() const { return gamma_by_differences_ || eta_by_differences_; }
  bool may_depend_on_time() const {
    return functions_.constraint_rate != nullptr || has_kinematics() || functions_.nonholonomic_matrix != nullptr;
  }
  void velocity_of(const Matrix& S, const double* v, double* velocity) const;
  // Those rows of C v + r whose derivatives along the motion are not given; 0 in others.
  bool undifferentiated(const Point& at, double* values, CallbackError& error);
  bool at_offset(const Point& at, const Line& line, double offset, double* values, CallbackError& error);
  bool improve(int shift, double step, double* derivative);
  // line.step becomes the spacing that was good.
  bool differentiate(const Point& at, Line& line, double* derivative, CallbackError& error);
  bool add_differences(const Point& at, const MultibodyTerms& terms, double* s, CallbackError& error);
  double step_along_motion(const double* q) const;

  // Size of a component, as far as it can be told from the vector.
  static double unit_of(const double* values, int count, int j);
  static double unit_of_time(double t);

  // For columns of the Jacobian.
  bool residuals(const Point& at, const double* a, const double* mu, Residuals& result, CallbackError& error);
  Increments increments(double t, double along, double in_time) const;
  // Low-order differences in place of add_differences.
  bool rough_rest(const Point& at, const Increments& steps, double* s, CallbackError& error);
  bool add_rate_of_C(const Point& at, const Increments& steps, View rate, CallbackError& error);
  // Moves component j to where `evaluate` succeeds; returns by how much, or 0.
  template <class Evaluate>
  double move(const double* values, int j, std::vector<double>& moved, CallbackError& error, Evaluate evaluate);
  bool position_column(const LinearizationPoint& point, int j, MultibodyJacobian& jacobian, CallbackError& error);
  bool add_rough_column(const LinearizationPoint& point, int j, double offset, View column, CallbackError& error);
  bool velocity_column(const Point& at, int j, const std::vector<double>& forces, View force_v, CallbackError& error);

  sfdae_multibody_problem functions_;
  bool gamma_by_differences_, eta_by_differences_;
  Matrix H_;
  MultibodyTerms probe_;           // at other points
  std::vector<double> direction_;  // S v
  std::vector<double> shifted_q_, shifted_direction_;
  std::vector<DifferenceFormula> formulas_;   // by shift
  double good_step_ = 0.0, good_time_ = 0.0;  // spacings of the last differences along the motion and in t
  std::vector<double> samples_, values_, errors_, along_, in_time_;
  Residuals base_, moved_;
  std::vector<double> moved_q_, moved_v_, rough_base_, rough_moved_;
};

}  // namespace sfdae::core
