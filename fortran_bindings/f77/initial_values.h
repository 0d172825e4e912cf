// Consistent initial values and their derivative, from the strangeness-free system at one point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/matrix.h"

namespace sfdae::f77 {

// The first d and the next a rows of a strangeness-free system.
struct InitialSystem {
  core::ConstView E1, A1, A2;
  const double* f1;
  const double* f2;

  bool is_finite() const;
};

// In the null space of E1 alone, or anywhere.
enum class Change { nearest, keep_differential };

// The smallest change of x that gives A2 x + f2 = 0. False, x as it was, if there is none.
bool make_consistent(const InitialSystem& system, Change change, double* x);

// x' of smallest 2-norm with E1 x' = A1 x + f1. False, xdot as it was, if there is none.
bool initial_derivative(const InitialSystem& system, const double* x, double* xdot);

}  // namespace sfdae::f77
