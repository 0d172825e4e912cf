// Companions of the steps of x.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/companion.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void discretized_slope(const TriedStep& tried, int i, std::vector<double>& xdot) {
  const std::size_t n = xdot.size();
  if (tried.method == nullptr) {
    for (std::size_t k = 0; k < n; ++k) xdot[k] = tried.c * tried.x[k] + tried.rest[k];
    return;
  }
  std::fill(xdot.begin(), xdot.end(), 0.0);
  for (int j = 0; j < tried.method->s; ++j)
    for (std::size_t k = 0; k < n; ++k)
      xdot[k] += tried.method->D_at(i, j) / tried.h * (tried.x[n * index(j) + k] - tried.x_start[k]);
}

}  // namespace sfdae::core
