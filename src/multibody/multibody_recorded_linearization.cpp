// The Jacobian of what is iterated for a mechanical system, from Taylor coefficients of gradients of its formulas.
//
// With K = (S v)_q and y = H v + h:
//     (C v + r)_q        g_q,1 + g_q K;                              y_q
//     (C a + s)_q        2 g_q,2 + 2 g_q,1 K + g_q (2 q_2)_q;        y_q,1 + y_q K
//     (C a + s)_v        2 g_q,1 S + g_q (2 q_2)_v;                  H_1 + y_q S
//     (2 q_2)_q = K_1 + K K,   (2 q_2)_v = S_1 + K S
// where the index after a comma, or of K, S, H, is that of a Taylor coefficient along the motion.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_recorded.h"

namespace sfdae::core {

namespace {

// to := factor from
void copy_multiple(double factor, ConstView from, View to) {
  for (int j = 0; j < to.cols; ++j)
    for (int i = 0; i < to.rows; ++i) to(i, j) = factor * from(i, j);
}

void add(ConstView from, View to) {
  for (int j = 0; j < to.cols; ++j)
    for (int i = 0; i < to.rows; ++i) to(i, j) += from(i, j);
}

void add_product(double factor, ConstView a, ConstView b, View to) {
  multiply(factor, Op::plain, a, Op::plain, b, 1.0, to);
}

}  // namespace

bool RecordedMultibody::linearize_balance(const double* a, const double* mu, const MultibodyTerms& terms,
                                          MultibodyJacobian& jacobian, CallbackError& error) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic;
  const auto hold = [](TaylorEvaluator& evaluator, const std::vector<int>& parameters, const double* values) {
    for (std::size_t i = 0; i < parameters.size(); ++i) evaluator.set_parameter(parameters[i], values[i]);
  };
  hold(*balance_, held_.a, a);
  hold(*balance_, held_.kappa, mu + nl);
  if (kinematics_) {
    std::fill_n(rates_.data(), nq, 0.0);
    if (nl > 0) multiply(1.0, Op::transposed, terms.g_q, mu, 0.0, rates_.data());
    hold(*balance_, held_.p, rates_.data());
  }
  if (curvature_) hold(*curvature_, held_.lambda, mu);
  if (!balance_->gradients(error.t, jet_.data(), {-1, -1, 0}, nullptr, nullptr, gradients_.data()))
    return failed(*balance_, error);
  const std::size_t area = index(nv) * index(nq);
  std::copy_n(gradients_.data(), area, jacobian.force_q.data());
  std::copy_n(gradients_.data() + area, index(nv) * index(nv), jacobian.force_v.data());
  return true;
}

// S^T (lambda^T g)_qq, column by column: the first coefficients of gradients of lambda^T g along q + s e_j, less
// those that come from t + s.
bool RecordedMultibody::subtract_curvature(const double* q, const MultibodyTerms& terms, View force_q,
                                           CallbackError& error) {
  const int nq = sizes().positions;
  double *const direction = q_jet_.data() + nq, *const in_time = rates_.data();
  std::copy_n(q, nq, q_jet_.data());
  std::fill_n(direction, nq, 0.0);
  std::fill_n(in_time, nq, 0.0);
  const auto evaluate = [&] {
    return curvature_->gradients(error.t, q_jet_.data(), {-1, -1, 1}, nullptr, nullptr,
                                 curvature_gradients_.data()) ||
           failed(*curvature_, error);
  };
  if (rheonomic_ && !curved_.empty()) {
    if (!evaluate()) return false;
    std::copy_n(curvature_gradients_.data() + nq, nq, in_time);
  }
  for (const int j : curved_) {
    direction[j] = 1.0;
    if (!evaluate()) return false;
    direction[j] = 0.0;
    double* const column = curvature_gradients_.data() + nq;
    for (int i = 0; i < nq; ++i) column[i] -= in_time[i];
    if (kinematics_) multiply(-1.0, Op::transposed, terms.S, column, 1.0, force_q.column(j));
    else
      for (int i = 0; i < nq; ++i) force_q(i, j) -= column[i];
  }
  return true;
}

