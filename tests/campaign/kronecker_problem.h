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
  double condition = 1.0;  // of P and Q together, at most
};

// Whether the data, with their rounding errors, determine the values. A chain of k = mu + 1 whose entries are changed
// by delta has eigenvalues of size delta^(-1/k) instead of infinite ones. If the problem has finite eigenvalues as
// large as these, S^k delta >= 1 with delta = eps * condition, data that are dense and rounded are also those of
// another problem. Four digits are left for what sums of n terms and mu differentiations add: S^k * condition < 1e12.
// (Of 4,000 hard problems an analysis by perturbations named 1 % as unclear below 1e12, 16 % up to 1e14, 44 % up to
// 1e16, 75 % above.)
bool determined(const KroneckerProblem& problem);

// n <= 20, mu <= 4, units 1.
KroneckerProblem random_kronecker_problem(const Difficulty& difficulty, RandomNumbers& random);
// With blocks of these sizes.
KroneckerProblem kronecker_problem(const KroneckerSizes& sizes, const Difficulty& difficulty, RandomNumbers& random);

}  // namespace campaign
