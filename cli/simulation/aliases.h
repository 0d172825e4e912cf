// Variables that equal others up to sign and a constant, and variables that are constant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

// Unions of variables of type Real under v = sign root + offset.
class Aliases {
 public:
  // rank: of two variables, the one with the higher rank becomes the root.
  explicit Aliases(const std::vector<int>& rank);

  Alias find(int variable) const;

  // sign_a a + sign_b b + constant = 0, signs +1 or -1, for roots a and b that differ.
  void unite(int a, double sign_a, int b, double sign_b, double constant);
  void set_constant(int root, double value) { parents_[at(root)] = {-1, 0.0, value}; }

 private:
  mutable std::vector<Alias> parents_;
  const std::vector<int>& rank_;
};

// Finds all aliases that follow from residuals with at most two variables, counted after substitution of the aliases
// found so far, and adds them to the known ones. used[i]: residual i has been used, or follows from the others. Returns
// whether any were found. Throws ModelError if they contradict each other.
bool find_aliases(const System& system, const std::vector<Residual>& residuals, Aliases& aliases,
                  std::vector<char>& used, std::vector<std::string>& warnings);

}  // namespace sfdae::cli
