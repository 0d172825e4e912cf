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
  // Equation i contains x_j^(order), and no higher derivative of x_j; an unknown occurs once in a row. In one word:
  // recorded equations have orders up to 1, those that take their place some more.
  struct Entry {
    Entry() : Entry(0, 0) {}
    Entry(int j, int its_order) : unknown(static_cast<unsigned>(j) & 0xffffff), order(its_order & 0xff) {}
    unsigned unknown : 24;
    unsigned order : 8;
  };
  static constexpr int most_unknowns = 0xffffff, highest_possible_order = 0xff;

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
