// The changes of x and y that solve a linearized derivative array without a step, as one matrix.
//
// Where several points are solved to rounding with one linearization, as outputs are, a product with it takes the
// place of the elimination that residuals go through, of the constraints, and of what recovers y
// (docs/design/iteration_matrices.md).
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
  // Memory for these sizes; what is known is forgotten.
  void resize(const AnalyzedEquations& problem);
  // Of the linearization as it is, made once. False where there is none: it would cost more than it saves, redundant
  // equations or prescribed components ask for more, or entries are not finite.
  bool make(const AnalyzedEquations& problem, const ArrayLinearization& linearization, Arena& arena);
  // Of scaled residuals f: x, y_1, ..., y_{mu+1}, one below the other, scaled.
  void apply(const double* f, double* changes) const;

 private:
  void make_columns(int first, const ArrayLinearization& linearization, Arena& arena);

  long renewals_ = -1;  // of the linearization that is known
  bool is_usable_ = false;
  Matrix matrix_;  // n (mu + 2) x m (mu + 1), or nothing
  LaneArray f_, transformed_, r_, z_, changes_, scratch_;
};

}  // namespace sfdae::core
