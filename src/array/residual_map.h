// The changes of x and y that solve a linearized derivative array without a step, as one matrix.
//
// If several points are solved to machine precision with one linearization, as outputs are, a product with this matrix
// replaces the elimination of residuals, the constraints, and the recovery of y (docs/design/iteration_matrices.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/array_linearization.h"
#include "linalg/arena.h"
#include "linalg/lanes.h"
#include "linalg/matrix.h"

namespace sfdae::core {

class ResidualMap {
 public:
  // Allocates memory for these sizes and forgets the matrix.
  void resize(const AnalyzedEquations& problem);
  // Makes the matrix of the current linearization, once. False if there is none: it would cost more than it saves,
  // redundant equations or prescribed components need more, or entries are not finite.
  bool make(const AnalyzedEquations& problem, const ArrayLinearization& linearization, Arena& arena);
  // Maps scaled residuals f to scaled changes of x, y_1, ..., y_{mu+1}, one below the other.
  void apply(const double* f, double* changes) const;

 private:
  void make_columns(int first, const ArrayLinearization& linearization, Arena& arena);

  long renewals_ = -1;  // of the linearization whose matrix it is
  bool is_usable_ = false;
  Matrix matrix_;  // n (mu + 2) x m (mu + 1), or nothing
  LaneArray f_, transformed_, r_, z_, changes_, scratch_;
};

}  // namespace sfdae::core
