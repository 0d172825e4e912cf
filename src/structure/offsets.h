// Canonical offsets: how often each equation is differentiated, and up to which derivative each unknown occurs then
// [P01]. The smallest c_i >= 0 and d_j with d_j - c_i >= sigma_ij, equality on a highest-value transversal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "structure/signature.h"
#include "structure/transversal.h"

namespace sfdae::core {

struct Offsets {
  std::vector<int> c, d;  // of equations, of unknowns

  // The entry belongs to the system Jacobian: the highest derivatives in the highest derivative of the equation.
  bool is_leading(int i, const Signature::Entry& entry) const {
    return d[index(entry.unknown)] - c[index(i)] == entry.order;
  }
  // Number of free initial values, if the system Jacobian is nonsingular: sum d - sum c.
  int freedom() const;
  // True if the derivative array up to that index has rows that are not needed.
  bool leaves_out_rows() const;
  // Upper bound of the strangeness index, if the system Jacobian is nonsingular.
  int index_bound() const;
};

// The transversal has to exist.
Offsets canonical_offsets(const Signature& signature, const Transversal& transversal);

}  // namespace sfdae::core
