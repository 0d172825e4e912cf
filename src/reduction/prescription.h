// Components of x prescribed as functions of time: an equal number of directions that the constraints leave free follow
// them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"

namespace sfdae::core {

// Components x_j that are prescribed, and their values at the point.
struct Prescription {
  const std::vector<int>* components = nullptr;
  const double* values = nullptr;
  int count() const { return components == nullptr ? 0 : static_cast<int>(components->size()); }
};

// Both throw Failure SFDAE_PRESCRIPTION_SINGULAR: if there are more prescribed components than the u free ones, and if
// they do not fit the free part of the solution at t.
void demand_free_components(const std::vector<int>& prescribed, int u);
void demand_fitting_prescription(bool fits, double t);

// With J the prescribed components: (J T2)^T = Q [R; 0]. T2 Q1 =: P1 moves them, T2 Q2 leaves them unchanged.
class PrescribedDirections {
 public:
  // Memory for this many components of n.
  void resize(int n, int count);
  // Splits T2 of all columns: the first columns become those that leave the components unchanged. False, and T2
  // unchanged, if the components do not determine as many of its directions.
  bool split(const std::vector<int>& components, View T2, Arena& arena);
  // xp += P1 R^-T (values - xp_J).
  void apply(Prescription prescription, double* xp, Arena& arena) const;

 private:
  int n_ = 0;
  std::vector<double> P1_, R_;  // n x count; count x count
};

}  // namespace sfdae::core
