// Jets side by side, for evaluations in lanes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "linalg/index.h"
#include "linalg/lanes.h"
#include "system/jet.h"

namespace sfdae::core {

struct JetLanes {
  LaneArray t, coefficients;

  // Loads the coefficients up to the order, n each, of the first `count` jets; the lanes beyond repeat the last one.
  void load(const std::vector<Jet>& jets, int count, int n, int order) {
    const std::size_t size = index(n) * index(order + 1);
    t.resize(1);
    coefficients.resize(size);
    for (int l = 0; l < lane_count; ++l) {
      const Jet& jet = jets[index(std::min(l, count - 1))];
      t[0].lane[l] = jet.t;
      for (std::size_t k = 0; k < size; ++k) coefficients[k].lane[l] = jet.x[k];
    }
  }
};

}  // namespace sfdae::core
