// Orders of Taylor coefficients that operands are needed to.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/order_limits.h"

#include <cstddef>

#include "expression/point_function.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

bool has_two_operands(Code code) {
  return InstructionList::is_binary(code) || code == Code::divide || code == Code::divide_by_number ||
         code == Code::power || code == Code::atan2 || code == Code::modulo;
}

template <class Visit>
void for_each_operand(const Instruction& instruction, Visit visit) {
  if (instruction.code == Code::function) {
    for (int k = 0; k < instruction.call->function->num_arguments(); ++k) visit(instruction.a + k);
    return;
  }
  visit(instruction.a);
  if (has_two_operands(instruction.code) || instruction.code == Code::choose) visit(instruction.b);
  if (instruction.code == Code::choose) visit(instruction.c);
}

// Slots of derivatives are read as values where sine and cosine share an instruction. Slot 0 stands for none.
template <class Visit>
void for_each_result(const Instruction& instruction, Visit visit) {
  visit(instruction.v);
  if (instruction.p > 0) visit(instruction.p);
}

}  // namespace

InstructionsByOrder::InstructionsByOrder(const Tape& tape, const OrderLimits& limits) {
  std::vector<int> order_of(index(tape.num_slots), 0);
  for (std::size_t i = 0; i < tape.residuals.size(); ++i) {
    int& order = order_of[index(tape.residuals[i])];
    order = std::max(order, limits.of_equations[i]);
  }
  const std::vector<Instruction> all = tape.of_state.all();
  std::vector<int> order_of_instruction(all.size());
  for (std::size_t k = all.size(); k-- > 0;) {
    int order = 0;
    for_each_result(all[k], [&](int slot) { order = std::max(order, order_of[index(slot)]); });
    for_each_operand(all[k], [&](int slot) { order_of[index(slot)] = std::max(order_of[index(slot)], order); });
    order_of_instruction[k] = order;
  }
  lists.resize(index(limits.highest + 1));
  for (std::size_t k = 0; k < all.size(); ++k) lists[index(order_of_instruction[k])].push_back(all[k]);
  for (InstructionList& list : lists) list.finish();
  for (const Tape::Leaf& leaf : tape.leaves) of_leaves.push_back(order_of[index(leaf.slot)]);
}

void InstructionsByOrder::to_offsets(const Tape& tape, int n, int stride) {
  for (InstructionList& list : lists) list = list.in_offsets(stride);
  for (std::size_t i = 0; i < of_leaves.size(); ++i) {
    const Tape::Leaf& leaf = tape.leaves[i];
    for (int k = 0; k <= of_leaves[i]; ++k) {
      const int column = leaf.derivative ? k + 1 : k;
      loads.push_back({leaf.unknown + column * n, leaf.slot * stride + k, leaf.derivative ? k + 1 : 1});
    }
  }
  loads.shrink_to_fit();
}

}  // namespace sfdae::core
