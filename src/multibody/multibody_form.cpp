// The strangeness-free system of a mechanical system, linearized at one point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_form.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void MultibodyForm::resize(const MultibodySizes& sizes, int position_rank, int velocity_rank) {
  const int nq = sizes.positions, nv = sizes.velocities, nl = sizes.holonomic, nc = sizes.constraints();
  sizes_ = sizes;
  dq_ = nq - position_rank;
  dv_ = nv - velocity_rank;
  positions_.resize(nq, nl);
  velocities_.resize(nv, nc);
  positions_.rank = position_rank;
  velocities_.rank = velocity_rank;
  resize_tangents(tangents_);
  velocity_q_ = Matrix(nc, nq);
  kinematics_q_ = Matrix(nq, nq);
  Z_ = Matrix(nv, dq_);
  A_q_ = Matrix(dv_, nq);
  A_v_ = Matrix(dv_, nv);
  mu_q_ = Matrix(velocity_rank, nq);
  mu_v_ = Matrix(velocity_rank, nv);
  B_ = Matrix(dq_ + dv_, dq_ + dv_);
}

void MultibodyForm::resize_tangents(Tangents& tangents) const {
  tangents.positions.resize(sizes_.positions, sizes_.holonomic);
  tangents.velocities.resize(sizes_.velocities, sizes_.constraints());
}

MultibodyForm::Ranks MultibodyForm::choose(const MultibodyPoint& point, Coordinates coordinates, Arena& arena) {
  same_rows_ = point.terms.S.rows() == 0 && sizes_.nonholonomic == 0;
  Ranks ranks;
  ranks.positions = choose_partition(point.position_rows(), coordinates, positions_.rank, positions_, arena);
  ranks.velocities = same_rows_
                         ? ranks.positions
                         : choose_partition(point.velocity_rows(), coordinates, velocities_.rank, velocities_, arena);
  return ranks;
}

void MultibodyForm::judge(const MultibodyPoint& point, Arena& arena, int& row, double& rest) const {
  Partition trial;
  trial.resize(sizes_.velocities, sizes_.constraints());
  const RankDecision decision =
      choose_partition(point.velocity_rows(), Coordinates::orthogonal, velocities().rank, trial, arena);
  row = velocities().rank > 0 ? trial.rows[index(velocities().rank - 1)] : -1;
  rest = decision.rank < velocities().rank ? decision.dropped : decision.kept;
}

bool MultibodyForm::build_tangents(const MultibodyPoint& point, Tangents& tangents, Arena& arena) const {
  tangents.same_rows = same_rows_;
  const bool fits = tangents.positions.build(positions_, point.position_rows(), arena);
  return same_rows_ ? fits : tangents.velocities.build(velocities_, point.velocity_rows(), arena) && fits;
}

bool MultibodyForm::fit_tangents(const MultibodyPoint& point, Tangents& tangents, Tangent::Uses uses) const {
  tangents.same_rows = same_rows_;
  const bool fits = tangents.positions.fit(positions_, point.position_rows(), uses);
  return same_rows_ ? fits : tangents.velocities.fit(velocities_, point.velocity_rows(), uses) && fits;
}

