// Random linear problems E x' = A x with known characteristic values: Kronecker forms N y' = M y, transformed by
// y = Q(s) x and multiplied by P(s),
//
//     E = P N Q,   A = P (M Q - N Q').
//
// The values are invariant under such transformations (P. Kunkel, V. Mehrmann: Differential-Algebraic Equations:
// Analysis and Numerical Solution. EMS, 2006; theorem 3.9).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linear_problem.h"
#include "transformation.h"

namespace campaign {

// How difficult problems are made. Conditions are those of P and Q together, |P| |P^-1| |Q| |Q^-1|.
struct Difficulty {
  double condition = 1e2;   // at most
  double stiffness = 10.0;  // largest eigenvalue of the ODE block in the problem's own time, at most
};
inline constexpr Difficulty tame{1e2, 10.0};
inline constexpr Difficulty hard{1e6, 1e6};

struct KroneckerProblem {
  LinearProblem problem;
  bool exact = false;      // integers, but for the units
  bool dense = false;      // more than half of the entries of E and A differ from zero
  double stiffness = 1.0;  // that of the ODE block, 1 if there is none
};

// n <= 20, mu <= 4, units 1.
KroneckerProblem random_kronecker_problem(const Difficulty& difficulty, RandomNumbers& random);
// With blocks of these sizes.
KroneckerProblem kronecker_problem(const KroneckerSizes& sizes, const Difficulty& difficulty, RandomNumbers& random);

}  // namespace campaign
