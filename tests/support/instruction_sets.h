// SPDX-License-Identifier: BSD-3-Clause
// Runs the same with every instruction set that the machine has.
#ifndef SFDAE_TESTS_INSTRUCTION_SETS_H
#define SFDAE_TESTS_INSTRUCTION_SETS_H

#include "linalg/lanes.h"

namespace sfdae_test {

// The one in use is what it was before in the end.
template <class Action>
void for_each_instruction_set(Action action) {
  using sfdae::core::InstructionSet;
  const InstructionSet before = sfdae::core::instruction_set();
  for (const InstructionSet set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (!sfdae::core::has_instruction_set(set)) continue;
    sfdae::core::use_instruction_set(set);
    action(set);
  }
  sfdae::core::use_instruction_set(before);
}

}  // namespace sfdae_test

#endif
