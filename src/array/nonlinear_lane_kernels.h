// What is computed for the stages of a step of a nonlinear system side by side (nonlinear_lanes.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/lanes.h"
#include "problem/taylor_data.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"

namespace sfdae::core {

// All that the kernels work on; a column is a block for each of its entries.
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
  // Of the changes: what rounding errors contribute, the factors of the norm, and those by which jets change.
  const double *noise, *norms, *factors;
  double norm = 0.0;  // the result: NaN if a change is not finite

  int n() const { return form.n; }
  int m() const { return form.m; }
  Lanes* step_rows() const { return f_step + m(); }
};

// Memory needed in scratch.
int scratch_of_lanes(int m, int n, int mu);
// x_xdot from the jets.
void take_slopes(NonlinearLaneWork& work);
// From f and f_step: transformed, xp and r.
void reduce_residuals(NonlinearLaneWork& work);
// From z: the changes, their norm, and the jets changed by them.
void change_jets(NonlinearLaneWork& work);
// Without a step. From f, which is scaled: transformed, xp and r = -Z1^T E xp.
void reduce_scaled_residuals(NonlinearLaneWork& work);
// From z: the changes alone.
void recover_changes(NonlinearLaneWork& work);

}  // namespace sfdae::core
