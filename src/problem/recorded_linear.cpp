// Recorded linear equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/recorded_linear.h"

#include <algorithm>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

RecordedLinearCoefficients::RecordedLinearCoefficients(std::shared_ptr<const Record> record, PrescribedInputs inputs)
    : evaluator_(std::move(record)), inputs_(std::move(inputs)) {}

RecordedLinearCoefficients::RecordedLinearCoefficients(const TaylorEvaluator& evaluator, PrescribedInputs inputs)
    : evaluator_(evaluator), inputs_(std::move(inputs)) {}

std::unique_ptr<RecordedLinearCoefficients> RecordedLinearCoefficients::clone() const {
  return std::unique_ptr<RecordedLinearCoefficients>(new RecordedLinearCoefficients(evaluator_, inputs_));
}

LinearFunctions RecordedLinearCoefficients::functions() {
  const Record& record = evaluator_.record();
  LinearFunctions functions;
  functions.m = record.m();
  functions.n = record.n();
  functions.E = [](double t, int order, double* E, void* self) {
    return static_cast<RecordedLinearCoefficients*>(self)->derivative('E', t, order, E);
  };
  functions.A = [](double t, int order, double* A, void* self) {
    return static_cast<RecordedLinearCoefficients*>(self)->derivative('A', t, order, A);
  };
  functions.f = [](double t, int order, double* f, void* self) {
    return static_cast<RecordedLinearCoefficients*>(self)->derivative('f', t, order, f);
  };
  functions.user = this;
  functions.constant_E = record.is_constant_E();
  functions.constant_A = record.is_constant_A();
  functions.inputs = inputs_;
  functions.names = record.equation_names();
  return functions;
}

bool RecordedLinearCoefficients::evaluate(double t, int order) {
  if (t == known_t_ && order <= known_order_) return true;
  const std::size_t m = index(evaluator_.record().m()), n = index(evaluator_.record().n()), count = index(order + 1);
  jet_.assign(n * (count + 1), 0.0);
  F_.resize(m * count);
  F_xdot_.resize(m * n * count);
  F_x_.resize(m * n * count);
  known_order_ = -1;
  if (!evaluator_.gradients(t, jet_.data(), {order, order, order}, F_.data(), F_xdot_.data(), F_x_.data()))
    return false;
  known_t_ = t;
  known_order_ = order;
  return true;
}

int RecordedLinearCoefficients::derivative(char which, double t, int order, double* values) {
  constexpr int cannot_evaluate = 1;  // returned as callbacks of users do
  if (order > max_derivative_order) return SFDAE_ORDER_NOT_AVAILABLE;
  // Evaluates all orders at once; the highest may fail although this one does not.
  usual_order_ = std::max(usual_order_, order);
  if (!evaluate(t, usual_order_) && !evaluate(t, order)) {
    const int code = evaluator_.failure().code;
    return code != 0 ? code : cannot_evaluate;
  }
  const std::size_t m = index(evaluator_.record().m()), n = index(evaluator_.record().n());
  const std::size_t size = which == 'f' ? m : m * n;
  const std::vector<double>& from = which == 'E' ? F_xdot_ : which == 'A' ? F_x_ : F_;
  double factor = which == 'E' ? 1.0 : -1.0;
  for (int k = 2; k <= order; ++k) factor *= k;
  for (std::size_t i = 0; i < size; ++i) values[i] = factor * from[size * index(order) + i];
  return 0;
}

}  // namespace sfdae::core
