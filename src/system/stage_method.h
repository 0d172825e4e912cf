// An implicit Runge-Kutta method of collocation type: interface for the systems that solve its stages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <type_traits>

#include "linalg/index.h"

namespace sfdae::core {

inline constexpr int max_stages = 7;

// s x s, entry (i, j) at [i + j s].
using StageMatrix = std::array<double, index(max_stages* max_stages)>;

// The polynomial of degree s through w at t and at the stages t + c_i h has the slope sum_j D_ij (w_j - w) / h at
// stage i; c_s = 1. D is the inverse of the Runge-Kutta matrix. Its eigenvalues are one real one, gamma, and (s-1)/2
// conjugate pairs lambda_k = alpha_k + i beta_k:  T^-1 D T has the diagonal blocks gamma and [alpha beta; -beta
// alpha].
struct StageMethod {
  int s = 0;
  std::array<double, max_stages> c{};
  StageMatrix D{};
  double gamma = 0.0;
  std::array<std::complex<double>, (max_stages - 1) / 2> lambda{};
  StageMatrix T{}, T_inverse{};

  double D_at(int i, int j) const { return D[index(i + j * s)]; }
};

// use(s), with s as a constant where there is a method of s stages: loops over stages are short and need no counters
// then.
template <class Use>
void with_stages(int s, Use use) {
  switch (s) {
    case 1: return use(std::integral_constant<int, 1>());
    case 3: return use(std::integral_constant<int, 3>());
    case 5: return use(std::integral_constant<int, 5>());
    case 7: return use(std::integral_constant<int, 7>());
    default: return use(s);
  }
}

// M a, in the order of the columns. S: int, or a constant.
template <class S>
std::array<double, max_stages> product(const StageMatrix& M, S s, const std::array<double, max_stages>& a) {
  std::array<double, max_stages> sum{};
  for (int k = 0; k < s; ++k)
    for (int i = 0; i < s; ++i) sum[index(i)] += M[index(i + k * s)] * a[index(k)];
  return sum;
}

}  // namespace sfdae::core
