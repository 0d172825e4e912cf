// Sizes of the components of x over a step.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_scales.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

void StepScales::resize(std::size_t n) {
  largest_.assign(n, 0.0);
  nearby_.assign(n, 0.0);
}

void StepScales::update(ErrorWeights& weights, const RadauNode& start, const RadauNode& end) {
  const double h = end.t - start.t;
  for (std::size_t i = 0; i < end.x.size(); ++i) {
    largest_[i] = std::max(std::fabs(start.x[i]), std::fabs(end.x[i]));
    nearby_[i] = std::max({largest_[i], std::fabs(h * start.xdot[i]), std::fabs(h * end.xdot[i])});
  }
  weights.update(largest_.data(), nearby_.data());
}

}  // namespace sfdae::core
