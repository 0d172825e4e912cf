// A mechanical system given by recorded formulas: auxiliary records, values, and the Jacobian of the iterated
// residuals.
//
// With K = (S v)_q and y = H v + h:
//     (C v + r)_q        g_q,1 + g_q K;                              y_q
//     (C a + s)_q        2 g_q,2 + 2 g_q,1 K + g_q (2 q_2)_q;        y_q,1 + y_q K
//     (C a + s)_v        2 g_q,1 S + g_q (2 q_2)_v;                  H_1 + y_q S
//     (2 q_2)_q = K_1 + K K,   (2 q_2)_v = S_1 + K S
// where the index after a comma, or of K, S, H, is that of a Taylor coefficient along the motion.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_recorded.h"

#include <algorithm>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

bool needs_kinematics(const Recorder& recorder, const MultibodyFormulas& formulas) {
  return !is_identity(recorder, formulas.S, formulas.sizes.positions, formulas.sizes.velocities);
}

void add(ConstView from, View to) {
  for (int j = 0; j < to.cols; ++j)
    for (int i = 0; i < to.rows; ++i) to(i, j) += from(i, j);
}

void add_product(double factor, ConstView a, ConstView b, View to) {
  multiply(factor, Op::plain, a, Op::plain, b, 1.0, to);
}

}  // namespace

RecordedMultibody::RecordedMultibody(Recorder& recorder, MultibodyFormulas formulas)
    : MultibodyProblem(formulas.sizes),
      num_parameters_(recorder.num_parameters()),
      terms_(recorder, formulas, needs_kinematics(recorder, formulas)) {
  const int nq = sizes().positions, nv = sizes().velocities, nl = sizes().holonomic, nk = sizes().nonholonomic;
  if (nl > 0) constraints_.emplace(recorder.excerpt(nq, formulas.g, numbered("g", nl)));
  for (const int node : formulas.g)
    if ((constraints_->record().dependence(node) & on_time) != 0) rheonomic_ = true;
  std::vector<int> v;
  for (int j = 0; j < nv; ++j) v.push_back(recorder.unknown(nq + j));
  const auto applied_to_v = [&](const std::vector<int>& matrix, int rows) {
    std::vector<int> products;
    for (int i = 0; i < rows; ++i) products.push_back(combination(recorder, row_of(matrix, rows, i), v));
    return products;
  };
  if (needs_kinematics(recorder, formulas))
    kinematics_.emplace(recorder.excerpt(nq + nv, applied_to_v(formulas.S, nq), numbered("S v", nq)));
  if (nk > 0) {
    std::vector<int> levels = applied_to_v(formulas.H, nk);
    for (int i = 0; i < nk; ++i)
      levels[index(i)] = recorder.apply(Operation::add, levels[index(i)], formulas.h[index(i)]);
    nonholonomic_.emplace(recorder.excerpt(nq + nv, levels, numbered("H v + h", nk)));
  }
  balance_.emplace(recorder, formulas, kinematics_.has_value(), rheonomic_);
  recording_ = std::make_shared<const Recording>(Recording{std::move(recorder), std::move(formulas)});
  allocate();
}

std::shared_ptr<const Record> RecordedMultibody::first_order_record() const {
  Recorder recorder = recording_->recorder;
  return first_order_equations(recorder, recording_->formulas);
}

std::unique_ptr<RecordedProblem> RecordedMultibody::first_order_problem() {
  auto problem = std::make_unique<RecordedProblem>(first_order_record(), PrescribedInputs{});
  for (int i = 0; i < num_parameters_; ++i) problem->evaluator().set_parameter(i, terms_.evaluator().parameter(i));
  return problem;
}

