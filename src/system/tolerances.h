// Tolerances of the components.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

struct Tolerances {
  std::vector<double> rtol, atol;  // n each
};

}  // namespace sfdae::core
