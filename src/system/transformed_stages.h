// The stages of an implicit Runge-Kutta step, decoupled if one form holds for all of them.
//
// The s (d + u) equations  tau/h sum_j D_ij [G; Uz^T] z_j - [B; 0] z_i = r_i  become, transformed by T, one real
// system and (s-1)/2 complex ones of order d + u [HW96, IV.8].
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <vector>

#include "linalg/arena.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "reduction/null_space_form.h"
#include "system/stage_method.h"

namespace sfdae::core {

// b = a M^T for q rows, a column for each stage. a and b may be the same.
inline void transform_stages(const StageMatrix& M, int s, ConstView a, View b) {
  with_stages(s, [&](auto stages) {
    for (int i = 0; i < a.rows; ++i) {
      std::array<double, max_stages> row{};
      for (int k = 0; k < stages; ++k) row[index(k)] = a(i, k);
      const std::array<double, max_stages> result = product(M, stages, row);
      for (int k = 0; k < stages; ++k) b(i, k) = result[index(k)];
    }
  });
}

// rho = T^-1 r; one real and (s-1)/2 complex systems for zeta; z = T zeta, for the q rows of r, rho and z, a column for
// each stage. solve(x) and solve_pair(k, omega) solve these systems in place. r and z may be the same; omega has q
// numbers.
template <class Solve, class SolvePair>
void solve_decoupled(const StageMethod& method, ConstView r, View rho, View z, std::complex<double>* omega,
                     Solve solve, SolvePair solve_pair) {
  const int s = method.s, q = rho.rows;
  transform_stages(method.T_inverse, s, r, rho);
  solve(rho.column(0));
  for (int k = 0; 2 * k + 2 < s; ++k) {
    double* first = rho.column(2 * k + 1);
    double* second = rho.column(2 * k + 2);
    for (int i = 0; i < q; ++i) omega[i] = {first[i], -second[i]};
    solve_pair(index(k), omega);
    for (int i = 0; i < q; ++i) {
      first[i] = omega[i].real();
      second[i] = -omega[i].imag();
    }
  }
  transform_stages(method.T, s, rho, z);
}

class TransformedStages {
 public:
  // Factors [c tau G - B; c tau Uz^T] for c = lambda_k / h, h = gamma / c_real, unless that is done. False if
  // singular. count: of factorizations, raised.
  // Form: has unknowns() and step_matrix() as NullSpaceForm.
  template <class Form>
  bool factor(const Form& form, double tau, const StageMethod& method, double c_real, long& count);
  // Another form holds from now on.
  void forget();
  // lu, pivots: the factored matrix for c_real. r, z: a column for each stage.
  void solve(const StageMethod& method, ConstView lu, const int* pivots, ConstView r, View z, Arena& arena);
  // The complex system of pair k alone, and its c.
  void solve_pair(std::size_t k, std::complex<double>* omega);
  std::complex<double> c_of_pair(std::size_t k) const { return values_[k]; }

 private:
  static constexpr std::size_t max_pairs = (max_stages - 1) / 2;
  std::array<std::vector<std::complex<double>>, max_pairs> matrices_;
  std::array<std::vector<int>, max_pairs> pivots_;
  std::array<std::complex<double>, max_pairs> values_{};
  int order_ = 0;  // of the factored matrices
  std::vector<std::complex<double>> omega_;
};

template <class Form>
bool TransformedStages::factor(const Form& form, double tau, const StageMethod& method, double c_real, long& count) {
  const int q = form.unknowns();
  const std::size_t order = index(q);
  omega_.resize(order + 1);
  order_ = q;
  for (std::size_t k = 0; 2 * static_cast<int>(k) + 2 < method.s; ++k) {
    const std::complex<double> c = method.lambda[k] * (c_real / method.gamma);
    std::vector<std::complex<double>>& matrix = matrices_[k];
    if (!matrix.empty() && values_[k] == c) continue;
    pivots_[k].resize(order + 1);
    matrix.resize(order * order + 1);  // last: a matrix that is not empty counts as factored for values_[k]
    const ComplexView M{matrix.data(), q, q, std::max(q, 1)};
    form.step_matrix(c * tau, M);
    if (q > 0) ++count;
    values_[k] = c;
    if (factor_lu(M, pivots_[k].data())) continue;
    matrix.clear();
    return false;
  }
  return true;
}

}  // namespace sfdae::core
