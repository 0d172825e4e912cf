// Slots that an instruction of a tape reads.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "expression/tape.h"

namespace sfdae::core {

// Also the leaf that stands for none; those of functions follow each other.
template <class Take>
void for_operands(const Instruction& instruction, Take take) {
  if (instruction.code == Code::function) {
    for (int slot = instruction.a; slot < instruction.b; ++slot) take(slot);
    return;
  }
  for (const int slot : {instruction.a, instruction.b, instruction.c})
    if (slot >= 0) take(slot);
}

}  // namespace sfdae::core
