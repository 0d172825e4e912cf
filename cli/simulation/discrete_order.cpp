// Evaluation order of discrete equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/discrete_order.h"

#include <unordered_map>
#include <utility>

namespace sfdae::cli {

void sort_discrete(System& system) {
  const std::vector<DiscreteAssignment> given = std::move(system.at_events.discrete);
  std::unordered_map<int, std::size_t> assignment_of;
  for (std::size_t i = 0; i < given.size(); ++i) assignment_of[given[i].variable] = i;
  std::vector<std::vector<std::size_t>> needed(given.size());
  for (std::size_t i = 0; i < given.size(); ++i)
    for (Formula part : system.formulas.parts({given[i].value})) {
      if (system.formulas[part].operation != Operation::variable) continue;
      const auto place = assignment_of.find(system.formulas[part].index);
      if (place != assignment_of.end()) needed[i].push_back(place->second);
    }
  enum class Mark { none, open, done };
  std::vector<Mark> marks(given.size(), Mark::none);
  std::vector<std::size_t> next(given.size(), 0), stack;
  system.at_events.discrete.clear();
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (marks[i] == Mark::none) stack.push_back(i);
    while (!stack.empty()) {
      const std::size_t k = stack.back();
      marks[k] = Mark::open;
      if (next[k] == needed[k].size()) {
        marks[k] = Mark::done;
        system.at_events.discrete.push_back(given[k]);
        stack.pop_back();
        continue;
      }
      const std::size_t other = needed[k][next[k]++];
      if (marks[other] == Mark::open) system.at_events.has_loop = true;
      if (marks[other] == Mark::none) stack.push_back(other);
    }
  }
}

}  // namespace sfdae::cli
