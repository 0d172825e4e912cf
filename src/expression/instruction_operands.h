// Slots that an instruction of a tape reads and writes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"
#include "linalg/index.h"

namespace sfdae::core {

// Includes the leaf that stands for no operand; operands of functions are adjacent.
template <class Take>
void for_operands(const Instruction& instruction, Take take) {
  if (instruction.code == Code::function) {
    for (int slot = instruction.a; slot < instruction.b; ++slot) take(slot);
    return;
  }
  for (const int slot : {instruction.a, instruction.b, instruction.c})
    if (slot >= 0) take(slot);
}

// Slots of values that others read; of either kind of instruction.
template <class AnyInstruction, class Take>
void for_results(AnyInstruction& instruction, Take take) {
  take(instruction.v);
  if (has_two_results(instruction)) take(instruction.p);
}

// Flags of the slots that instructions write which depend on t alone.
inline std::vector<char> slots_of_time(const Tape& tape) {
  std::vector<char> flags(index(tape.num_slots), 0);
  for (const Instruction& instruction : tape.of_time.all())
    for_results(instruction, [&](int slot) { flags[index(slot)] = 1; });
  return flags;
}

}  // namespace sfdae::core
