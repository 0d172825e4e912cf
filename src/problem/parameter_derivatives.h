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
  // By the parameters with these numbers, at the values that all have now.
  ParameterDerivatives(const TaylorEvaluator& equations, const std::vector<int>& parameters);

  // By form: on x or x'.
  bool depend_on_solution() const;
  // F_p, m x parameters. jet: x and x', n values each. Throws Failure where F cannot be evaluated.
  Matrix at(double t, const double* jet);

 private:
  ParameterDerivatives(const TaylorEvaluator& equations, int count, ParameterGradient gradient);

  int m_, count_;
  std::vector<ParameterGradient::Place> places_;
  TaylorEvaluator evaluator_;  // of the formulas recorded for them
  std::vector<double> values_;
};

}  // namespace sfdae::core
