// Derivatives of recorded equations by their parameters, at points.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/parameter_gradient.h"
#include "expression/taylor_evaluator.h"
#include "linalg/matrix.h"

namespace sfdae::core {

class ParameterDerivatives {
 public:
  // Derivatives by the parameters with these numbers, at the present values of all.
  ParameterDerivatives(const TaylorEvaluator& equations, const std::vector<int>& parameters);

  // Returns whether they contain x or x', by form.
  bool depend_on_solution() const;
  // F_p, m x parameters. jet: x and x', n values each. Throws Failure if F cannot be evaluated.
  Matrix at(double t, const double* jet);

 private:
  ParameterDerivatives(const TaylorEvaluator& equations, int count, ParameterGradient gradient);

  int m_, count_;
  std::vector<ParameterGradient::Place> places_;
  TaylorEvaluator evaluator_;  // of the formulas recorded for them
  std::vector<double> values_;
};

}  // namespace sfdae::core
