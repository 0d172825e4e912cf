// A step tried by a Radau method.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_stages.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void slope_of_stages(const SlopeFormula& formula, const std::vector<double>& start, const std::vector<double>& values,
                     double* slope) {
  const std::size_t size = start.size();
  std::fill_n(slope, size, 0.0);
  for (int j = 0; j < formula.s; ++j) {
    const double weight = formula.weights[j * formula.stride] / formula.h;
    const double* column = values.data() + size * index(j);
    for (std::size_t r = 0; r < size; ++r) slope[r] += weight * (column[r] - start[r]);
  }
}

void RadauStages::resize(std::size_t n, std::size_t size_w, int most_stages) {
  x.assign(n * index(most_stages), 0.0);
  w.assign(size_w * index(most_stages), 0.0);
}

void RadauStages::take_end(const RadauMethod& method, const RadauNode& start, RadauNode& end) const {
  const int s = method.s();
  const std::size_t n = start.x.size(), size_w = start.w.size();
  std::copy_n(x.data() + n * index(s - 1), n, end.x.data());
  std::copy_n(w.data() + size_w * index(s - 1), size_w, end.w.data());
  const SlopeFormula last_row{s, method.stages.D.data() + (s - 1), s, end.t - start.t};
  slope_of_stages(last_row, start.w, w, end.wdot.data());
  slope_of_stages(last_row, start.x, x, end.xdot.data());
}

}  // namespace sfdae::core
