// Linear equations with matrices by functions, as total derivatives of F = E x' - A x - f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/linear_problem.h"

namespace sfdae::core {

class LinearResiduals {
 public:
  // functions: with dense matrices, nothing prescribed.
  explicit LinearResiduals(const LinearFunctions& functions);

  // A sfdae_total_derivative_function; user: a LinearResiduals.
  static int evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user);

 private:
  int find_matrix(char which, double t, int order);
  int add(double t, int order, const double* derivatives, double* F);

  LinearFunctions functions_;
  std::vector<double> matrix_, vector_;
};

}  // namespace sfdae::core
