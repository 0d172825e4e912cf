// IDA of SUNDIALS with band and sparse matrices (LU of its own and KLU), for many unknowns with analytic Jacobians.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sfdae_bench {

// F(t, x, x') = 0 without algebraic unknowns.
struct SparsePeer {
  std::function<void(double t, const double* x, const double* xdot, double* F)> residual;
  // Of F_x + c F_x': entries of column j in the order of the pattern below.
  std::function<void(double c, const double* x, double* values)> jacobian;
  std::vector<int> first, row;  // compressed columns
  std::vector<double> x0, xdot0;
  double tf = 0.0;
};

struct SparsePeerRun {
  std::string failure;  // empty: reached tf
  std::vector<double> x;
  long steps = 0, residuals = 0, jacobians = 0;
};

enum class PeerMatrix { band, klu };

bool sparse_ida_is_available();
// rtol = atol = tol.
SparsePeerRun solve_with_sparse_ida(const SparsePeer& problem, double tol, PeerMatrix kind);

}  // namespace sfdae_bench
