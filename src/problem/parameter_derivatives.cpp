// SPDX-License-Identifier: BSD-3-Clause
#include "problem/parameter_derivatives.h"

#include <utility>

#include "linalg/index.h"
#include "problem/parameter_series.h"

namespace sfdae::core {

ParameterDerivatives::ParameterDerivatives(const TaylorEvaluator& equations, const std::vector<int>& parameters)
    : ParameterDerivatives(equations, static_cast<int>(parameters.size()),
                           parameter_gradient(equations.record(), parameters)) {}

ParameterDerivatives::ParameterDerivatives(const TaylorEvaluator& equations, int count, ParameterGradient gradient)
    : m_(equations.record().m()),
      count_(count),
      places_(std::move(gradient.places)),
      evaluator_(std::move(gradient.formulas)),
      values_(places_.size()) {
  for (int i = 0; i < equations.num_parameters(); ++i) evaluator_.set_parameter(i, equations.parameter(i));
}

bool ParameterDerivatives::depend_on_solution() const {
  const Record& F_p = evaluator_.record();
  for (int i = 0; i < F_p.m(); ++i)
    if ((F_p.dependence(F_p.residual(i)) & on_state) != 0) return true;
  return false;
}

Matrix ParameterDerivatives::at(double t, const double* jet) {
  Matrix F_p(m_, count_);
  if (!places_.empty() && !evaluator_.values(t, jet, 0, values_.data()))
    parameter_gradient_error(evaluator_, t, t).raise();
  for (std::size_t e = 0; e < places_.size(); ++e) F_p(places_[e].equation, places_[e].column) = values_[e];
  return F_p;
}

}  // namespace sfdae::core
