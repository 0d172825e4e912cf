// The derivatives of a polynomial at another point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace sfdae::core {

// derivatives: n in each column, those of orders 0, 1, ... at one point; those at a distance s.
inline std::vector<double> shifted_jet(const std::vector<double>& derivatives, std::size_t n, double s) {
  const std::size_t columns = derivatives.size() / n;
  std::vector<double> shifted(derivatives);
  for (std::size_t k = 0; k < columns; ++k) {
    double factor = 1.0;  // s^i / i!
    for (std::size_t i = 1; k + i < columns; ++i) {
      factor *= s / static_cast<double>(i);
      for (std::size_t j = 0; j < n; ++j) shifted[n * k + j] += factor * derivatives[n * (k + i) + j];
    }
  }
  return shifted;
}

}  // namespace sfdae::core
