// SPDX-License-Identifier: BSD-3-Clause
// One integration with IDA of SUNDIALS, the peer that users of DAE codes know best.
//
// A. C. Hindmarsh et al.: SUNDIALS: suite of nonlinear and differential/algebraic equation solvers. ACM
// TOMS 31, 2005.
#pragma once

#include <string>
#include <vector>

namespace sfdae_bench {

// F(t, x, x') = 0 of index 0, 1 or 2 in a form that IDA takes. It is smooth in each segment between restarts.
struct PeerProblem {
  using Residual = void (*)(int segment, double t, const double* x, const double* xdot, double* F);
  std::string problem, form;
  Residual residual = nullptr;
  double t0 = 0.0, tf = 0.0;
  std::vector<double> x0 = {}, xdot0 = {}, restarts = {};
  int differential = 0;  // x[differential..] appear without derivatives
  // Index 0 or 1: algebraic components are made consistent and pass the error test. Else multipliers of index 2 are
  // taken as they are and left out of the error test.
  bool low_index = true;
  double newton_coefficient = 0.33;  // IDA's default
};

struct SolverRun {
  std::string failure = {};  // empty: reached tf
  std::vector<double> x = {};
  long steps = 0, evaluations = 0, factorizations = 0;  // evaluations of F, those for Jacobians included
};

bool ida_is_available();
// rtol = atol = tol, at most 100000 steps and about 5 seconds, internal difference Jacobians, dense linear algebra.
SolverRun solve_with_ida(const PeerProblem& problem, double tol);

}  // namespace sfdae_bench
