// Linear equations with matrices by functions, as total derivatives of F = E x' - A x - f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sfdae/expression.h"

namespace sfdae::core {

class LinearResiduals {
 public:
  // Functions of the problem must outlive this object. It has no patterns and no prescribed inputs.
  explicit LinearResiduals(const sfdae_linear_problem& problem);

  // A sfdae_total_derivative_function; user: a LinearResiduals.
  static int evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user);

 private:
  int find_matrix(char which, double t, int order);
  int add(double t, int order, const double* derivatives, double* F);

  int m_, n_;
  sfdae_matrix_function E_, A_;
  sfdae_vector_function f_;
  void* user_;
  bool is_constant_E_, is_constant_A_;
  std::vector<double> matrix_, vector_;
};

}  // namespace sfdae::core
