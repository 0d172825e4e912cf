// The signature matrix: the highest derivative of each unknown in each equation, by rows.
//
// Folder structure: structural analysis of recorded equations by the unknowns they contain (signature matrix,
// transversal, offsets, blocks), and its numerical confirmation.
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
  // Equation i contains x_j^(order), and no higher derivative of x_j; an unknown occurs once in a row. Packed in one
  // word: recorded equations have orders up to 1, replaced ones some more.
  struct Entry {
    Entry() : Entry(0, 0) {}
    Entry(int j, int its_order) : unknown(static_cast<unsigned>(j) & 0xffffff), order(its_order & 0xff) {}
    unsigned unknown : 24;
    unsigned order : 8;
  };
  static constexpr int most_unknowns = 0xffffff, highest_possible_order = 0xff;

  // As many unknowns as rows.
  explicit Signature(const std::vector<std::vector<Entry>>& rows);
  // record: as many equations as unknowns.
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
