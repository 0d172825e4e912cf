// The places of states in the equations of the extension.
// SPDX-License-Identifier: BSD-3-Clause
#include "extension/places_of_states.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

PlacesOfStates::PlacesOfStates(const MinimalExtension& extension, const StateChoice& choice, long its_number)
    : number(its_number) {
  std::vector<int> place(index(extension.n()), -1);  // of unknowns among the states
  for (int j : choice.states()) {
    place[index(j)] = static_cast<int>(slope_slots.size());
    slope_slots.push_back(choice.slot(extension.column_of(j, 1)));
  }
  const auto place_of = [&](int column) { return place[index(extension.columns()[index(column)].unknown)]; };
  first.assign(choice.states().size() + 1, 0);
  for (int row = 0; row < extension.num_rows(); ++row) {
    const int begin = extension.first()[index(row)], end = extension.first()[index(row + 1)];
    for (int e = begin; e < end; ++e) {
      const int column = extension.column()[index(e)];
      if (!choice.is_held(column)) continue;
      entries.push_back({row, place_of(column), index(e)});
      ++first[index(entries.back().state) + 1];
    }
    if (end != begin + 2) continue;
    const bool is_slope_first = choice.is_slope(extension.column()[index(begin)]);
    const std::size_t of_slope = index(is_slope_first ? begin : begin + 1),
                      of_state = index(is_slope_first ? begin + 1 : begin);
    const int slope = extension.column()[of_slope], state = extension.column()[of_state];
    if (!choice.is_slope(slope) || !choice.is_held(state)) continue;
    const int a = place_of(slope), b = place_of(state);
    if (a != b) candidates.push_back({{a, b}, of_slope, of_state});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& one, const Entry& other) { return one.state < other.state; });
  for (std::size_t b = 0; b < choice.states().size(); ++b) first[b + 1] += first[b];
}

}  // namespace sfdae::core
