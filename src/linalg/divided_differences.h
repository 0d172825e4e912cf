// Divided differences of vectors.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "linalg/index.h"

namespace sfdae::core {

// to := (to - from) / gap.
inline void take_difference(double* __restrict to, const double* __restrict from, double gap, std::size_t size) {
  const double per_gap = 1.0 / gap;
  for (std::size_t r = 0; r < size; ++r) to[r] = (to[r] - from[r]) * per_gap;
}

// Replaces values by divided differences; column(i), of `size` numbers, belongs to times[i], i < count.
template <class Times, class Column>
void divided_differences(const Times& times, int count, std::size_t size, Column column) {
  for (int k = 1; k < count; ++k)
    for (int i = count - 1; i >= k; --i)
      take_difference(column(i), column(i - 1), times[index(i)] - times[index(i - k)], size);
}

}  // namespace sfdae::core
