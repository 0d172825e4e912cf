// The signature matrix: which derivative of which unknown an equation contains, the highest one, by rows.
//
// Folder structure: what recorded equations tell by the unknowns they contain: signature matrix, transversal, offsets,
// blocks, and whether numbers agree with them.
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "expression/record.h"
#include "linalg/index.h"

namespace sfdae::core {

class Signature {
 public:
  // Equation i contains x_j^(order), and no higher derivative of x_j; an unknown occurs once in a row.
  struct Entry {
    int unknown;
    int order;
  };

  // As many unknowns as rows.
  explicit Signature(const std::vector<std::vector<Entry>>& rows);
  // Of as many equations as unknowns.
  explicit Signature(const Record& record);

  int size() const { return static_cast<int>(first_.size()) - 1; }
  std::span<const Entry> row(int i) const {
    return {entries_.data() + first_[index(i)], entries_.data() + first_[index(i + 1)]};
  }
  int highest_order() const;

 private:
  void add(const std::vector<Entry>& row);

  std::vector<Entry> entries_;
  std::vector<int> first_{0};
};

}  // namespace sfdae::core
