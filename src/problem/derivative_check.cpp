// Compares derivatives that callbacks supply with differences of the order below.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/derivative_check.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

void compare(LinearProblem& problem, char which, double t, int order, DerivativeMismatch& worst) {
  const int rows = problem.m(), count = which == 'f' ? rows : rows * problem.n();
  SuppliedDerivative supplied{which, order, rows, 0, std::vector<double>(index(count))};
  const CallbackError error = problem.call(which, t, order, supplied.values.data());
  if (error.status == SFDAE_ORDER_MISSING) return;
  if (error.status != SFDAE_OK) error.raise();
  const double unit = unit_of_time(t);
  compare_with_differences(
      supplied, unit,
      [&](double offset, double* values) { return problem.call(which, t + offset, order - 1, values); }, worst);
}

}  // namespace

DerivativeMismatch check_derivatives(LinearProblem& problem, double t, int max_order) {
  DerivativeMismatch worst;
  // An order is judged by the one below: beyond the first mistake nothing can be said.
  for (int order = 1; order <= max_order && !worst.suspicious(); ++order)
    for (char which : {'E', 'A', 'f'})
      if (!problem.is_constant(which)) compare(problem, which, t, order, worst);
  return worst;
}

}  // namespace sfdae::core
