// The matrix of a step, factored.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/step_matrix.h"

namespace sfdae::core {

void StepMatrix::resize(int largest_order) {
  entries_.assign(index(largest_order) * index(largest_order) + 1, 0.0);
  pivots_.assign(index(largest_order) + 1, 0);
}

void StepMatrix::forget() {
  is_valid_ = false;
  stages_.forget();
}

}  // namespace sfdae::core
