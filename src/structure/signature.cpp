// The signature matrix of recorded equations.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/signature.h"

#include <algorithm>

namespace sfdae::core {

Signature::Signature(const std::vector<std::vector<Entry>>& rows) {
  for (const std::vector<Entry>& row : rows) add(row);
}

Signature::Signature(const Record& record) {
  std::vector<Entry> row;
  for (int i = 0; i < record.m(); ++i) {
    row.clear();
    for (const sfdae::core::Entry& entry : record.entries(i))
      row.emplace_back(entry.unknown, entry.derivative ? 1 : 0);
    // If x_j and x'_j both occur, x'_j stays.
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) {
      return a.unknown != b.unknown ? a.unknown < b.unknown : a.order > b.order;
    });
    row.erase(
        std::unique(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.unknown == b.unknown; }),
        row.end());
    add(row);
  }
}

void Signature::add(const std::vector<Entry>& row) {
  entries_.insert(entries_.end(), row.begin(), row.end());
  first_.push_back(static_cast<int>(entries_.size()));
}

int Signature::highest_order() const {
  int highest = 0;
  for (const Entry& entry : entries_) highest = std::max<int>(highest, entry.order);
  return highest;
}

}  // namespace sfdae::core
