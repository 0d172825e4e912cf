// Which instruction set lanes are computed with.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/lanes.h"

#include <atomic>

namespace sfdae::core {

namespace {

// Not AVX2: with GCC 12, which moves eight numbers piece by piece, it takes 1.25 to 1.4 times as long as portable code
// (docs/decisions/36-evaluation-of-stages.md).
InstructionSet best_instruction_set() {
  return has_instruction_set(InstructionSet::avx512) ? InstructionSet::avx512 : InstructionSet::portable;
}

std::atomic<InstructionSet>& chosen() {
  static std::atomic<InstructionSet> set = best_instruction_set();
  return set;
}

}  // namespace

InstructionSet instruction_set() { return chosen().load(std::memory_order_relaxed); }

bool has_instruction_set(InstructionSet set) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (set == InstructionSet::avx512) return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
  if (set == InstructionSet::avx2) return __builtin_cpu_supports("avx2");
#endif
  return set == InstructionSet::portable;
}

void use_instruction_set(InstructionSet set) { chosen().store(set, std::memory_order_relaxed); }

}  // namespace sfdae::core
