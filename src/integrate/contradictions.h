// Redundant equations that contradict each other, as far as an integration has met them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "integrate/integration_options.h"

namespace sfdae::core {

struct Contradictions {
  // Whether the integration goes on in spite of the inconsistency, which is noted then.
  bool tolerate(double inconsistency, const IntegrationOptions& options) {
    if (inconsistency <= options.consistency_tol) return true;  // not NaN
    if (!options.ignore_inconsistency) return false;
    ignored_in_call = true;
    largest = std::max(largest, inconsistency);
    return true;
  }

  bool ignored_in_call = false;  // they were more than the user allows
  double largest = 0.0;
};

}  // namespace sfdae::core
