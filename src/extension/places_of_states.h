// The places of states in the equations of the extension; another choice of states has other places.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "extension/coupled_states.h"
#include "extension/minimal_extension.h"
#include "extension/state_matrix.h"

namespace sfdae::core {

struct PlacesOfStates {
  PlacesOfStates() = default;
  PlacesOfStates(const MinimalExtension& extension, const StateChoice& choice, long number);

  long number = -1;              // of the choice, see ExtensionLinearization; -1: none
  std::vector<int> slope_slots;  // of x_j' of each state
  // Entries of the extension in columns of the states, state after state; number b begins at first[b].
  struct Entry {
    int row, state;
    std::size_t entry;
  };
  std::vector<Entry> entries;
  std::vector<int> first;
  // Rows with x_a' of a state, one other state x_b and nothing else: numbers of these, and their entries.
  struct Candidate {
    CoupledStates::Pair pair;
    std::size_t of_slope, of_state;
  };
  std::vector<Candidate> candidates;
};

}  // namespace sfdae::core
