// Conversions between derivatives and Taylor coefficients.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace sfdae::core {

inline double factorial(int k) {
  double product = 1.0;
  for (int r = 2; r <= k; ++r) product *= r;
  return product;
}

// Plain derivatives of a jet of n components, up to `order`, column after column.
inline void derivatives_of_jet(const double* jet, std::size_t n, int order, std::vector<double>& derivatives) {
  derivatives.resize(n * static_cast<std::size_t>(order + 1));
  for (int k = 0; k <= order; ++k) {
    const double factor = factorial(k);
    const std::size_t column = n * static_cast<std::size_t>(k);
    for (std::size_t i = column; i < column + n; ++i) derivatives[i] = factor * jet[i];
  }
}

}  // namespace sfdae::core