void RecordedMultibody::allocate() {
  const std::size_t nq = index(sizes().positions), nv = index(sizes().velocities), n = nq + nv;
  const std::size_t nl = index(sizes().holonomic), nk = index(sizes().nonholonomic);
  q_jet_.resize(4 * nq);
  jet_.resize(3 * n);
  g_jet_.resize(3 * nl);
  rates_.resize(2 * std::max(nq, nk));
  gradients_.resize(std::max({3 * nl * nq, 2 * nk * n, kinematics_ ? 2 * nq * n : 0}));
  if (!kinematics_) return;
  rate_q_ = Matrix(sizes().positions, sizes().positions);
  rate_v_ = Matrix(sizes().positions, sizes().velocities);
}

std::vector<const TaylorEvaluator*> RecordedMultibody::evaluators_of_inputs() const {
  std::vector<const TaylorEvaluator*> evaluators = {&terms_.evaluator()};
  if (constraints_) evaluators.push_back(&*constraints_);
  return evaluators;
}

void RecordedMultibody::parameters_changed() {
  const TaylorEvaluator& all = terms_.evaluator();
  terms_.copy_parameters(num_parameters_);
  balance_->copy_parameters(all, num_parameters_);
  for (auto* other : {&constraints_, &kinematics_, &nonholonomic_})
    if (other->has_value())
      for (int i = 0; i < num_parameters_; ++i) (*other)->set_parameter(i, all.parameter(i));
}

CallbackError RecordedMultibody::begin(double t) const {
  CallbackError error;
  error.t = t;
  error.user_t = user_t();
  if (stop_is_requested()) error.status = SFDAE_STOPPED;
  return error;
}

CallbackError RecordedMultibody::constraints(double t, const double* q, double* g) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK || !constraints_) return error;
  if (!constraints_->values(t, q, 0, g)) report_failure(*constraints_, error);
  return error;
}

// Evaluates both levels along q + v s.
bool RecordedMultibody::constraints_on_both_levels(const MultibodyLevels& at, CallbackError& error) {
  if (!constraints_ || kinematics_ || nonholonomic_) return false;
  error = begin(at.t);
  ++evaluations_;
  if (error.status != SFDAE_OK) return true;
  const int nq = sizes().positions;
  std::copy_n(at.q, nq, q_jet_.data());
  std::copy_n(at.v, nq, q_jet_.data() + nq);
  const SeriesOrders orders{1, -1, at.g_q != nullptr ? 0 : -1};
  if (!constraints_->gradients(at.t, q_jet_.data(), orders, at.residuals, nullptr,
                               at.g_q != nullptr ? at.g_q->data() : nullptr))
    report_failure(*constraints_, error);
  return true;
}

// Evaluates along q_jet_, up to q_2 (order 2) or with q_1 = 0.
bool RecordedMultibody::evaluate_constraints(int order, MultibodyTerms& terms, CallbackError& error) {
  const int nl = sizes().holonomic, nq = sizes().positions, nv = sizes().velocities;
  if (!constraints_) return true;
  if (!constraints_->gradients(error.t, q_jet_.data(), {order, -1, 0}, g_jet_.data(), nullptr, terms.g_q.data()))
    return report_failure(*constraints_, error);
  const double* const g_1 = g_jet_.data() + nl;
  std::copy_n(g_jet_.data(), nl, terms.g.data());
  const View G = terms.C.view().block(0, 0, nl, nv);
  if (kinematics_) multiply(1.0, Op::plain, terms.g_q, Op::plain, terms.S, 0.0, G);
  else copy(terms.g_q, G);
  if (order == 0 || !rheonomic_) return true;
  std::copy_n(g_1, nl, terms.velocity_rest.data());
  if (order == 2) multiply(-1.0, Op::plain, terms.g_q, q_jet_.data() + nq, 1.0, terms.velocity_rest.data());
  return true;
}

CallbackError RecordedMultibody::at_position(double t, const double* q, MultibodyTerms& terms) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK || !terms_.evaluate(q, false, terms, error)) return error;
  const std::size_t nq = index(sizes().positions);
  std::copy_n(q, nq, q_jet_.data());
  std::fill_n(q_jet_.data() + nq, nq, 0.0);
  evaluate_constraints(rheonomic_ ? 1 : 0, terms, error);
  return error;
}