// Completes the jet by q_2.
bool RecordedMultibody::linearize_kinematics(const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                                             CallbackError& error) {
  const int nq = sizes().positions, nv = sizes().velocities, n = nq + nv;
  if (jacobian.kinematics_q.cols() == 0) jacobian.kinematics_q = Matrix(nq, nq);
  if (!kinematics_->gradients(error.t, jet_.data(), {1, -1, 1}, rates_.data(), nullptr, gradients_.data()))
    return failed(*kinematics_, error);
  for (int i = 0; i < nq; ++i) q_jet_[index(2 * nq + i)] = 0.5 * rates_[index(nq + i)];
  const ConstView first{gradients_.data(), nq, n, nq}, second{gradients_.data() + index(nq) * index(n), nq, n, nq};
  const ConstView K = first.columns(0, nq);
  copy(K, jacobian.kinematics_q);
  copy(second.columns(0, nq), rate_q_);
  add_product(1.0, K, K, rate_q_);
  copy(second.columns(nq, nv), rate_v_);
  add_product(1.0, K, terms.S, rate_v_);
  return true;
}

bool RecordedMultibody::linearize_holonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                                            CallbackError& error) {
  const int nq = sizes().positions, nl = sizes().holonomic;
  if (!constraints_) return true;
  if (!constraints_->gradients(error.t, q_jet_.data(), {-1, -1, 2}, nullptr, nullptr, gradients_.data()))
    return failed(*constraints_, error);
  const auto coefficient = [&](int k) -> ConstView {
    return {gradients_.data() + index(k) * index(nl) * index(nq), nl, nq, nl};
  };
  const View velocity_q = jacobian.velocity_q.view().top(nl), acceleration_q = jacobian.acceleration_q.view().top(nl);
  const View acceleration_v = jacobian.acceleration_v.view().top(nl);
  copy(coefficient(1), velocity_q);
  copy_multiple(2.0, coefficient(2), acceleration_q);
  if (!kinematics_) {
    copy_multiple(2.0, coefficient(1), acceleration_v);
    return true;
  }
  const ConstView K = jacobian.kinematics_q;
  add_product(1.0, coefficient(0), K, velocity_q);
  add_product(2.0, coefficient(1), K, acceleration_q);
  add_product(1.0, coefficient(0), rate_q_, acceleration_q);
  multiply(2.0, Op::plain, coefficient(1), Op::plain, terms.S, 0.0, acceleration_v);
  add_product(1.0, coefficient(0), rate_v_, acceleration_v);
  return true;
}

bool RecordedMultibody::linearize_nonholonomic(const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                                               CallbackError& error) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  if (!nonholonomic_) return true;
  if (!nonholonomic_->gradients(error.t, jet_.data(), {-1, -1, 1}, nullptr, nullptr, gradients_.data()))
    return failed(*nonholonomic_, error);
  const int n = nq + nv;
  const ConstView first{gradients_.data(), nk, n, nk}, second{gradients_.data() + index(nk) * index(n), nk, n, nk};
  const ConstView y_q = first.columns(0, nq);
  const View acceleration_q = jacobian.acceleration_q.view().block(nl, 0, nk, nq);
  const View acceleration_v = jacobian.acceleration_v.view().block(nl, 0, nk, nv);
  copy(y_q, jacobian.velocity_q.view().block(nl, 0, nk, nq));
  copy(second.columns(0, nq), acceleration_q);
  copy(second.columns(nq, nv), acceleration_v);
  if (kinematics_) {
    add_product(1.0, y_q, jacobian.kinematics_q, acceleration_q);
    add_product(1.0, y_q, terms.S, acceleration_v);
  } else {
    add(y_q, acceleration_v);
  }
  return true;
}

CallbackError RecordedMultibody::linearize(const MultibodyState& state, const MultibodyTerms& terms,
                                           MultibodyJacobian& jacobian) {
  const auto [t, q, v, a, mu] = state;
  CallbackError error = begin(t);
  ++linearizations_;
  if (error.status != SFDAE_OK) return error;
  set_jet(q, v, a, terms);
  (void)(linearize_balance(a, mu, terms, jacobian, error) &&
         (!kinematics_ || linearize_kinematics(terms, jacobian, error)) &&
         linearize_holonomic(terms, jacobian, error) && linearize_nonholonomic(terms, jacobian, error) &&
         subtract_curvature(q, terms, jacobian.force_q, error));
  return error;
}

}  // namespace sfdae::core
