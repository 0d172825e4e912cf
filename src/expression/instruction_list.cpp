// Lists of instructions: appending, copies with offsets.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/tape.h"

#include <utility>

namespace sfdae::core {

void InstructionList::push_back(const Instruction& instruction) {
  const bool binary = is_binary(instruction.code);
  const bool continues =
      !runs_.empty() && (binary ? runs_.back().code == instruction.code : !is_binary(runs_.back().code));
  if (continues) ++runs_.back().count;
  else runs_.push_back({instruction.code, -1, 1});
  if (!binary) {
    others_.push_back(instruction);
    return;
  }
  operands_.push_back({instruction.a, instruction.b});
  results_.push_back(instruction.v);
}

void InstructionList::finish() {
  std::vector<int> listed;
  const int* result = results_.data();
  for (Run& run : runs_) {
    if (!is_binary(run.code)) continue;
    const int first = *result;
    const auto count = static_cast<int>(run.count);
    bool are_in_a_row = true;
    for (int k = 0; k < count; ++k) are_in_a_row = are_in_a_row && result[k] == first + k;
    if (are_in_a_row) run.result = first;
    else listed.insert(listed.end(), result, result + count);
    result += count;
  }
  results_ = std::move(listed);
  runs_.shrink_to_fit();
  operands_.shrink_to_fit();
  results_.shrink_to_fit();
  others_.shrink_to_fit();
}

void InstructionList::renumber(const std::vector<int>& number) {
  for (int& result : results_) result = number[index(result)];
  for (Operands& operands : operands_)
    for (int* slot : {&operands.a, &operands.b}) *slot = number[index(*slot)];
  for (Instruction& other : others_) {
    const int arguments = other.b - other.a;
    for (int* slot : {&other.v, &other.a, &other.b, &other.c, &other.p, &other.q}) *slot = number[index(*slot)];
    if (other.code == Code::function) other.b = other.a + arguments;
  }
}

std::vector<Instruction> InstructionList::all() const {
  std::vector<Instruction> result;
  const Operands* operands = this->operands();
  const int* listed = listed_results();
  const Instruction* other = others();
  for (const Run& run : runs_)
    for (int k = 0; k < static_cast<int>(run.count); ++k) {
      if (!is_binary(run.code)) {
        result.push_back(*other++);
        continue;
      }
      const int v = run.result >= 0 ? run.result + k * step_ : *listed++;
      result.push_back({run.code, v, operands->a, operands->b, 0, 0, 0});
      ++operands;
    }
  return result;
}

InstructionList InstructionList::in_offsets(int stride) const {
  InstructionList result = *this;
  result.step_ *= stride;
  for (Run& run : result.runs_)
    if (run.result >= 0) run.result *= stride;
  for (int& listed : result.results_) listed *= stride;
  for (Operands& operands : result.operands_)
    for (int* slot : {&operands.a, &operands.b}) *slot *= stride;
  for (Instruction& other : result.others_)
    for (int* slot : {&other.v, &other.a, &other.b, &other.c, &other.p, &other.q}) *slot *= stride;
  return result;
}

}  // namespace sfdae::core
