// Kernels for the stages of a step of a nonlinear system, computed side by side (nonlinear_lanes.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/lanes.h"
#include "problem/taylor_data.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"

namespace sfdae::core {

// Data of the kernels; a column has one block for each of its entries.
struct NonlinearLaneWork {
  const TaylorData& data;
  const StoredElimination& elimination;
  const NullSpaceForm& form;
  int s;
  double h;
  const double* start;  // x at the start of the step
  const Lanes* D;       // block j: column j of D
  Lanes* jets;          // n x (mu + 2)
  Lanes* x_xdot;        // x and the slope of the collocation polynomial
  Lanes *f, *f_step;    // F_mu along the jets, F of x_xdot; then scaled. Behind f_step: Z1^T f_step
  Lanes* transformed;
  Lanes *r, *z;    // right-hand sides and solutions of the decoupled equations
  Lanes* changes;  // xp, then those of x, y_1, ..., y_{mu+1}, scaled
  Lanes* scratch;
  // The changes' rounding errors, their factors in the norm, and the factors by which they change the jets.
  const double *noise, *norms, *factors;
  double norm = 0.0;  // the result: NaN if a change is not finite

  int n() const { return form.n; }
  int m() const { return form.m; }
  Lanes* step_rows() const { return f_step + m(); }
};

// Memory needed in scratch.
int scratch_of_lanes(int m, int n, int mu);
// Computes x_xdot from the jets.
void take_slopes(NonlinearLaneWork& work);
// Computes transformed, xp and r from f and f_step.
void reduce_residuals(NonlinearLaneWork& work);
// Computes the changes from z, and their norm, and changes the jets by them.
void change_jets(NonlinearLaneWork& work);
// Without a step: computes transformed, xp and r = -Z1^T E xp from f, which is scaled.
void reduce_scaled_residuals(NonlinearLaneWork& work);
// Computes only the changes, from z.
void recover_changes(NonlinearLaneWork& work);

}  // namespace sfdae::core
