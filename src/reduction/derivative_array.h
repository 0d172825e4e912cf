// The classical derivative array and its projectors, for inspection.
//
//   M y = N x + g,   M_ij = C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1),   N_i = A^(i),   g_i = f^(i),   y = (x', x'', ...)
//
// with plain derivatives, unscaled. Along a jet of F(t, x, x') = 0 the derivatives are total ones, E = F_x', A = -F_x,
// f = -F: changes dx, dy of the jet satisfy M dy = N dx + g, g = -F_l.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/units.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/judge.h"

namespace sfdae::core {

struct DerivativeArray {
  Matrix M;               // (level+1)m x (level+1)n
  Matrix N;               // (level+1)m x n
  std::vector<double> g;  // (level+1)m
};

// Throws Failure if a callback fails.
DerivativeArray derivative_array(LinearProblem& problem, double t, int level);

// Along a jet: from its Taylor coefficients up to order `level`, in these units. Rows that are left out of the array
// (TaylorData::differentiations) are zero.
DerivativeArray derivative_array(const TaylorData& data, int level, const Units& units);

// Orthonormal columns; for the array of level mu.
struct Projectors {
  Matrix Z1;  // m x d, range of E T2
  Matrix Z2;  // (mu+1)m x a, Z2^T M = 0, Z2^T N of full rank
  Matrix Z3;  // (mu+1)m x v^, Z3^T [M N] = 0
  Matrix T2;  // n x (n-a), Z2^T N T2 = 0
};
// known: by an analysis with these settings. Throws Failure if a callback fails, or the values do not hold at t.
Projectors projectors(LinearProblem& problem, const IndexAnalysis& known, const AnalysisSettings& settings, double t);
// From coefficients up to order mu, in these units, with the same rank settings. Throws Failure.
Projectors projectors(const TaylorData& data, const Units& units, const IndexAnalysis& known,
                      const Judge::Settings& judging);
// Orthonormal basis of the range of A, all columns independent, that keeps the ranges of the leading columns.
Matrix orthonormalized(Matrix a);

// The strangeness-free system E1 x' = A1 x + f1, 0 = A2 x + f2 given by the projectors and the array of level mu, and
// max |Z3^T g|, the contradiction of redundant equations.
struct StrangenessFreeEquations {
  Matrix E1, A1, f1, A2, f2;
  double residual = 0.0;
};
StrangenessFreeEquations strangeness_free_equations(const DerivativeArray& array, const Projectors& projectors);

}  // namespace sfdae::core