void MultibodyForm::build(const MultibodyPoint& point, const MultibodyJacobian& jacobian, Arena& arena) {
  const int nq = sizes_.positions;
  const Arena::Frame frame(arena);
  const ConstView S = point.terms.S, T_q = tangents_.positions.T(), T_v = tangents_.of_velocities().T();
  const ConstView Q_q1 = positions_.Q1();
  copy(jacobian.velocity_q, velocity_q_);
  has_velocity_q_ = max_abs(velocity_q_) > 0.0;
  differentiate_accelerations(point, jacobian, arena);
  // Z
  fill(Z_, 0.0);
  if (has_velocity_q_ && dq_ > 0) {
    const View along = arena.matrix(velocity_q_.rows(), dq_);
    multiply(1.0, Op::plain, velocity_q_, Op::plain, T_q, 0.0, along);
    for (int j = 0; j < dq_; ++j)
      tangents_.of_velocities().correction(velocities(), along.column(j), Z_.view().column(j), arena);
  }
  // B
  const View B = B_.view();
  multiply(1.0, Op::plain, A_q_, Op::plain, T_q, 0.0, B.block(dq_, 0, dv_, dq_));
  multiply(1.0, Op::plain, A_v_, Op::plain, Z_, 1.0, B.block(dq_, 0, dv_, dq_));
  multiply(1.0, Op::plain, A_v_, Op::plain, T_v, 0.0, B.block(dq_, dq_, dv_, dv_));
  if (same_rows_) {
    // Q_q1^T T_v = I, and Z is in the range of Q2.
    fill(B.top(dq_), 0.0);
    for (int i = 0; i < dq_; ++i) B(i, dq_ + i) = 1.0;
    return;
  }
  if (S.rows == 0) {
    multiply(1.0, Op::transposed, Q_q1, Op::plain, Z_, 0.0, B.block(0, 0, dq_, dq_));
    multiply(1.0, Op::transposed, Q_q1, Op::plain, T_v, 0.0, B.block(0, dq_, dq_, dv_));
    return;
  }
  copy(jacobian.kinematics_q, kinematics_q_);
  const View rates = arena.matrix(nq, std::max(dq_, dv_));
  multiply(1.0, Op::plain, kinematics_q_, Op::plain, T_q, 0.0, rates.columns(0, dq_));
  multiply(1.0, Op::plain, S, Op::plain, Z_, 1.0, rates.columns(0, dq_));
  multiply(1.0, Op::transposed, Q_q1, Op::plain, rates.columns(0, dq_), 0.0, B.block(0, 0, dq_, dq_));
  multiply(1.0, Op::plain, S, Op::plain, T_v, 0.0, rates.columns(0, dv_));
  multiply(1.0, Op::transposed, Q_q1, Op::plain, rates.columns(0, dv_), 0.0, B.block(0, dq_, dq_, dv_));
}

// Rows of K^-1: Q_v1^T (a_q, a_v) and (mu_q, mu_v) without the other accelerations.
void MultibodyForm::differentiate_accelerations(const MultibodyPoint& point, const MultibodyJacobian& jacobian,
                                                Arena& arena) {
  const int nq = sizes_.positions, nv = sizes_.velocities, r = velocities().rank;
  const Arena::Frame frame(arena);
  const View L = arena.matrix(nv + r, dv_ + r), rest = arena.matrix(r, std::max(nq, nv));
  fill(L, 0.0);
  copy(velocities().Q1(), L.block(0, 0, nv, dv_));
  for (int k = 0; k < r; ++k) L(nv + k, dv_ + k) = 1.0;
  point.solve_transposed(L);
  const auto differentiate = [&](ConstView rows, const Matrix& force, const Matrix& acceleration, View to) {
    const View independent = rest.columns(0, acceleration.cols());
    for (int j = 0; j < independent.cols; ++j)
      for (int k = 0; k < r; ++k) independent(k, j) = acceleration(velocities().rows[index(k)], j);
    multiply(1.0, Op::transposed, rows.top(nv), Op::plain, force, 0.0, to);
    multiply(-1.0, Op::transposed, rows.block(nv, 0, r, rows.cols), Op::plain, independent, 1.0, to);
  };
  differentiate(L.columns(0, dv_), jacobian.force_q, jacobian.acceleration_q, A_q_);
  differentiate(L.columns(0, dv_), jacobian.force_v, jacobian.acceleration_v, A_v_);
  if (r == 0) return;
  differentiate(L.columns(dv_, r), jacobian.force_q, jacobian.acceleration_q, mu_q_);
  differentiate(L.columns(dv_, r), jacobian.force_v, jacobian.acceleration_v, mu_v_);
}

void MultibodyForm::forces(ConstView changes, View mu) const {
  if (mu.rows == 0) return;
  multiply(1.0, Op::plain, mu_q_, Op::plain, changes.top(sizes_.positions), 0.0, mu);
  multiply(1.0, Op::plain, mu_v_, Op::plain, changes.block(sizes_.positions, 0, sizes_.velocities, changes.cols), 1.0,
           mu);
}

void MultibodyForm::project(const double* qv, double* yz) const {
  multiply(1.0, Op::transposed, positions_.Q1(), qv, 0.0, yz);
  multiply(1.0, Op::transposed, velocities().Q1(), qv + sizes_.positions, 0.0, yz + dq_);
}

