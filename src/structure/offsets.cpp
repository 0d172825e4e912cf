// Canonical offsets of a DAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "structure/offsets.h"

#include <algorithm>
#include <numeric>

namespace sfdae::core {

int Offsets::freedom() const {
  return std::accumulate(d.begin(), d.end(), 0) - std::accumulate(c.begin(), c.end(), 0);
}

// If every unknown finally occurs differentiated, the last differentiation only gives the highest derivatives, which
// are not needed.
int Offsets::index_bound() const {
  if (c.empty()) return 0;
  const int highest = *std::max_element(c.begin(), c.end());
  return *std::min_element(d.begin(), d.end()) == 0 ? highest : std::max(0, highest - 1);
}

bool Offsets::leaves_out_rows() const {
  const int bound = index_bound();
  return std::any_of(c.begin(), c.end(), [bound](int count) { return count < bound; });
}

// Raising d_j raises c of the equation it is assigned to, which raises d of the unknowns of this equation, and so on.
// As no transversal has a larger value, this ends.
Offsets canonical_offsets(const Signature& signature, const Transversal& transversal) {
  const std::size_t n = index(signature.size());
  Offsets offsets{std::vector<int>(n), std::vector<int>(n)};
  std::vector<int> assigned_order(n);
  for (int i = 0; i < signature.size(); ++i)
    for (const Signature::Entry& entry : signature.row(i)) {
      int& d = offsets.d[index(entry.unknown)];
      d = std::max<int>(d, entry.order);
      if (transversal.unknown_of[index(i)] == entry.unknown) assigned_order[index(i)] = entry.order;
    }
  std::vector<int> queue(n);
  std::iota(queue.begin(), queue.end(), 0);
  std::vector<char> waits(n, 1);
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int j = queue[k], i = transversal.equation_of[index(j)];
    waits[index(j)] = 0;
    const int c = offsets.d[index(j)] - assigned_order[index(i)];
    if (c <= offsets.c[index(i)]) continue;
    offsets.c[index(i)] = c;
    for (const Signature::Entry& entry : signature.row(i)) {
      int& d = offsets.d[index(entry.unknown)];
      if (entry.order + c <= d) continue;
      d = entry.order + c;
      if (waits[index(entry.unknown)] == 0) queue.push_back(entry.unknown);
      waits[index(entry.unknown)] = 1;
    }
  }
  return offsets;
}

}  // namespace sfdae::core
