// What of a tape has to be done for those derivatives alone that are no numbers.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/varying_entries.h"

#include <algorithm>

#include "expression/point_function.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

bool hands_on_numbers(const Edge& edge) {
  return edge.from_number &&
         (edge.code == EdgeCode::pass || edge.code == EdgeCode::negate || edge.code == EdgeCode::scale);
}

int results_of(const Instruction& instruction) {
  return instruction.code == Code::function ? instruction.call->function->num_arguments() : 1;
}

}  // namespace

void VaryingEntries::set(const Tape& tape, int stride) {
  stride_ = 0;  // while memory may be missing
  version = -1;
  instructions_.clear();
  rows_.clear();
  edges_.clear();
  targets_.clear();
  std::vector<char> is_needed(index(tape.num_slots), 0);  // of values, as factors
  for (std::size_t i = 0; i < tape.residuals.size(); ++i) choose_edges(tape, static_cast<int>(i), is_needed);
  for (auto next = tape.of_state.rbegin(); next != tape.of_state.rend(); ++next) {
    const Instruction& instruction = *next;
    bool is_used =
        is_needed[index(instruction.v)] != 0 || (instruction.q > 0 && is_needed[index(instruction.q)] != 0);
    for (int k = 0; k < results_of(instruction) && instruction.p > 0; ++k)
      is_used = is_used || is_needed[index(instruction.p + k)] != 0;
    if (!is_used) continue;
    instructions_.push_back(instruction);
    for (int operand : {instruction.a, instruction.b, instruction.c})
      if (operand > 0) is_needed[index(operand)] = 1;
    for (int k = 1; k < results_of(instruction); ++k) is_needed[index(instruction.a + k)] = 1;
  }
  std::reverse(instructions_.begin(), instructions_.end());
  for (Instruction& instruction : instructions_)
    for (int* slot : {&instruction.v, &instruction.a, &instruction.b, &instruction.c, &instruction.p, &instruction.q})
      *slot *= stride;
  for (Edge& edge : edges_)
    for (int* slot : {&edge.from, &edge.to, &edge.factor}) *slot *= stride;
  stride_ = stride;
}

// Edges come from the residual to the leaves. A sum of numbers is one; what is handed on to something that varies is needed, whether
// it varies or not.
void VaryingEntries::choose_edges(const Tape& tape, int equation, std::vector<char>& is_needed) {
  const Edge* const first = tape.edges.data() + tape.first_edge[index(equation)];
  const Edge* const last = tape.edges.data() + tape.first_edge[index(equation + 1)];
  std::vector<int> varying, wanted;
  const auto has = [](const std::vector<int>& slots, int slot) {
    return std::binary_search(slots.begin(), slots.end(), slot);
  };
  for (const Edge* edge = first; edge != last; ++edge)
    if (!hands_on_numbers(*edge)) varying.push_back(edge->to);
  std::sort(varying.begin(), varying.end());
  Row row{edges_.size(), edges_.size(), targets_.size(), targets_.size()};
  for (std::size_t e = tape.first_target[index(equation)]; e < tape.first_target[index(equation + 1)]; ++e)
    if (has(varying, tape.targets[e].slot)) {
      targets_.push_back(e);
      wanted.push_back(tape.targets[e].slot);
    }
  row.last_target = targets_.size();
  if (row.last_target == row.first_target) return;
  std::sort(wanted.begin(), wanted.end());
  for (const Edge* edge = last; edge != first;) {
    --edge;
    if (!has(wanted, edge->to)) continue;
    edges_.push_back(*edge);
    if (edge->factor > 0) is_needed[index(edge->factor)] = 1;
    if (!has(wanted, edge->from))
      wanted.insert(std::lower_bound(wanted.begin(), wanted.end(), edge->from), edge->from);
  }
  std::reverse(edges_.begin() + static_cast<std::ptrdiff_t>(row.first_edge), edges_.end());
  row.last_edge = edges_.size();
  rows_.push_back(row);
}

}  // namespace sfdae::core
