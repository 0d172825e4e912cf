// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/matching.h"

#include <cstddef>

namespace sfdae::cli {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

class Search {
 public:
  Search(const std::vector<std::vector<int>>& candidates, int num_variables)
      : candidates_(candidates), equation_of(at(num_variables), -1), visited_(at(num_variables), -1) {}

  // Breadth-first, so that long chains do not need deep recursion.
  bool match(int equation) {
    std::vector<int> reached{equation}, via(candidates_.size(), -1);
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (int v : candidates_[at(reached[k])]) {
        if (visited_[at(v)] == equation) continue;
        visited_[at(v)] = equation;
        const int next = equation_of[at(v)];
        parent_of_[at(v)] = reached[k];
        if (next < 0) {
          assign(v, equation, via);
          return true;
        }
        via[at(next)] = v;
        reached.push_back(next);
      }
    return false;
  }

 private:
  void assign(int v, int start, const std::vector<int>& via) {
    while (true) {
      const int equation = parent_of_[at(v)];
      equation_of[at(v)] = equation;
      if (equation == start) return;
      v = via[at(equation)];
    }
  }

  const std::vector<std::vector<int>>& candidates_;

 public:
  std::vector<int> equation_of;

 private:
  std::vector<int> visited_, parent_of_ = std::vector<int>(equation_of.size(), -1);
};

}  // namespace

std::vector<int> matched_equations(const std::vector<std::vector<int>>& candidates, int num_variables) {
  Search search(candidates, num_variables);
  std::vector<char> is_matched(candidates.size(), 0);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!candidates[i].empty() && search.equation_of[at(candidates[i].front())] < 0) {
      search.equation_of[at(candidates[i].front())] = static_cast<int>(i);
      is_matched[i] = 1;
    }
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (is_matched[i] == 0) search.match(static_cast<int>(i));
  return search.equation_of;
}

}  // namespace sfdae::cli