void MultibodyForm::project(ConstView qv, View yz) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, count = qv.cols;
  multiply(1.0, Op::transposed, positions_.Q1(), Op::plain, qv.top(nq), 0.0, yz.top(dq_));
  multiply(1.0, Op::transposed, velocities().Q1(), Op::plain, qv.block(nq, 0, nv, count), 0.0,
           yz.block(dq_, 0, dv_, count));
}

void MultibodyForm::particular(const Tangents& tangents, const Residuals& residuals, double* qv, Arena& arena) const {
  const int nq = sizes_.positions, nc = sizes_.constraints();
  tangents.positions.correction(positions_, residuals.g, qv, arena);
  const Arena::Frame frame(arena);
  double* velocity = arena.take(index(nc) + 1);
  std::copy_n(residuals.velocity, nc, velocity);
  if (has_velocity_q_) multiply(1.0, Op::plain, velocity_q_, qv, 1.0, velocity);
  tangents.of_velocities().correction(velocities(), velocity, qv + nq, arena);
}

void MultibodyForm::moved_rates(const MultibodyPoint& point, const double* change, double* rates,
                                Arena& arena) const {
  const int nq = sizes_.positions, nv = sizes_.velocities;
  const ConstView S = point.terms.S;
  const double *dq = change, *dv = change + nq;
  if (S.rows == 0) {
    for (int k = 0; k < nv; ++k) rates[k] = point.v[index(k)] + dv[k];
    return;
  }
  const Arena::Frame frame(arena);
  double* moved = arena.take(index(nv));
  for (int k = 0; k < nv; ++k) moved[k] = point.v[index(k)] + dv[k];
  multiply(1.0, Op::plain, S, moved, 0.0, rates);
  multiply(1.0, Op::plain, kinematics_q_, dq, 1.0, rates);
}

void MultibodyForm::rates(ConstView rates, ConstView a, ConstView changes, View yz) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, count = yz.cols;
  const View z = yz.block(dq_, 0, dv_, count);
  multiply(1.0, Op::transposed, positions_.Q1(), Op::plain, rates, 0.0, yz.top(dq_));
  multiply(1.0, Op::transposed, velocities().Q1(), Op::plain, a, 0.0, z);
  multiply(1.0, Op::plain, A_q_, Op::plain, changes.top(nq), 1.0, z);
  multiply(1.0, Op::plain, A_v_, Op::plain, changes.block(nq, 0, nv, count), 1.0, z);
}

void MultibodyForm::expand(const Tangents* tangents, ConstView yz, View qv, Arena& arena) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), count = yz.cols;
  const View dq = qv.top(nq), dv = qv.block(nq, 0, nv, count);
  const Arena::Frame frame(arena);
  const View velocity = arena.matrix(nc, count);
  multiply(1.0, Op::plain, positions_.Q1(), Op::plain, yz.top(dq_), 0.0, dq);
  multiply(1.0, Op::plain, velocities().Q1(), Op::plain, yz.block(dq_, 0, dv_, count), 0.0, dv);
  for (int i = 0; i < count; ++i) tangents[i].positions.enforce(positions_, nullptr, dq.column(i), arena);
  if (has_velocity_q_) multiply(1.0, Op::plain, velocity_q_, Op::plain, dq, 0.0, velocity);
  for (int i = 0; i < count; ++i)
    tangents[i].of_velocities().enforce(velocities(), has_velocity_q_ ? velocity.column(i) : nullptr, dv.column(i),
                                        arena);
}

void MultibodyForm::expand(ConstView yz, View qv) const {
  const int nq = sizes_.positions, nv = sizes_.velocities, count = yz.cols;
  const View dv = qv.block(nq, 0, nv, count);
  multiply(1.0, Op::plain, tangents_.positions.T(), Op::plain, yz.top(dq_), 0.0, qv.top(nq));
  multiply(1.0, Op::plain, tangents_.of_velocities().T(), Op::plain, yz.block(dq_, 0, dv_, count), 0.0, dv);
  if (has_velocity_q_) multiply(1.0, Op::plain, Z_, Op::plain, yz.top(dq_), 1.0, dv);
}

}  // namespace sfdae::core
