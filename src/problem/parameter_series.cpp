// Derivatives of recorded equations by chosen parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/parameter_series.h"

#include <algorithm>
#include <utility>

#include "expression/diagnosis.h"
#include "expression/parameter_gradient.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

std::vector<int> those_of_parameters(const std::vector<int>& parameters) {
  std::vector<int> columns;
  for (std::size_t j = 0; j < parameters.size(); ++j)
    if (parameters[j] >= 0) columns.push_back(static_cast<int>(j));
  return columns;
}

std::vector<int> without_gaps(const std::vector<int>& parameters) {
  std::vector<int> chosen;
  for (int p : parameters)
    if (p >= 0) chosen.push_back(p);
  return chosen;
}

bool contains_slopes(const Record& equations, const Record& gradient) {
  for (int i = 0; i < equations.m(); ++i)
    for (const Entry& entry : equations.entries(i))
      if ((entry.dependence & on_derivatives) != 0) return true;
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
    : problem_(problem),
      parameters_(std::move(parameters)),
      columns_(those_of_parameters(parameters_)),
      evaluator_(parameter_gradient(problem.evaluator().record(), without_gaps(parameters_))),
      needs_slopes_(contains_slopes(problem.evaluator().record(), evaluator_.record())) {
  take_parameters();
}

void ParameterSeries::take_parameters() {
  const TaylorEvaluator& from = problem_.evaluator();
  for (int i = 0; i < from.num_parameters(); ++i) evaluator_.set_parameter(i, from.parameter(i));
}

CallbackError ParameterSeries::evaluate_series(double t, const double* jet, int order) {
  F_p_.resize(index(problem_.m()) * columns_.size() * index(order + 1));
  if (columns_.empty() || evaluator_.values(t, jet, order, F_p_.data())) return {};
  return parameter_gradient_error(evaluator_, t, problem_.user_t());
}

CallbackError ParameterSeries::values(double t, const double* jet, int order, View F_p) {
  const std::size_t m = index(problem_.m());
  fill(F_p, 0.0);
  CallbackError error = evaluate_series(t, jet, order);
  if (error.status != SFDAE_OK) return error;
  for (std::size_t k = 0; k <= index(order); ++k)
    for (std::size_t q = 0; q < columns_.size(); ++q)
      std::copy_n(F_p_.data() + m * (q + columns_.size() * k), m, F_p.column(columns_[q]) + m * k);
  return error;
}

CallbackError ParameterSeries::evaluate(const TaylorData& data, const double* jet, int order, View f) {
  const int m = problem_.m(), chosen = static_cast<int>(columns_.size());
  fill(f, 0.0);
  CallbackError error = evaluate_series(data.t, jet, order);
  if (error.status != SFDAE_OK) return error;
  double power = 1.0;
  for (int k = 0; k <= order; ++k) {
    power *= data.time_scale;
    for (int q = 0; q < chosen; ++q) {
      const double* from = F_p_.data() + index(m) * (index(q) + index(chosen) * index(k));
      double* to = f.column(columns_[index(q)]) + static_cast<std::ptrdiff_t>(k) * m;
      for (int i = 0; i < m; ++i)
        if (data.has_row(i, k)) to[i] = -power * data.row_scale[index(i)] * from[i];
    }
  }
  return error;
}

}  // namespace sfdae::core
