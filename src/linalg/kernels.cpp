// Selection of the loops for the processor.
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/kernels_in_use.h"

namespace sfdae::core::kernels {

namespace {

const Loops& best_loops() {
  const InstructionSet best = best_instruction_set();
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    const Loops* found = set <= best ? loops_for(set) : nullptr;
    if (found != nullptr) return *found;
  }
  return *portable_loops();
}

}  // namespace

const Loops* loops_for(InstructionSet set) {
  if (set == InstructionSet::portable) return portable_loops();
  if (!has_instruction_set(set)) return nullptr;
  return set == InstructionSet::avx2 ? avx2_loops() : avx512_loops();
}

std::atomic<const Loops*> loops_in_use{nullptr};

const Loops& choose_loops() {
  const Loops& best = best_loops();
  loops_in_use.store(&best, std::memory_order_relaxed);
  return best;
}

}  // namespace sfdae::core::kernels
