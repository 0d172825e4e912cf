// Orders of Taylor coefficients that each equation, and thus each of its operands, is evaluated to.
//
// Minimal extensions differentiate few equations, the constraints of a mechanism twice, but not its balance of
// forces, which has most of the operations.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "expression/tape.h"

namespace sfdae::core {

struct OrderLimits {
  explicit OrderLimits(std::vector<int> limits)
      : of_equations(std::move(limits)), highest(*std::max_element(of_equations.begin(), of_equations.end())) {}

  std::vector<int> of_equations;  // at least 0
  int highest;
};

// The instructions of a tape on x or x', by the orders of their results; operands are needed to the same or higher
// orders.
struct InstructionsByOrder {
  InstructionsByOrder() = default;
  InstructionsByOrder(const Tape& tape, const OrderLimits& limits);
  // Slots become offsets, `stride` numbers for each; jets have n unknowns.
  void to_offsets(const Tape& tape, int n, int stride);
  // The highest orders first: operands before results.
  template <class Execute>
  void for_each(Execute execute) const {
    for (int order = static_cast<int>(lists.size()) - 1; order >= 0; --order)
      if (!lists[index(order)].empty()) execute(lists[index(order)], order);
  }

  std::vector<InstructionList> lists;  // by order
  std::vector<int> of_leaves;          // of tape.leaves: their orders
  // The coefficients of leaves up to these orders: slot[to] = factor x[from].
  struct Load {
    int from, to, factor;
  };
  std::vector<Load> loads;
};

}  // namespace sfdae::core
