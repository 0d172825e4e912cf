// SPDX-License-Identifier: BSD-3-Clause
#include "problem/parameter_derivatives.h"

#include <algorithm>
#include <utility>

#include "expression/parameter_unknowns.h"
#include "linalg/index.h"

namespace sfdae::core {

ParameterDerivatives::ParameterDerivatives(const TaylorEvaluator& equations, std::vector<int> parameters)
    : parameters_(std::move(parameters)),
      problem_(with_parameters_as_unknowns(equations.record(), parameters_), PrescribedInputs{}) {
  for (int i = 0; i < equations.num_parameters(); ++i) problem_.evaluator().set_parameter(i, equations.parameter(i));
  for (int which : parameters_) values_.push_back(equations.parameter(which));
}

bool ParameterDerivatives::depend_on_solution() const {
  const Record& record = const_cast<RecordedProblem&>(problem_).evaluator().record();
  const int n = problem_.n() - static_cast<int>(parameters_.size());
  for (int i = 0; i < record.m(); ++i)
    for (const Entry& entry : record.entries(i))
      if (entry.unknown >= n && (entry.dependence & on_state) != 0) return true;
  return false;
}

Matrix ParameterDerivatives::at(double t, const double* jet) {
  const std::size_t m = index(problem_.m()), all = index(problem_.n()), n = all - parameters_.size();
  std::vector<double> given(2 * all, 0.0);
  std::copy_n(jet, n, given.begin());
  std::copy(values_.begin(), values_.end(), given.begin() + static_cast<std::ptrdiff_t>(n));
  std::copy_n(jet + n, n, given.begin() + static_cast<std::ptrdiff_t>(all));
  std::vector<double> F(m), F_x(m * all);
  if (!problem_.evaluator().gradients(t, given.data(), {.F = 0, .F_x = 0}, F.data(), nullptr, F_x.data()))
    problem_.evaluation_error(t).raise();
  Matrix F_p(problem_.m(), static_cast<int>(parameters_.size()));
  std::copy(F_x.begin() + static_cast<std::ptrdiff_t>(m * n), F_x.end(), F_p.data());
  return F_p;
}

}  // namespace sfdae::core
