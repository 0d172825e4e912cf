// What is computed for the stages of a step of a mechanical system side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_lane_kernels.h"

#include <algorithm>
#include <limits>

#include "linalg/index.h"
#include "multibody/multibody_point.h"

namespace sfdae::core {

using namespace lane_algebra;

namespace {

const Lanes* entries(const LaneMatrix& matrix) { return to_lanes(matrix.entries); }

// w := w - Q2 (C Q2)^-1 b
void subtract(const MultibodyLaneWork& work, const Lanes* b, Lanes* w) {
  if (work.r == 0) return;
  Lanes* const x = work.scratch;
  solve(work.C2, b, 1, x);
  add_product(-1.0, plain(work.Q2()), x, w);
}

// b += C w, b and C in units of the rows.
void add_rows_times(const MultibodyLaneWork& work, const Lanes* w, Lanes* b) {
  work.for_rows([&](int k, int j, const Lanes& entry) { b[k] += entry * w[j]; });
}

void take_rows(const MultibodyLaneWork& work, const LaneArray& all, Lanes* independent) {
  for (int k = 0; k < work.r; ++k) independent[k] = work.units[k] * lanes(all[index(work.row(k))]);
}

// b += (C v + r)_q dq, in units of the rows.
void add_velocity_q_times(const MultibodyLaneWork& work, const Lanes* dq, Lanes* b) {
  if (!work.form.has_velocity_q()) return;
  const ConstView velocity_q = work.form.velocity_q();
  for (int k = 0; k < work.r; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.n; ++j) sum += velocity_q(work.row(k), j) * dq[j];
    b[k] += work.units[k] * sum;
  }
}

// C in units of its rows, and the factors of C Q2.
bool fit(MultibodyLaneWork& work, Lanes& smallest_pivot) {
  const ConstView Q2 = work.Q2();
  const int r = work.r;
  for (std::size_t e = 0; e < work.places().size(); ++e) {
    const int k = work.position_of_row[work.places()[e].row];
    if (k >= 0) work.rows[e] = work.units[k] * lanes(work.terms.C.entries[e]);
  }
  clear(work.C2.A, r * r);
  work.for_rows([&](int k, int j, const Lanes& entry) {
    Lanes* const to = work.C2.A + k * r;
    for (int l = 0; l < r; ++l) to[l] += Q2(j, l) * entry;
  });
  return factor(work.C2, smallest_pivot, work.sign);
}

// a and mu where masses are diagonal, as MultibodyPoint::solve_by_masses. Not the way: is_good stays, false is
// returned.
bool solve_by_masses(MultibodyLaneWork& work, const Lanes& smallest_pivot) {
  if (!work.terms.has_diagonal_mass || work.terms.M.places.size() < index(work.n)) return false;
  const Lanes* const M = entries(work.terms.M);
  Lanes least = M[0], greatest = M[0];
  for (int j = 1; j < work.n; ++j) {
    least = M[j] < least ? M[j] : least;
    greatest = M[j] > greatest ? M[j] : greatest;
  }
  const LaneMask fits = (least > smallest_mass_ratio * greatest) & (smallest_pivot > smallest_pivot_with_masses);
  if (!all(fits)) {
    work.is_good = !any(fits);
    return false;
  }
  const int n = work.n, r = work.r;
  Lanes* const b = work.scratch;
  Lanes *const A = work.reduced.A, *const inverse = work.MT;
  for (int j = 0; j < n; ++j) {
    inverse[j] = 1.0 / M[j];
    work.a[j] = lanes(work.terms.f[index(j)]);
  }
  clear(A, r * r);
  take_rows(work, work.terms.acceleration_rest, b);
  for (int j = 0; j < n; ++j)
    for (std::size_t e = work.first[j]; e < work.first[j + 1]; ++e) {
      const std::size_t one = work.by_column[e];
      const int k = work.position_of_row[work.places()[one].row];
      if (k < 0) continue;
      const Lanes entry = work.rows[one] * inverse[j];
      b[k] += entry * lanes(work.terms.f[index(j)]);
      for (std::size_t m = work.first[j]; m <= e; ++m) {
        const std::size_t other = work.by_column[m];
        const int l = work.position_of_row[work.places()[other].row];
        if (l >= 0) A[std::max(k, l) * r + std::min(k, l)] += entry * work.rows[other];
      }
    }
  if (!factor_symmetric(r, A, work.reduced.inverse)) {
    work.is_good = false;
    return true;
  }
  solve_symmetric(r, A, work.reduced.inverse, b);
  work.for_rows([&](int k, int j, const Lanes& entry) { work.a[j] -= entry * b[k]; });
  for (int j = 0; j < n; ++j) work.a[j] *= inverse[j];
  for (int k = 0; k < r; ++k) work.mu[k] = work.units[k] * b[k];
  return true;
}

void subtract_masses_times(const MultibodyLaneWork& work, const Lanes* w, Lanes* force) {
  const Lanes* const M = entries(work.terms.M);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    force[work.terms.M.places[e].row] -= M[e] * w[work.terms.M.places[e].column];
}

// T = Q1 - Q2 (C Q2)^-1 C Q1, by rows
void complete_tangent(MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, d = work.d;
  const ConstView Q1 = work.Q1(), Q2 = work.Q2();
  Lanes *const C1 = work.MT, *const E = work.scratch;
  clear(C1, r * d);
  work.for_rows([&](int k, int j, const Lanes& entry) {
    for (int c = 0; c < d; ++c) C1[k * d + c] += Q1(j, c) * entry;
  });
  solve(work.C2, C1, d, E);
  for (int j = 0; j < n; ++j)
    for (int c = 0; c < d; ++c) {
      Lanes sum = Lanes{} + Q1(j, c);
      for (int l = 0; l < r; ++l) sum -= Q2(j, l) * E[l * d + c];
      work.T[j * d + c] = sum;
    }
}

// As MultibodyPoint::solve_along.
void solve_along(MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, d = work.d;
  complete_tangent(work);
  // What subtract and factors need lies before.
  Lanes *const b = work.scratch + r, *const y = b + std::max(r, d), *const force = y + d;
  take_rows(work, work.terms.acceleration_rest, b);
  clear(work.a, n);
  subtract(work, b, work.a);
  for (int j = 0; j < n; ++j) force[j] = lanes(work.terms.f[index(j)]);
  subtract_masses_times(work, work.a, force);
  const Lanes* const M = entries(work.terms.M);
  clear(work.MT, n * d);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    for (int c = 0; c < d; ++c)
      work.MT[work.terms.M.places[e].row * d + c] += M[e] * work.T[work.terms.M.places[e].column * d + c];
  work.reduced.n = d;
  clear(work.reduced.A, d * d);
  clear(b, d);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < d; ++i) {
      const Lanes t = work.T[j * d + i];
      b[i] += t * force[j];
      for (int c = 0; c < d; ++c) work.reduced.A[i * d + c] += t * work.MT[j * d + c];
    }
  Lanes pivot, sign;
  if (!factor(work.reduced, pivot, sign)) {
    work.is_good = false;
    return;
  }
  solve(work.reduced, b, 1, y);
  for (int j = 0; j < n; ++j)
    for (int c = 0; c < d; ++c) {
      work.a[j] += work.T[j * d + c] * y[c];
      force[j] -= work.MT[j * d + c] * y[c];
    }
  clear(b, r);
  add_product(1.0, transposed(work.Q2()), force, b);
  solve_transposed(work.C2, b, work.mu);
  for (int k = 0; k < r; ++k) work.mu[k] = work.units[k] * work.mu[k];
}

