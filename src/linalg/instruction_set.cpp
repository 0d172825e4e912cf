// Instruction sets with code of their own.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/instruction_set.h"

#include <cstdlib>
#include <string_view>

namespace sfdae::core {

bool has_instruction_set(InstructionSet set) {
#if defined(__x86_64__) && defined(__GNUC__)
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (set == InstructionSet::avx2) return has_avx2;
  if (set == InstructionSet::avx512)
    return has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
#endif
  return set == InstructionSet::portable;
}

InstructionSet best_instruction_set() {
  const char* variable = std::getenv("SFDAE_INSTRUCTIONS");
  const std::string_view wanted = variable != nullptr ? variable : "";
  if (wanted == "portable") return InstructionSet::portable;
  if (wanted != "avx2" && has_instruction_set(InstructionSet::avx512)) return InstructionSet::avx512;
  return has_instruction_set(InstructionSet::avx2) ? InstructionSet::avx2 : InstructionSet::portable;
}

}  // namespace sfdae::core
