// A mechanical system with constraints: source of its matrices and their derivatives.
//
// Folder multibody: all parts of mechanical systems, from problem to model.
//
//     q' = S v,   M v' = f - C^T mu,   0 = g(t, q),   0 = C v + r,   0 = C v' + s
//
// with C = [g_q S; H], mu = (lambda, kappa), r = (g_t, h) and s = (gamma, eta), the last two rows of constraints
// being those on the levels of velocities and accelerations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/format.h"
#include "linalg/matrix.h"
#include "multibody/multibody_lane_terms.h"
#include "problem/problem.h"

namespace sfdae::core {

struct MultibodySizes {
  int positions = 0;     // nq
  int velocities = 0;    // nv
  int holonomic = 0;     // nl
  int nonholonomic = 0;  // nk
  int constraints() const { return holonomic + nonholonomic; }
  int unknowns() const { return positions + velocities + constraints(); }
};

// Terms at (t, q): all except f and s; at (t, q, v): these, too.
struct MultibodyTerms {
  explicit MultibodyTerms(const MultibodySizes& sizes = {});
  Matrix M;    // nv x nv
  Matrix S;    // nq x nv, from the first evaluation on; empty where it is the identity
  Matrix g_q;  // nl x nq
  Matrix C;    // (nl + nk) x nv
  std::vector<double> g, f;
  std::vector<double> velocity_rest;      // r
  std::vector<double> acceleration_rest;  // s
  const void* whose_numbers = nullptr;    // entries that are numbers are known already: those of this object
};

// A point with accelerations and forces of constraints: those of the motion through it, or held values.
struct MultibodyState {
  double t;
  const double* q;
  const double* v;
  const double* a;
  const double* mu;
};

// Derivatives by q and v of the iterated residuals, with v' = a and mu held.
struct MultibodyJacobian {
  explicit MultibodyJacobian(const MultibodySizes& sizes = {});
  Matrix force_q, force_v;                // of f - M a - C^T mu: nv x nq, nv x nv
  Matrix acceleration_q, acceleration_v;  // of C a + s: (nl + nk) x nq, (nl + nk) x nv
  Matrix velocity_q;                      // of C v + r: (nl + nk) x nq
  Matrix kinematics_q;                    // of S v: nq x nq, empty where S is the identity
};

// g and C v + r at (t, q, v), one below the other, and g_q, null if it is not wanted.
struct MultibodyLevels {
  double t;
  const double* q;
  const double* v;
  double* residuals;
  Matrix* g_q;
};

class MultibodyProblem : public Problem {
 public:
  virtual ~MultibodyProblem() = default;

  const MultibodySizes& sizes() const { return sizes_; }
  // Name in messages: "holonomic constraint 1 (length of the rod)". Names of equations are those of constraints.
  std::string name_of_constraint(int row) const {
    const bool is_holonomic = row < sizes_.holonomic;
    return equation_names().appended_to(format("%s constraint %d", is_holonomic ? "holonomic" : "nonholonomic",
                                               is_holonomic ? row : row - sizes_.holonomic),
                                        row);
  }
  virtual bool has_kinematics() const = 0;  // S is not the identity

  // g alone.
  virtual CallbackError constraints(double t, const double* q, double* g) = 0;
  // g and C v + r together, with g_q unless that is null; false: not available, as S is not the identity, there are
  // nonholonomic constraints, or the problem does not implement it.
  virtual bool constraints_on_both_levels(const MultibodyLevels& /*at*/, CallbackError& /*error*/) { return false; }
  // All terms except f and s.
  virtual CallbackError at_position(double t, const double* q, MultibodyTerms& terms) = 0;
  // All terms.
  virtual CallbackError at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) = 0;
  // has_lanes: several points can be evaluated at once. The others give the sizes of terms, and their values at the
  // points of the first `count` lanes. False if that fails: evaluation point by point gives the reason.
  virtual bool has_lanes() const { return false; }
  virtual void prepare_lanes(MultibodyLaneTerms&) {}
  virtual bool at_velocities(int, const LaneBlock*, const LaneBlock*, MultibodyLaneTerms&) { return false; }
  // terms: those at (t, q, v).
  virtual CallbackError linearize(const MultibodyState& state, const MultibodyTerms& terms,
                                  MultibodyJacobian& jacobian) = 0;

  // The constraint that depends most on the others there.
  std::string about_singular_point(double t, const double* x) override;

  // Throws Failure if g turns out to depend on t though its derivative by t was not given.
  virtual void check_rates(double, const double*) {}

  // Evaluator with the parameters of recorded formulas; call parameters_changed() after a change there.
  virtual TaylorEvaluator* evaluator() { return nullptr; }
  virtual std::vector<const TaylorEvaluator*> evaluators_of_inputs() const { return {}; }
  virtual void parameters_changed() {}

  long evaluations() const { return evaluations_; }
  long linearizations() const { return linearizations_; }

 protected:
  explicit MultibodyProblem(const MultibodySizes& sizes) : sizes_(sizes) {}
  long evaluations_ = 0, linearizations_ = 0;

 private:
  MultibodySizes sizes_;
};

}  // namespace sfdae::core
