// The strangeness-free system of a mechanical system, linearized at one point, in local coordinates.
//
//     Q_q1^T (q' - S v) = 0,  Q_v1^T (v' - a(t, q, v)) = 0,  g = 0,  C v + r = 0
//
// With (y, z) = (Q_q1^T q, Q_v1^T v) and the T and N of the constraints, changes that solve the linearized
// constraints are
//
//     dq = T_q y - N_q g,   dv = T_v z - N_v (C v + r + (C v + r)_q dq)
//
// and the differential equations become (y, z)' = B (y, z) + ...: steps solve for d unknowns, with matrices c I - B.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "multibody/multibody_partition.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_tangent.h"

namespace sfdae::core {

class MultibodyForm {
 public:
  // Allocates memory for these sizes, and the ranks of g_q and C.
  void resize(const MultibodySizes& sizes, int position_rank, int velocity_rank);
  // Tolerance of rank decisions; 0: by rounding errors.
  void set_rank_tol(double rank_tol) { positions_.rank_tol = velocities_.rank_tol = rank_tol; }

  int unknowns() const { return dq_ + dv_; }
  const Partition& positions() const { return positions_; }
  const Partition& velocities() const { return same_rows_ ? positions_ : velocities_; }
  const Tangents& tangents() const { return tangents_; }
  // Q_v1^T a_q, Q_v1^T a_v and (C v + r)_q at the linearization; the last may be identically zero.
  ConstView A_q() const { return A_q_; }
  ConstView A_v() const { return A_v_; }
  ConstView velocity_q() const { return velocity_q_; }
  bool has_velocity_q() const { return has_velocity_q_; }
  void resize_tangents(Tangents& tangents) const;

  // New partitions at the point, and the ranks found.
  struct Ranks {
    RankDecision positions, velocities;
  };
  Ranks choose(const MultibodyPoint& point, Coordinates coordinates, Arena& arena);
  // Finds the row of C that depends most on the others at the point, and its independent part, in units of its length.
  void judge(const MultibodyPoint& point, Arena& arena, int& row, double& rest) const;
  // T and N at a point; false if the partition does not fit it at all.
  bool build_tangents(const MultibodyPoint& point, Tangents& tangents, Arena& arena) const;
  // N alone at a point; false if the partition does not fit it at all.
  bool fit_tangents(const MultibodyPoint& point, Tangents& tangents, Tangent::Uses uses = Tangent::Uses::many) const;
  // Same for the point of the linearization.
  bool build_tangents(const MultibodyPoint& point, Arena& arena) { return build_tangents(point, tangents_, arena); }
  // B, after build_tangents; point: K factored there, a and mu known.
  void build(const MultibodyPoint& point, const MultibodyJacobian& jacobian, Arena& arena);

  // M := c I - B
  template <class Scalar>
  void step_matrix(Scalar c, BasicView<Scalar> M) const {
    for (int j = 0; j < unknowns(); ++j) {
      for (int i = 0; i < unknowns(); ++i) M(i, j) = -B_(i, j);
      M(j, j) += c;
    }
  }
  // True if y' = z, as S is the identity: B = [0 I; K D] except for rounding errors.
  bool has_velocities_as_rates() const { return same_rows_; }
  ConstView stiffness() const { return B_.view().block(dq_, 0, dv_, dq_); }
  // M := c I - D - K / c
  template <class Scalar>
  void reduced_step_matrix(Scalar c, BasicView<Scalar> M) const {
    const Scalar inverse = 1.0 / c;
    for (int j = 0; j < dv_; ++j) {
      const double *const K = B_.view().column(j) + dq_, *const D = B_.view().column(dq_ + j) + dq_;
      for (int i = 0; i < dv_; ++i) M(i, j) = -(D[i] + K[i] * inverse);
      M(j, j) += c;
    }
  }
  // Computes (y, z) of (q, v).
  void project(const double* qv, double* yz) const;
  // Changes of the independent mu that belong to changes of q and v, a column for each.
  void forces(ConstView changes, View mu) const;
  // Computes (y, z) of (q, v), a column for each point.
  void project(ConstView qv, View yz) const;
  // dq, dv := -N (residuals), both residuals complete, N from some point nearby.
  struct Residuals {
    const double* g;
    const double* velocity;
  };
  void particular(const Tangents& tangents, const Residuals& residuals, double* qv, Arena& arena) const;
  // rates := S v + S dv + (S v)_q dq for such changes of q and v at the point
  void moved_rates(const MultibodyPoint& point, const double* change, double* rates, Arena& arena) const;
  // yz := Q_q1^T rates and Q_v1^T (a + a_q dq + a_v dv), a column for each point.
  void rates(ConstView rates, ConstView a, ConstView changes, View yz) const;
  // qv := (T_q y, T_v z - N_v (C v + r)_q T_q y), a column for each point; T and N from these points.
  void expand(const Tangents* tangents, ConstView yz, View qv, Arena& arena) const;
  // qv := (T_q y, T_v z - N_v (C v + r)_q T_q y), a column for each point; T and N from the linearization.
  void expand(ConstView yz, View qv) const;

 private:
  void differentiate_accelerations(const MultibodyPoint& point, const MultibodyJacobian& jacobian, Arena& arena);

  MultibodySizes sizes_;
  bool same_rows_ = false;  // one set of rows on both levels: S the identity, no nonholonomic constraints
  int dq_ = 0, dv_ = 0;
  Partition positions_, velocities_;
  Tangents tangents_;
  Matrix velocity_q_, kinematics_q_;  // of the Jacobian
  bool has_velocity_q_ = false;
  Matrix Z_, A_q_, A_v_, B_;  // nv x dq; Q_v1^T a_q, Q_v1^T a_v
  Matrix mu_q_, mu_v_;        // of the independent rows
};

}  // namespace sfdae::core
