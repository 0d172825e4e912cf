// Which loops are taken.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kernels_in_use.h"

#include <cstdlib>
#include <cstring>

namespace sfdae::core::kernels {

namespace {

#if (defined(__x86_64__) || defined(__i386__)) && defined(__GNUC__)
bool has(InstructionSet set) {
  if (set == InstructionSet::avx512) return __builtin_cpu_supports("avx512f") && has(InstructionSet::avx2);
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
#else
bool has(InstructionSet) { return false; }
#endif

const Loops& best_loops() {
  const char* wanted = std::getenv("SFDAE_INSTRUCTIONS");
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    const Loops* found = loops_for(set);
    if (wanted != nullptr && std::strcmp(wanted, "portable") == 0) continue;
    if (wanted != nullptr && std::strcmp(wanted, "avx2") == 0 && set == InstructionSet::avx512) continue;
    if (found != nullptr) return *found;
  }
  return *portable_loops();
}

}  // namespace

const Loops* loops_for(InstructionSet set) {
  if (set == InstructionSet::portable) return portable_loops();
  if (!has(set)) return nullptr;
  return set == InstructionSet::avx2 ? avx2_loops() : avx512_loops();
}

std::atomic<const Loops*> loops_in_use{nullptr};

const Loops& choose_loops() {
  const Loops& best = best_loops();
  loops_in_use.store(&best, std::memory_order_relaxed);
  return best;
}

}  // namespace sfdae::core::kernels
