// The projector P = E^+ E = I - K K^T along ker E: the leading term if rank E is constant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/room.h"
#include "reduction/elimination.h"

namespace sfdae::core {

class LeadingProjector {
 public:
  // Memory for n unknowns.
  void resize(int n);
  // From the factorization of E_0.
  void build(const Carried& carried, Arena& arena);
  // P = I.
  void set_identity() { count_ = 0; }

  // K: orthonormal, E K = 0.
  ConstView kernel() const { return {K_.data(), n_, count_, std::max(n_, 1)}; }
  // y := P y = y - K K^T y.
  void apply(double* y, Arena& arena) const;
  void apply(View Y, Arena& arena) const;

 private:
  int n_ = 0, count_ = 0;
  Room K_;
};

}  // namespace sfdae::core