// K (a; mu) = (f; -s)
void solve_whole(MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, order = n + r;
  work.is_good = work.has_room_for_whole;
  if (!work.is_good) return;
  Lanes* const K = work.reduced.A;
  work.reduced.n = order;
  clear(K, order * order);
  const Lanes* const M = entries(work.terms.M);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    K[work.terms.M.places[e].row * order + work.terms.M.places[e].column] = M[e];
  Lanes *const b = work.scratch, *const x = b + order;
  for (int j = 0; j < n; ++j) b[j] = lanes(work.terms.f[index(j)]);
  for (std::size_t e = 0; e < work.places().size(); ++e) {
    const auto [row, j] = work.places()[e];
    const int k = work.position_of_row[row];
    if (k >= 0) K[(n + k) * order + j] = K[j * order + n + k] = lanes(work.terms.C.entries[e]);
  }
  for (int k = 0; k < r; ++k) b[n + k] = -lanes(work.terms.acceleration_rest[index(work.row(k))]);
  Lanes pivot, sign;
  if (!factor(work.reduced, pivot, sign)) {
    work.is_good = false;
    return;
  }
  solve(work.reduced, b, 1, x);
  for (int j = 0; j < n; ++j) work.a[j] = x[j];
  for (int k = 0; k < r; ++k) work.mu[k] = x[n + k];
}

// The changes of q and v that remove the residuals of the constraints.
void take_particular(MultibodyLaneWork& work) {
  const int n = work.n, r = work.r;
  Lanes *const dq = work.particular, *const dv = dq + n, *const b = work.scratch + r;
  clear(dq, 2 * n);
  take_rows(work, work.terms.g, b);
  subtract(work, b, dq);
  if (work.terms.is_rheonomic) take_rows(work, work.terms.velocity_rest, b);
  else clear(b, r);
  add_rows_times(work, work.qv + n, b);
  add_velocity_q_times(work, dq, b);
  subtract(work, b, dv);
}

