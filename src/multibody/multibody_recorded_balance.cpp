// The balance of forces of a mechanical system, and its derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_recorded_balance.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Parameters with names that no user can choose.
std::vector<int> held_vector(Recorder& recorder, char name, int count) {
  std::vector<int> nodes;
  for (int i = 0; i < count; ++i)
    nodes.push_back(recorder.parameter(std::string(1, '\0') + name + std::to_string(i), 0.0));
  return nodes;
}

std::vector<int> parameters_of(const Recorder& recorder, const std::vector<int>& nodes) {
  std::vector<int> indices;
  for (const int node : nodes) indices.push_back(recorder.node(node).a);
  return indices;
}

}  // namespace

// f - M a - S^T p - H^T kappa, p = g_q^T lambda, with a, p and kappa held. Its values are meaningless: constant
// coefficients are left out, as they have no derivatives.
RecordedBalance::RecordedBalance(Recorder& recorder, const MultibodyFormulas& formulas, bool has_kinematics,
                                 bool is_rheonomic)
    : sizes_(formulas.sizes), has_kinematics_(has_kinematics), is_rheonomic_(is_rheonomic) {
  const int nq = sizes_.positions, nv = sizes_.velocities, nl = sizes_.holonomic, nk = sizes_.nonholonomic;
  const std::vector<int> a = held_vector(recorder, 'a', nv), kappa = held_vector(recorder, 'k', nk);
  const std::vector<int> p = held_vector(recorder, 'p', has_kinematics_ ? nq : 0),
                         lambda = held_vector(recorder, 'l', nl);
  const int zero = recorder.constant(0.0);
  const auto subtract = [&](int& from, std::vector<int> coefficients, const std::vector<int>& factors) {
    for (int& coefficient : coefficients)
      if (coefficient != zero && is_number(recorder, coefficient)) coefficient = zero;
    from = recorder.apply(Operation::subtract, from, combination(recorder, coefficients, factors));
  };
  std::vector<int> balance = formulas.f;
  for (int i = 0; i < nv; ++i) {
    subtract(balance[index(i)], row_of(formulas.M, nv, i), a);
    if (has_kinematics_) subtract(balance[index(i)], column_of(formulas.S, nq, i), p);
    if (nk > 0) subtract(balance[index(i)], column_of(formulas.H, nk, i), kappa);
  }
  balance_.emplace(recorder.excerpt(nq + nv, balance, numbered("f", nv)));
  if (nl > 0) {
    curvature_.emplace(recorder.excerpt(nq, {combination(recorder, formulas.g, lambda)}, {"g"}));
    for (const Entry& entry : curvature_->record().entries(0))
      if ((entry.dependence & on_unknowns) != 0) curved_.push_back(entry.unknown);
  }
  held_ = {parameters_of(recorder, a), parameters_of(recorder, kappa), parameters_of(recorder, p),
           parameters_of(recorder, lambda)};
  q_jet_.resize(3 * index(nq));
  for (auto* values : {&reactions_, &in_time_}) values->resize(index(nq));
  gradients_.resize(index(nv) * index(nq + nv));
  curvature_gradients_.resize(2 * index(nq));
}

void RecordedBalance::copy_parameters(const TaylorEvaluator& from, int count) {
  for (auto* evaluator : {&balance_, &curvature_})
    if (evaluator->has_value())
      for (int i = 0; i < count; ++i) (*evaluator)->set_parameter(i, from.parameter(i));
}

bool RecordedBalance::differentiate(const double* jet, const MultibodyState& state, const MultibodyTerms& terms,
                                    MultibodyJacobian& jacobian, CallbackError& error) {
  const int nq = sizes_.positions, nv = sizes_.velocities, nl = sizes_.holonomic;
  const auto hold = [](TaylorEvaluator& evaluator, const std::vector<int>& parameters, const double* values) {
    for (std::size_t i = 0; i < parameters.size(); ++i) evaluator.set_parameter(parameters[i], values[i]);
  };
  hold(*balance_, held_.a, state.a);
  hold(*balance_, held_.kappa, state.mu + nl);
  if (has_kinematics_) {
    std::fill_n(reactions_.data(), nq, 0.0);
    if (nl > 0) multiply(1.0, Op::transposed, terms.g_q, state.mu, 0.0, reactions_.data());
    hold(*balance_, held_.p, reactions_.data());
  }
  if (curvature_) hold(*curvature_, held_.lambda, state.mu);
  if (!balance_->gradients(error.t, jet, {-1, -1, 0}, nullptr, nullptr, gradients_.data()))
    return report_failure(*balance_, error);
  const std::size_t area = index(nv) * index(nq);
  std::copy_n(gradients_.data(), area, jacobian.force_q.data());
  std::copy_n(gradients_.data() + area, index(nv) * index(nv), jacobian.force_v.data());
  return true;
}

// Column by column: the first coefficients of gradients of lambda^T g along q + s e_j, minus those from t + s.
bool RecordedBalance::subtract_curvature(const double* q, const MultibodyTerms& terms, View force_q,
                                         CallbackError& error) {
  const int nq = sizes_.positions;
  double *const direction = q_jet_.data() + nq, *const in_time = in_time_.data();
  std::copy_n(q, nq, q_jet_.data());
  std::fill_n(direction, nq, 0.0);
  std::fill_n(in_time, nq, 0.0);
  const auto evaluate = [&] {
    return curvature_->gradients(error.t, q_jet_.data(), {-1, -1, 1}, nullptr, nullptr,
                                 curvature_gradients_.data()) ||
           report_failure(*curvature_, error);
  };
  if (is_rheonomic_ && !curved_.empty()) {
    if (!evaluate()) return false;
    std::copy_n(curvature_gradients_.data() + nq, nq, in_time);
  }
  for (const int j : curved_) {
    direction[j] = 1.0;
    if (!evaluate()) return false;
    direction[j] = 0.0;
    double* const column = curvature_gradients_.data() + nq;
    for (int i = 0; i < nq; ++i) column[i] -= in_time[i];
    if (has_kinematics_) multiply(-1.0, Op::transposed, terms.S, column, 1.0, force_q.column(j));
    else
      for (int i = 0; i < nq; ++i) force_q(i, j) -= column[i];
  }
  return true;
}

}  // namespace sfdae::core
