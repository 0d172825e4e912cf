// Derivatives of recorded equations by chosen parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/parameter_series.h"

#include <algorithm>
#include <utility>

#include "expression/diagnosis.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Gradient with columns among all, including those of start values.
ParameterGradient gradient_by(const Record& equations, const std::vector<int>& parameters) {
  std::vector<int> chosen, columns;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    if (parameters[j] < 0) continue;
    chosen.push_back(parameters[j]);
    columns.push_back(static_cast<int>(j));
  }
  ParameterGradient gradient = parameter_gradient(equations, chosen);
  for (ParameterGradient::Place& place : gradient.places) place.column = columns[index(place.column)];
  return gradient;
}

bool matrices_contain_slopes(const Record& equations) {
  for (int i = 0; i < equations.m(); ++i)
    for (const Entry& entry : equations.entries(i))
      if ((entry.dependence & on_derivatives) != 0) return true;
  return false;
}

bool contains_slopes(const Record& gradient) {
  for (int i = 0; i < gradient.m(); ++i)
    if ((gradient.dependence(gradient.residual(i)) & on_derivatives) != 0) return true;
  return false;
}

}  // namespace

CallbackError parameter_gradient_error(const TaylorEvaluator& F_p, double t, double user_t) {
  CallbackError error;
  error.status = status_of(F_p.failure());
  error.t = t;
  error.user_t = user_t;
  error.detail = "the equations cannot be differentiated by their parameters at " + error.where() + ": " +
                 F_p.failure().message + ".";
  return error;
}

ParameterSeries::ParameterSeries(RecordedProblem& problem, std::vector<int> parameters)
    : ParameterSeries(problem, parameters, gradient_by(problem.evaluator().record(), parameters)) {}

ParameterSeries::ParameterSeries(RecordedProblem& problem, std::vector<int> parameters, ParameterGradient gradient)
    : problem_(problem),
      parameters_(std::move(parameters)),
      places_(std::move(gradient.places)),
      evaluator_(std::move(gradient.formulas)),
      matrices_need_slopes_(matrices_contain_slopes(problem.evaluator().record())),
      needs_slopes_(matrices_need_slopes_ || contains_slopes(evaluator_.record())) {
  take_parameters();
}

void ParameterSeries::take_parameters() {
  const TaylorEvaluator& from = problem_.evaluator();
  for (int i = 0; i < from.num_parameters(); ++i) evaluator_.set_parameter(i, from.parameter(i));
}

CallbackError ParameterSeries::evaluate_series(double t, const double* jet, int order) {
  F_p_.resize(places_.size() * index(order + 1));
  if (places_.empty() || evaluator_.values(t, jet, order, F_p_.data())) return {};
  return parameter_gradient_error(evaluator_, t, problem_.user_t());
}

CallbackError ParameterSeries::values(double t, const double* jet, int order, View F_p) {
  fill(F_p, 0.0);
  CallbackError error = evaluate_series(t, jet, order);
  if (error.status != SFDAE_OK) return error;
  for (int k = 0; k <= order; ++k)
    for (std::size_t e = 0; e < places_.size(); ++e)
      F_p(places_[e].equation + k * problem_.m(), places_[e].column) = coefficient(e, k);
  return error;
}

const LaneBlock* ParameterSeries::values_side_by_side(const LaneBlock* t, const LaneBlock* jets, int order) {
  lanes_of_F_p_.resize(places_.size() * index(order + 1) + 1);
  if (places_.empty()) return lanes_of_F_p_.data();
  if (!lanes_.evaluate(evaluator_, LaneEvaluator::points_of(t, jets, order, problem_.n()), order, false))
    return nullptr;
  for (std::size_t e = 0; e < places_.size(); ++e)
    for (int k = 0; k <= order; ++k)
      lanes_of_F_p_[e * index(order + 1) + index(k)] = lanes_.value(static_cast<int>(e))[k];
  return lanes_of_F_p_.data();
}

CallbackError ParameterSeries::evaluate(const TaylorData& data, const double* jet, int order, View f) {
  fill(f, 0.0);
  CallbackError error = evaluate_series(data.t, jet, order);
  if (error.status != SFDAE_OK) return error;
  double power = 1.0;
  for (int k = 0; k <= order; ++k) {
    power *= data.time_scale;
    for (std::size_t e = 0; e < places_.size(); ++e) {
      const int i = places_[e].equation;
      if (data.has_row(i, k))
        f(i + k * problem_.m(), places_[e].column) = -power * data.row_scale[index(i)] * coefficient(e, k);
    }
  }
  return error;
}

CallbackError ParameterSeries::add_gradient(const TaylorData& data, const double* jet, ConstView weights,
                                            View gradient) {
  const int m = problem_.m(), order = weights.rows / m - 1;
  CallbackError error = evaluate_series(data.t, jet, order);
  if (error.status != SFDAE_OK) return error;
  double power = 1.0;
  for (int k = 0; k <= order; ++k) {
    power *= data.time_scale;
    for (std::size_t e = 0; e < places_.size(); ++e) {
      const int i = places_[e].equation;
      if (!data.has_row(i, k)) continue;
      const double f = -power * data.row_scale[index(i)] * coefficient(e, k);
      for (int q = 0; q < gradient.cols; ++q) gradient(places_[e].column, q) += f * weights(i + k * m, q);
    }
  }
  return error;
}

CallbackError ParameterSeries::add_gradient(double t, const double* jet, ConstView weights, View gradient) {
  CallbackError error = evaluate_series(t, jet, 0);
  if (error.status != SFDAE_OK) return error;
  for (std::size_t e = 0; e < places_.size(); ++e)
    for (int q = 0; q < gradient.cols; ++q)
      gradient(places_[e].column, q) -= coefficient(e, 0) * weights(places_[e].equation, q);
  return error;
}

}  // namespace sfdae::core