void evaluate_all(MultibodyLaneWork& work) {
  const int n = work.n, d = work.d;
  Lanes smallest_pivot;
  work.is_good = fit(work, smallest_pivot);
  if (!work.is_good) return;
  if (!solve_by_masses(work, smallest_pivot) && work.is_good) {
    if (work.along_tangents) solve_along(work);
    else solve_whole(work);
  }
  if (!work.is_good) return;
  take_particular(work);
  // r := Q1^T (q', v') - Q1^T D_h w
  const ConstView Q1 = work.Q1();
  const Lanes *const dq = work.particular, *const dv = dq + n, *const v = work.qv + n;
  Lanes *const r = work.residuals, *const rates = work.scratch;
  for (int j = 0; j < n; ++j) rates[j] = v[j] + dv[j];
  clear(r, 2 * d);
  add_product(1.0, transposed(Q1), rates, r);
  add_product(1.0, transposed(Q1), work.a, r + d);
  add_product(1.0, plain(work.form.A_q()), dq, r + d);
  add_product(1.0, plain(work.form.A_v()), dv, r + d);
  const double rate = -1.0 / work.h;
  for (int k = 0; k < 2 * d; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.s; ++j) sum += work.moves[k][j] * work.D[j];
    r[k] += rate * sum;
  }
}

// A complex number in the lanes A, B times those of x, as MultibodyStepMatrix has them; y += the product.
void add_complex_product(const LaneBlock& A, const LaneBlock& B, const Lanes& x, Lanes& y) {
#if defined(__clang__) || __GNUC__ >= 12
  const Lanes exchanged = __builtin_shufflevector(x, x, 0, 2, 1, 4, 3, 6, 5, 7);
#else
  const Lanes exchanged = __builtin_shuffle(x, LaneMask{0, 2, 1, 4, 3, 6, 5, 7});
#endif
  y += lanes(A) * x + lanes(B) * exchanged;
}

// Column j of a matrix in block j, its rows in lanes: y_i = sum_j matrix_ij x_j for the entries of x.
void transform(const MultibodyLaneWork& work, const LaneBlock* matrix, const Lanes& x, Lanes& y) {
  Lanes sum{};
  for (int j = 0; j < work.s; ++j) sum += x[j] * lanes(matrix[j]);
  y = sum;
}

// As MultibodyStepMatrix::solve_stages.
void solve_stages(MultibodyLaneWork& work) {
  const MultibodyStepMatrix::LaneInverses& inverses = *work.inverses;
  const int d = work.d;
  Lanes *const y = work.scratch, *const right = y + 2 * d, *const z = right + d;
  for (int k = 0; k < 2 * d; ++k) transform(work, inverses.T_inverse, work.residuals[k], y[k]);
  clear(right, 2 * d);
  add_product(1.0, plain(inverses.K), y, z);
  for (int i = 0; i < d; ++i) {
    right[i] = y[d + i];
    add_complex_product(*inverses.c_A, *inverses.c_B, z[i], right[i]);
  }
  clear(z, d);
  for (int i = 0; i < d; ++i)
    for (int j = 0; j < d; ++j) add_complex_product(inverses.A[i * d + j], inverses.B[i * d + j], right[j], z[i]);
  for (int i = 0; i < d; ++i) {
    Lanes quotient{};
    add_complex_product(*inverses.c_A, *inverses.c_B, z[i] + y[i], quotient);
    transform(work, inverses.T, quotient, work.z[i]);
    transform(work, inverses.T, z[i], work.z[d + i]);
  }
}

void change_all(MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, d = work.d;
  if (work.inverses != nullptr) solve_stages(work);
  const ConstView Q1 = work.Q1();
  Lanes *const dq = work.changes, *const dv = dq + n, *const b = work.scratch + r;
  for (int k = 0; k < 2 * d; ++k) work.moves[k] += work.z[k];
  clear(dq, 2 * n);
  add_product(1.0, plain(Q1), work.z, dq);
  add_product(1.0, plain(Q1), work.z + d, dv);
  clear(b, r);
  add_rows_times(work, dq, b);
  subtract(work, b, dq);
  clear(b, r);
  add_rows_times(work, dv, b);
  add_velocity_q_times(work, dq, b);
  subtract(work, b, dv);
  LaneMask bad{};
  for (int k = 0; k < 2 * n; ++k) {
    dq[k] += work.particular[k];
    work.qv[k] += dq[k];
    note_not_finite(dq[k], bad);
  }
  work.norm = std::numeric_limits<double>::quiet_NaN();
  if (any(bad)) return;
  // As MultibodyIteration::norm_of.
  work.norm = largest_above_noise(dq, 2 * n, work.noise, work.inverse_weights);
}

SFDAE_LANE_KERNEL(evaluate_all, MultibodyLaneWork)
SFDAE_LANE_KERNEL(change_all, MultibodyLaneWork)

}  // namespace

void evaluate_stages(MultibodyLaneWork& work) { run_evaluate_all(work); }
void change_stages(MultibodyLaneWork& work) { run_change_all(work); }

}  // namespace sfdae::core
