// What users accept: tolerances of the components, and contradictions of redundant equations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

struct Tolerances {
  std::vector<double> rtol, atol;  // n each
  bool operator==(const Tolerances&) const = default;
};

// Of consistent values and of an integration alike.
struct Acceptance {
  Tolerances tolerances;
  bool ignore_inconsistency = false;
  double consistency_tol = 1e-8;  // relative size of a contradiction that counts
};

}  // namespace sfdae::core
