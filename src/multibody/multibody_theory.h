// A mechanical system linearized at one point: the objects of the theory by its minimal extension.
//
//     F(t, x, x') = (q' - S v,  M v' - f + C^T mu,  g,  H v + h),   x = (q, v, mu)
//
// whose algebraic consequences are g = 0, C v + r = 0 and mu = mu(t, q, v), of least norm: independent rows of the
// first two.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, sec.
// 6.4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_ranks.h"
#include "reduction/derivative_array.h"
#include "system/jet.h"

namespace sfdae::core {

// The extended system, linearized: E X' = A X + f for changes of X = (x, wq, wv) and of X', with wq = Qq2^T q', wv =
// Qv2^T v'.
struct ExtendedSystem {
  Matrix Qq, Qv;          // [Q1 Q2] of positions and velocities
  Matrix E, A;            // square
  std::vector<double> f;  // residuals of the equations
  std::vector<double> w;  // (wq, wv)
};

class MultibodyTheory {
 public:
  // At (t, x); mu of x is used as the held value, not for mu(t, q, v). Throws Failure.
  MultibodyTheory(MultibodyProblem& problem, const MultibodySettings& settings, double t, const double* x);

  // (S v, a, mu'), with mu' by differences, or 0.
  std::vector<double> derivative(MultibodyProblem& problem);
  // A2 = -d/dx of the consequences, f2 their residuals: all rows of both.
  Matrix A2() const;
  Matrix f2(const double* mu) const;
  // max of |g| and |C v + r| over the other rows, which depend on those.
  double redundant_residual() const;
  // Orthonormal bases of ker A2, and of the range of F_x' there.
  Matrix T2() const;
  Matrix Z1() const;
  // positions, velocities: partitions, in use or chosen here.
  ExtendedSystem extended(const Partition& positions, const Partition& velocities, const double* x) const;

 private:
  void differentiate_forces(MultibodyProblem& problem);
  void add_redundant_part(MultibodyProblem& problem);
  int differential() const { return form_.unknowns(); }
  Matrix tangent() const;
  // Equations of the extended system from a row on.
  void write_kinematics(const Partition& positions, ExtendedSystem& to) const;
  void write_dynamics(const Partition& velocities, const double* mu, ExtendedSystem& to, int row) const;
  void write_constraints(const Partition& positions, const Partition& velocities, ExtendedSystem& to, int row) const;
  void write_accelerations(const Partition& velocities, ExtendedSystem& to, int row) const;
  void write_least_norm(const double* mu, ExtendedSystem& to, int row) const;

  MultibodySizes sizes_;
  Arena arena_;
  MultibodyPoint point_;  // with a, and mu of least norm
  MultibodyJacobian jacobian_;
  MultibodyForm form_;  // partitions chosen here
  Matrix mu_qv_;        // derivatives of mu(t, q, v) by (q, v)
};

// F, F_x', -F_x at (t, x, x') as the derivative array of level 0. Throws Failure.
DerivativeArray array_of_level_0(MultibodyProblem& problem, const Jet& jet);

}  // namespace sfdae::core
