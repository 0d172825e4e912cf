// Selection of the instruction set for lanes.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/lanes.h"

#include <atomic>

namespace sfdae::core {

namespace {

// AVX2 is used only in loops written for it: with GCC 12, which moves eight numbers piece by piece, all others take
// 1.25 to 1.4 times as long as portable code (docs/design/radau.md).
std::atomic<InstructionSet>& chosen() {
  static std::atomic<InstructionSet> set = best_instruction_set();
  return set;
}

}  // namespace

InstructionSet instruction_set_of_lanes() { return chosen().load(std::memory_order_relaxed); }

void use_for_lanes(InstructionSet set) { chosen().store(set, std::memory_order_relaxed); }

}  // namespace sfdae::core
