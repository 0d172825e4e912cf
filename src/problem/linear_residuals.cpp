// Linear equations as total derivatives of their residuals.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/linear_residuals.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

LinearResiduals::LinearResiduals(const LinearFunctions& functions)
    : functions_(functions), matrix_(index(functions.m) * index(functions.n)), vector_(index(functions.m)) {}

// Returns the result of the user's function, as the others do.
int LinearResiduals::find_matrix(char which, double t, int order) {
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  if (order > 0 && (which == 'E' ? functions_.constant_E : functions_.constant_A)) return 0;
  return (which == 'E' ? functions_.E : functions_.A)(t, order, matrix_.data(), functions_.user);
}

// F^(k) = sum_r (k over r) (E^(k - r) x^(r + 1) - A^(k - r) x^(r)) - f^(k)
int LinearResiduals::add(double t, int order, const double* derivatives, double* F) {
  const int m = functions_.m, n = functions_.n;
  double binomial = 1.0;  // k over r
  for (int r = 0; r <= order; ++r) {
    for (const char which : {'E', 'A'}) {
      const int code = find_matrix(which, t, order - r);
      if (code != 0) return code;
      const double* const x = derivatives + index(n) * index(which == 'E' ? r + 1 : r);
      for (int j = 0; j < n; ++j) {
        const double factor = (which == 'E' ? binomial : -binomial) * x[j];
        for (int i = 0; i < m; ++i) F[i] += factor * matrix_[index(i) + index(m) * index(j)];
      }
    }
    binomial = binomial * (order - r) / (r + 1);
  }
  if (functions_.f == nullptr) return 0;
  std::fill(vector_.begin(), vector_.end(), 0.0);
  const int code = functions_.f(t, order, vector_.data(), functions_.user);
  for (int i = 0; i < m; ++i) F[i] -= vector_[index(i)];
  return code;
}

int LinearResiduals::evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                              void* user) {
  auto& own = *static_cast<LinearResiduals*>(user);
  int code = own.add(t, order, derivatives, F);
  if (code == 0 && F_xdot != nullptr) {
    code = own.find_matrix('E', t, order);
    std::copy(own.matrix_.begin(), own.matrix_.end(), F_xdot);
  }
  if (code == 0 && F_x != nullptr) {
    code = own.find_matrix('A', t, order);
    std::transform(own.matrix_.begin(), own.matrix_.end(), F_x, [](double a) { return -a; });
  }
  return code;
}

}  // namespace sfdae::core
