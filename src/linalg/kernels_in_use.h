// Loops in use: the best that the processor has.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "linalg/kernels.h"

namespace sfdae::core::kernels {

// The loops selected; nullptr before the selection.
extern std::atomic<const Loops*> loops_in_use;

// Loops of the best instruction set, best_instruction_set(), that this build contains.
const Loops& choose_loops();

inline const Loops& loops() {
  const Loops* chosen = loops_in_use.load(std::memory_order_relaxed);
  return chosen != nullptr ? *chosen : choose_loops();
}

}  // namespace sfdae::core::kernels
