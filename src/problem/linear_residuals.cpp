// Linear equations as total derivatives of their residuals.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/linear_residuals.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

LinearResiduals::LinearResiduals(const sfdae_linear_problem& problem)
    : m_(problem.num_equations),
      n_(problem.num_unknowns),
      E_(problem.E),
      A_(problem.A),
      f_(problem.f),
      user_(problem.user),
      is_constant_E_(problem.constant_E != 0),
      is_constant_A_(problem.constant_A != 0),
      matrix_(index(m_) * index(n_)),
      vector_(index(m_)) {}

// Returns the result of the user's function, as the others do.
int LinearResiduals::find_matrix(char which, double t, int order) {
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  if (order > 0 && (which == 'E' ? is_constant_E_ : is_constant_A_)) return 0;
  return (which == 'E' ? E_ : A_)(t, order, matrix_.data(), user_);
}

// F^(k) = sum_r (k over r) (E^(k - r) x^(r + 1) - A^(k - r) x^(r)) - f^(k)
int LinearResiduals::add(double t, int order, const double* derivatives, double* F) {
  double binomial = 1.0;  // k over r
  for (int r = 0; r <= order; ++r) {
    for (const char which : {'E', 'A'}) {
      const int code = find_matrix(which, t, order - r);
      if (code != 0) return code;
      const double* const x = derivatives + index(n_) * index(which == 'E' ? r + 1 : r);
      for (int j = 0; j < n_; ++j) {
        const double factor = (which == 'E' ? binomial : -binomial) * x[j];
        for (int i = 0; i < m_; ++i) F[i] += factor * matrix_[index(i) + index(m_) * index(j)];
      }
    }
    binomial = binomial * (order - r) / (r + 1);
  }
  if (f_ == nullptr) return 0;
  std::fill(vector_.begin(), vector_.end(), 0.0);
  const int code = f_(t, order, vector_.data(), user_);
  for (int i = 0; i < m_; ++i) F[i] -= vector_[index(i)];
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
