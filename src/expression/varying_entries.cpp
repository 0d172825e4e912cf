// Operations of a tape that derivatives which are not constant require.
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
  instructions_ = {};
  rows_.clear();
  edges_.clear();
  factors_.assign(1, 0);
  targets_.clear();
  std::vector<char> is_needed(index(tape.num_slots), 0);  // of values, as factors
  for (std::size_t i = 0; i < tape.residuals.size(); ++i) choose_edges(tape, static_cast<int>(i), is_needed);
  choose_instructions(tape, is_needed);
  instructions_ = instructions_.in_offsets(stride);
  for (Edge& edge : edges_)
    for (int* adjoint : {&edge.from, &edge.to}) *adjoint *= stride;
  for (int& factor : factors_) factor *= stride;
  stride_ = stride;
}

void VaryingEntries::choose_instructions(const Tape& tape, std::vector<char>& is_needed) {
  const std::vector<Instruction> all = tape.of_state.all();
  std::vector<Instruction> chosen;
  for (auto next = all.rbegin(); next != all.rend(); ++next) {
    const Instruction& instruction = *next;
    bool is_used =
        is_needed[index(instruction.v)] != 0 || (instruction.q > 0 && is_needed[index(instruction.q)] != 0);
    for (int k = 0; k < results_of(instruction) && instruction.p > 0; ++k)
      is_used = is_used || is_needed[index(instruction.p + k)] != 0;
    if (!is_used) continue;
    chosen.push_back(instruction);
    for (int operand : {instruction.a, instruction.b, instruction.c})
      if (operand > 0) is_needed[index(operand)] = 1;
    for (int k = 1; k < results_of(instruction); ++k) is_needed[index(instruction.a + k)] = 1;
  }
  for (auto next = chosen.rbegin(); next != chosen.rend(); ++next) instructions_.push_back(*next);
}

// Edges come from the residual to the leaves. A sum of numbers is a number. A value that is handed on to a varying one
// is needed, whether it varies or not.
void VaryingEntries::choose_edges(const Tape& tape, int equation, std::vector<char>& is_needed) {
  const auto [first, last, factors] = tape.edges_of(index(equation));
  std::vector<int> varying, wanted;
  const auto has = [](const std::vector<int>& slots, int slot) {
    return std::binary_search(slots.begin(), slots.end(), slot);
  };
  for (const Edge* edge = first; edge != last; ++edge)
    if (!hands_on_numbers(*edge)) varying.push_back(edge->to);
  std::sort(varying.begin(), varying.end());
  Row row{edges_.size(), edges_.size(), targets_.size(), targets_.size()};
  const int* adjoint = tape.adjoints_of_targets(index(equation));
  for (std::size_t e = tape.first_target[index(equation)]; e < tape.first_target[index(equation + 1)]; ++e, ++adjoint)
    if ((is_wanted_.empty() || is_wanted_[e] != 0) && has(varying, *adjoint)) {
      targets_.push_back({e, *adjoint});
      wanted.push_back(*adjoint);
    }
  row.last_target = targets_.size();
  if (row.last_target == row.first_target) return;
  std::sort(wanted.begin(), wanted.end());
  for (const Edge* edge = last; edge != first;) {
    --edge;
    if (!has(wanted, edge->to)) continue;
    edges_.push_back(*edge);
    edges_.back().factor = 0;
    if (has_factor(edge->code)) {
      const int factor = factors[edge->factor];
      edges_.back().factor = static_cast<int>(factors_.size());
      factors_.push_back(factor);
      if (factor > 0) is_needed[index(factor)] = 1;
    }
    if (!has(wanted, edge->from))
      wanted.insert(std::lower_bound(wanted.begin(), wanted.end(), edge->from), edge->from);
  }
  std::reverse(edges_.begin() + static_cast<std::ptrdiff_t>(row.first_edge), edges_.end());
  row.last_edge = edges_.size();
  rows_.push_back(row);
}

}  // namespace sfdae::core
