// SPDX-License-Identifier: BSD-3-Clause
// Runs the same with every instruction set of lanes that the machine has.
#ifndef SFDAE_TESTS_INSTRUCTION_SETS_H
#define SFDAE_TESTS_INSTRUCTION_SETS_H

#include "linalg/lanes.h"

namespace sfdae_test {

// The one in use is what it was before in the end.
template <class Action>
void for_each_instruction_set(Action action) {
  using sfdae::core::InstructionSet;
  const InstructionSet before = sfdae::core::instruction_set_of_lanes();
  for (const InstructionSet set : {InstructionSet::portable, InstructionSet::avx512}) {
    if (!sfdae::core::has_instruction_set(set)) continue;
    sfdae::core::use_for_lanes(set);
    action(set);
  }
  sfdae::core::use_for_lanes(before);
}

}  // namespace sfdae_test

#endif
