// Which instruction set lanes are computed with.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/lanes.h"

#include <atomic>

namespace sfdae::core {

namespace {

// Not AVX2: with GCC 12, which moves eight numbers piece by piece, it takes 1.25 to 1.4 times as long as portable code
// (docs/decisions/36-evaluation-of-stages.md).
std::atomic<InstructionSet>& chosen() {
  static std::atomic<InstructionSet> set =
      best_instruction_set() == InstructionSet::avx512 ? InstructionSet::avx512 : InstructionSet::portable;
  return set;
}

}  // namespace

InstructionSet instruction_set_of_lanes() { return chosen().load(std::memory_order_relaxed); }

void use_for_lanes(InstructionSet set) { chosen().store(set, std::memory_order_relaxed); }

}  // namespace sfdae::core
