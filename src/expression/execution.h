// The instructions of a list in their order, on slots of numbers or of lanes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>

#include "expression/tape.h"

namespace sfdae::core {

// binary(code, a, b, v): one of the binary instructions, the code known to the compiler, so that there is one loop for each; other(instruction).
template <class Slot, class Binary, class Other>
void execute_list(const InstructionList& list, Slot* slots, Binary binary, Other other) {
  const InstructionList::Binary* next = list.binary();
  const Instruction* next_other = list.others();
  const auto run = [&](std::size_t count, auto code) {
    for (const InstructionList::Binary* const last = next + count; next != last; ++next)
      binary(code, slots + next->a, slots + next->b, slots + next->v);
  };
  for (const auto& [code, count] : list.runs()) {
    switch (code) {
      case Code::add: run(count, std::integral_constant<Code, Code::add>()); break;
      case Code::subtract: run(count, std::integral_constant<Code, Code::subtract>()); break;
      case Code::multiply: run(count, std::integral_constant<Code, Code::multiply>()); break;
      case Code::scale: run(count, std::integral_constant<Code, Code::scale>()); break;
      default:
        for (const Instruction* const last = next_other + count; next_other != last; ++next_other) other(*next_other);
    }
  }
}

}  // namespace sfdae::core
