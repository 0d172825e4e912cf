// The instructions of a list in their order, on slots of numbers or of lanes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>

#include "expression/tape.h"

namespace sfdae::core {

// binary(code, a, b, v): one of the binary instructions, the code known to the compiler, so that there is one loop
// for each; other(instruction).
template <class Slot, class Binary, class Other>
void execute_list(const InstructionList& list, Slot* slots, Binary binary, Other other) {
  const InstructionList::Operands* next = list.operands();
  const int* next_result = list.listed_results();
  const Instruction* next_other = list.others();
  const int step = list.step();
  const auto execute = [&](const InstructionList::Run& run, auto code) {
    const InstructionList::Operands* const last = next + run.count;
    if (run.result >= 0) {
      for (Slot* v = slots + run.result; next != last; ++next, v += step)
        binary(code, slots + next->a, slots + next->b, v);
      return;
    }
    for (; next != last; ++next) binary(code, slots + next->a, slots + next->b, slots + *next_result++);
  };
  for (const InstructionList::Run& run : list.runs()) {
    switch (run.code) {
      case Code::add: execute(run, std::integral_constant<Code, Code::add>()); break;
      case Code::subtract: execute(run, std::integral_constant<Code, Code::subtract>()); break;
      case Code::multiply: execute(run, std::integral_constant<Code, Code::multiply>()); break;
      case Code::scale: execute(run, std::integral_constant<Code, Code::scale>()); break;
      default:
        for (const Instruction* const end = next_other + run.count; next_other != end; ++next_other)
          other(*next_other);
    }
  }
}

// All of a list, values alone, one number in each slot.
void execute_values(const InstructionList& list, double* slots);

}  // namespace sfdae::core
