// Divided differences of vectors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace sfdae::core {

// to := (to - from) / gap.
inline void take_difference(double* __restrict to, const double* __restrict from, double gap, std::size_t size) {
  const double per_gap = 1.0 / gap;
  for (std::size_t r = 0; r < size; ++r) to[r] = (to[r] - from[r]) * per_gap;
}

}  // namespace sfdae::core
