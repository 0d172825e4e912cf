// An implicit Runge-Kutta method of collocation type: interface for the systems that solve its stages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>

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

}  // namespace sfdae::core
