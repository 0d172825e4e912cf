// Contradictions between redundant equations that an integration has found.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "integrate/integration_options.h"

namespace sfdae::core {

struct Contradictions {
  // True if the integration continues despite the inconsistency, which is recorded then.
  bool tolerate(double inconsistency, const IntegrationOptions& options) {
    if (inconsistency <= options.consistency_tol) return true;  // not NaN
    if (!options.ignore_inconsistency) return false;
    ignored_in_call = true;
    largest = std::max(largest, inconsistency);
    return true;
  }

  bool ignored_in_call = false;  // some exceeded the tolerance
  double largest = 0.0;
};

}  // namespace sfdae::core
