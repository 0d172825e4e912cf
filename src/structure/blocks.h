// Block triangular form of the system Jacobian: blocks of equations that determine the highest derivatives of as many
// unknowns, given those of the blocks before.
//
// [T72] R. E. Tarjan: Depth-First Search and Linear Graph Algorithms. SIAM J. Comput. 1 (1972), 146-160.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "structure/offsets.h"

namespace sfdae::core {

class Blocks {
 public:
  // The finest blocks, in an order in which a block needs only those before it.
  Blocks(const Signature& signature, const Transversal& transversal, const Offsets& offsets);

  int count() const { return static_cast<int>(first_.size()) - 1; }
  std::span<const int> equations(int block) const { return part(equations_, block); }
  // Unknown k of a block is the one assigned to its equation k.
  std::span<const int> unknowns(int block) const { return part(unknowns_, block); }
  int largest() const;

 private:
  std::span<const int> part(const std::vector<int>& all, int block) const {
    return {all.data() + first_[index(block)], all.data() + first_[index(block + 1)]};
  }

  std::vector<int> equations_, unknowns_;
  std::vector<int> first_{0};
};

}  // namespace sfdae::core
