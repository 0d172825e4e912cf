// Which instruction set lanes are computed with.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/lanes.h"

#include <atomic>

namespace sfdae::core {

namespace {

InstructionSet best_instruction_set() {
  if (has_instruction_set(InstructionSet::avx512)) return InstructionSet::avx512;
  return has_instruction_set(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::portable;
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
