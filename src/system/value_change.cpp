// The largest change of what was to stay as given.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/value_change.h"

#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

ValueChange largest_change(const double* given, const double* changes, const std::vector<double>& tolerances,
                           int count) {
  ValueChange largest;
  for (int i = 0; i < count; ++i) {
    const double size = std::fabs(changes[i]);
    if (size == 0.0) continue;
    const double tolerance = tolerances[index(i)];
    const double ratio = tolerance > 0.0 ? size / tolerance : std::numeric_limits<double>::max();
    if (ratio > largest.in_tolerances) largest = {i, given[i], given[i] + changes[i], ratio, false};
  }
  return largest;
}

}  // namespace sfdae::core
