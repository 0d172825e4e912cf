// Kernels for the stages of a step of a nonlinear system, computed side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_lane_kernels.h"

#include <limits>

#include "linalg/lane_algebra.h"

namespace sfdae::core {

using namespace lane_algebra;

namespace {

void copy(const Lanes* from, int count, Lanes* to) {
  for (int k = 0; k < count; ++k) to[k] = from[k];
}

void take_all_slopes(NonlinearLaneWork& work) {
  const int n = work.n();
  const double rate = 1.0 / work.h;
  for (int k = 0; k < n; ++k) {
    const Lanes move = work.jets[k] - work.start[k];
    Lanes sum{};
    for (int j = 0; j < work.s; ++j) sum += move[j] * work.D[j];
    work.x_xdot[k] = work.jets[k];
    work.x_xdot[n + k] = rate * sum;
  }
}

// Like ArrayLinearization::evaluate_array and evaluate_differential.
void scale_residuals(NonlinearLaneWork& work) {
  const TaylorData& data = work.data;
  const int m = work.m();
  const double tau = data.time_scale;
  double power = -1.0;
  for (int k = 0; k <= work.elimination.level(); ++k) {
    power *= tau;
    for (int i = 0; i < m; ++i)
      work.f[k * m + i] = power * data.row_scale[static_cast<std::size_t>(i)] * work.f[k * m + i];
  }
  for (int i = 0; i < m; ++i) work.f_step[i] = -tau * data.row_scale[static_cast<std::size_t>(i)] * work.f_step[i];
}

// Like StoredElimination::transform.
void transform(NonlinearLaneWork& work) {
  const StoredElimination& elimination = work.elimination;
  const int m = work.m(), most = (elimination.level() + 1) * m;
  Lanes *now = work.scratch, *next = now + most, *const stacked = next + most + m;
  int rows = 0;
  for (int i = elimination.level(); i >= 0; --i) {
    const StoredElimination::StageView stage = elimination.stage(i);
    const Lanes* const f = work.f + i * m;
    if (stage.by_reflections) {
      clear(stacked, stage.rank);
      add_product(1.0, transposed(stage.Q.columns(0, stage.rank)), f, stacked);
      copy(now, rows, stacked + stage.rank);
      apply_q_transposed(stage.X, stage.rank, stage.X_tau, stacked);
      copy(stacked + stage.rank, rows, next);
    } else {
      copy(now, rows, next);
    }
    clear(next + rows, stage.null_rows);
    add_product(1.0, plain(stage.W), f, next);
    if (stage.leaving > 0) {
      apply_q_transposed(stage.T, stage.leaving, stage.T_tau, next);
      copy(next, stage.leaving, work.transformed + stage.rhs);
    }
    rows += stage.null_rows - stage.leaving;
    copy(next + stage.leaving, rows, now);
  }
  copy(now, rows, work.transformed);
}

// xp, like ConstraintFactors::solve; no row is redundant.
void solve_constraints(NonlinearLaneWork& work) {
  const ConstraintFactors& constraints = work.form.constraints();
  const int rank = constraints.rank();
  Lanes* const xp = work.changes;
  for (int i = 0; i < rank; ++i) xp[i] = -work.transformed[constraints.pivots()[i]];
  clear(xp + rank, work.n() - rank);
  solve_upper_transposed(constraints.factors(), rank, xp);
  apply_q(constraints.factors(), rank, constraints.tau(), xp);
}

// g0 := sign Z1^T E xp; image: room for m entries.
void take_moved(const NonlinearLaneWork& work, double sign, Lanes* image, Lanes* g0) {
  clear(image, work.m());
  add_product(1.0, plain(work.data.E(0)), work.changes, image);
  clear(g0, work.form.d);
  add_product(sign, transposed(work.form.Z1()), image, g0);
}

// r := Z1^T (A xp + f_step) - tau/h sum_j D_ij Z1^T E xp_j
void take_right_hand_sides(NonlinearLaneWork& work) {
  const TaylorData& data = work.data;
  const NullSpaceForm& form = work.form;
  Lanes* const g0 = work.scratch + work.m();
  clear(work.step_rows(), form.d);
  add_product(1.0, transposed(form.Z1()), work.f_step, work.step_rows());
  take_moved(work, 1.0, work.scratch, g0);
  add_product(1.0, plain(data.A(0)), work.changes, work.f_step);
  clear(work.r, form.d);
  add_product(1.0, transposed(form.Z1()), work.f_step, work.r);
  const double rate = data.time_scale / work.h;
  for (int k = 0; k < form.d; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.s; ++j) sum += g0[k][j] * work.D[j];
    work.r[k] -= rate * sum;
  }
}

void reduce_all(NonlinearLaneWork& work) {
  scale_residuals(work);
  transform(work);
  solve_constraints(work);
  if (work.form.d > 0) take_right_hand_sides(work);
}

// y_j, j = i + 1, like StoredElimination::recover when the equations of a stage have been solved for it beforehand.
void recover_combined(NonlinearLaneWork& work, const StoredElimination::StageView& stage, int i) {
  const int m = work.m(), n = work.n();
  Lanes* const known = work.scratch;
  copy(work.f + i * m, m, known);
  copy(work.transformed + stage.rhs, stage.leaving, known + m);
  copy(work.changes, (i + 1) * n, known + m + stage.leaving);
  Lanes* const y = work.changes + (i + 1) * n;
  clear(y, n);
  add_product(1.0, plain(stage.solution), known, y);
}

// Like StoredElimination::solve_stage.
void recover_stage(NonlinearLaneWork& work, const StoredElimination::StageView& stage, int i) {
  const TaylorData& data = work.data;
  const int m = work.m(), n = work.n(), rank = stage.rank;
  const Lanes* const x = work.changes;
  Lanes *const r = work.scratch, *const top = r + m, *const b = top + m, *const y_q = b + m;
  clear(y_q, n - rank);
  if (stage.leaving > 0) {
    copy(work.transformed + stage.rhs, stage.leaving, b);
    for (int j = 0; j < i; ++j) add_product(-1.0, plain(stage.rows.columns(j * n, n)), x + (j + 1) * n, b);
    add_product(1.0, plain(stage.rows.columns(i * n, n)), x, b);
    solve_upper(stage.T, stage.leaving, b);
    for (int k = 0; k < stage.leaving; ++k) y_q[stage.pivots_of_rows[k]] = b[k];
  }
  copy(work.f + i * m, m, r);
  if (!data.is_zero_A(i)) add_product(1.0, plain(data.A(i)), x, r);
  for (int k = 1; k <= i; ++k) {
    if (!data.is_zero_E(i + 1 - k)) add_product(-1.0, plain(data.E(i + 1 - k)), x + k * n, r);
    if (!data.is_zero_A(i - k)) add_product(1.0 / k, plain(data.A(i - k)), x + k * n, r);
  }
  clear(top, rank);
  add_product(1.0, transposed(stage.Q.columns(0, rank)), r, top);
  add_product(-1.0, plain(stage.R.columns(rank, n - rank)), y_q, top);
  solve_upper(stage.R, rank, top);
  Lanes* const y = work.changes + (i + 1) * n;
  for (int k = 0; k < rank; ++k) y[stage.pivots[k]] = top[k];
  for (int k = rank; k < n; ++k) y[stage.pivots[k]] = y_q[k - rank];
}

// x = xp + T2 z and the corresponding y.
void recover(NonlinearLaneWork& work) {
  const StoredElimination& elimination = work.elimination;
  add_product(1.0, plain(work.form.T2()), work.z, work.changes);
  for (int i = 0; i <= elimination.level(); ++i) {
    const StoredElimination::StageView stage = elimination.stage(i);
    if (elimination.is_combined()) recover_combined(work, stage, i);
    else recover_stage(work, stage, i);
  }
}

void change_all(NonlinearLaneWork& work) {
  const int count = (work.elimination.level() + 2) * work.n();
  recover(work);
  LaneMask bad{};
  for (int k = 0; k < count; ++k) {
    note_not_finite(work.changes[k], bad);
    work.jets[k] += work.factors[k] * work.changes[k];
  }
  work.norm = std::numeric_limits<double>::quiet_NaN();
  if (any(bad)) return;
  // Like NonlinearIteration::weighted_norm.
  work.norm = largest_above_noise(work.changes, count, work.noise, work.norms);
}

void reduce_all_scaled(NonlinearLaneWork& work) {
  transform(work);
  solve_constraints(work);
  take_moved(work, -1.0, work.scratch, work.r);
}

SFDAE_LANE_KERNEL(take_all_slopes, NonlinearLaneWork)
SFDAE_LANE_KERNEL(reduce_all, NonlinearLaneWork)
SFDAE_LANE_KERNEL(change_all, NonlinearLaneWork)
SFDAE_LANE_KERNEL(reduce_all_scaled, NonlinearLaneWork)
SFDAE_LANE_KERNEL(recover, NonlinearLaneWork)

}  // namespace

int scratch_of_lanes(int m, int n, int mu) { return 3 * (mu + 1) * m + 4 * m + (mu + 2) * n + n; }
void take_slopes(NonlinearLaneWork& work) { run_take_all_slopes(work); }
void reduce_residuals(NonlinearLaneWork& work) { run_reduce_all(work); }
void change_jets(NonlinearLaneWork& work) { run_change_all(work); }
void reduce_scaled_residuals(NonlinearLaneWork& work) { run_reduce_all_scaled(work); }
void recover_changes(NonlinearLaneWork& work) { run_recover(work); }

}  // namespace sfdae::core
