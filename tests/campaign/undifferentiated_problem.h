// Linear problems that give no derivatives of E, A, f, although mu >= 1: groups of unknowns that have nothing to do
// with each other, of unrelated sizes, in rows of unrelated sizes.
//
// The solution is chosen first, sums of sines; f = E x' - A x follows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "integration.h"

namespace campaign {

struct UndifferentiatedProblem {
  LinearProblem problem;
  ExactSolution exact;
  double tolerance = 1e-6;
};

// mu = 1, 2 or 3, regular, not stiff, n <= 15.
UndifferentiatedProblem random_undifferentiated_problem(RandomNumbers& random);

}  // namespace campaign