void RecordedMultibody::set_jet(const double* q, const double* v, const double* v_1, const MultibodyTerms& terms) {
  const std::size_t nq = index(sizes().positions), nv = index(sizes().velocities);
  double* const q_1 = q_jet_.data() + nq;
  std::copy_n(q, nq, q_jet_.data());
  if (kinematics_) multiply(1.0, Op::plain, terms.S, v, 0.0, q_1);
  else std::copy_n(v, nq, q_1);
  if (v_1 != nullptr && !kinematics_)
    for (std::size_t j = 0; j < nq; ++j) q_1[nq + j] = 0.5 * v_1[j];
  else std::fill_n(q_1 + nq, nq, 0.0);
  std::copy_n(q, nq, jet_.data());
  std::copy_n(v, nv, jet_.data() + nq);
  std::copy_n(q_1, nq, jet_.data() + nq + nv);
  if (v_1 != nullptr) std::copy_n(v_1, nv, jet_.data() + 2 * nq + nv);
  else std::fill_n(jet_.data() + 2 * nq + nv, nv, 0.0);
}

CallbackError RecordedMultibody::at_velocity(double t, const double* q, const double* v, MultibodyTerms& terms) {
  CallbackError error = begin(t);
  ++evaluations_;
  if (error.status != SFDAE_OK) return error;
  const int nq = sizes().positions, nl = sizes().holonomic, nk = sizes().nonholonomic;
  std::copy_n(q, nq, jet_.data());
  std::copy_n(v, sizes().velocities, jet_.data() + nq);
  if (!terms_.evaluate(jet_.data(), true, terms, error)) return error;
  set_jet(q, v, nullptr, terms);
  double* const s = terms.acceleration_rest.data();
  if (kinematics_) {
    if (!kinematics_->values(t, jet_.data(), 1, rates_.data())) return report_failure(*kinematics_, error), error;
    for (int i = 0; i < nq; ++i) q_jet_[index(2 * nq + i)] = 0.5 * rates_[index(nq + i)];
  }
  if (!evaluate_constraints(2, terms, error)) return error;
  for (int i = 0; i < nl; ++i) s[i] = 2.0 * g_jet_[index(2 * nl + i)];
  if (!nonholonomic_) return error;
  if (!nonholonomic_->values(t, jet_.data(), 1, rates_.data())) return report_failure(*nonholonomic_, error), error;
  std::copy_n(rates_.data() + nk, nk, s + nl);
  return error;
}

bool RecordedMultibody::at_velocities(int count, const LaneBlock* t, const LaneBlock* qv, MultibodyLaneTerms& terms) {
  if (stop_is_requested() || !lanes_.evaluate(formulas_of_lanes(), t, qv, terms)) return false;
  evaluations_ += count;
  return true;
}

// Completes the jet by q_2.
bool RecordedMultibody::linearize_kinematics(const MultibodyTerms& terms, MultibodyJacobian& jacobian,
                                             CallbackError& error) {
  const int nq = sizes().positions, nv = sizes().velocities, n = nq + nv;
  if (jacobian.kinematics_q.cols() == 0) jacobian.kinematics_q = Matrix(nq, nq);
  if (!kinematics_->gradients(error.t, jet_.data(), {1, -1, 1}, rates_.data(), nullptr, gradients_.data()))
    return report_failure(*kinematics_, error);
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
    return report_failure(*constraints_, error);
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
    return report_failure(*nonholonomic_, error);
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
  CallbackError error = begin(state.t);
  ++linearizations_;
  if (error.status != SFDAE_OK) return error;
  set_jet(state.q, state.v, state.a, terms);
  (void)(balance_->differentiate(jet_.data(), state, terms, jacobian, error) &&
         (!kinematics_ || linearize_kinematics(terms, jacobian, error)) &&
         linearize_holonomic(terms, jacobian, error) && linearize_nonholonomic(terms, jacobian, error) &&
         balance_->subtract_curvature(state.q, terms, jacobian.force_q, error));
  return error;
}

}  // namespace sfdae::core
