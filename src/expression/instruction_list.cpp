// Lists of instructions: appending, copies with offsets.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/tape.h"

namespace sfdae::core {

void InstructionList::push_back(const Instruction& instruction) {
  const bool binary = is_binary(instruction.code);
  const bool continues =
      !runs_.empty() && (binary ? runs_.back().code == instruction.code : !is_binary(runs_.back().code));
  if (continues) ++runs_.back().count;
  else runs_.push_back({instruction.code, 1});
  if (binary) binary_.push_back({instruction.v, instruction.a, instruction.b});
  else others_.push_back(instruction);
}

void InstructionList::shrink_to_fit() {
  runs_.shrink_to_fit();
  binary_.shrink_to_fit();
  others_.shrink_to_fit();
}

std::vector<Instruction> InstructionList::all() const {
  std::vector<Instruction> result;
  const Binary* binary = this->binary();
  const Instruction* other = others();
  for (const Run& run : runs_)
    for (std::size_t k = 0; k < run.count; ++k) {
      if (!is_binary(run.code)) {
        result.push_back(*other++);
        continue;
      }
      result.push_back({run.code, binary->v, binary->a, binary->b, 0, 0, 0});
      ++binary;
    }
  return result;
}

InstructionList InstructionList::in_offsets(int stride) const {
  InstructionList result = *this;
  for (Binary& binary : result.binary_)
    for (int* slot : {&binary.v, &binary.a, &binary.b}) *slot *= stride;
  for (Instruction& other : result.others_)
    for (int* slot : {&other.v, &other.a, &other.b, &other.c, &other.p, &other.q}) *slot *= stride;
  return result;
}

}  // namespace sfdae::core
