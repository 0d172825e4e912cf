// SPDX-License-Identifier: BSD-3-Clause
#include "problem/parameter_derivatives.h"

#include "expression/parameter_gradient.h"
#include "linalg/index.h"
#include "problem/parameter_series.h"

namespace sfdae::core {

ParameterDerivatives::ParameterDerivatives(const TaylorEvaluator& equations, const std::vector<int>& parameters)
    : m_(equations.record().m()),
      count_(static_cast<int>(parameters.size())),
      evaluator_(parameter_gradient(equations.record(), parameters)) {
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
  if (!evaluator_.values(t, jet, 0, F_p.data())) parameter_gradient_error(evaluator_, t, t).raise();
  return F_p;
}

}  // namespace sfdae::core
