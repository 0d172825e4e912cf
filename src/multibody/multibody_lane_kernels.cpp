// Kernels for the stages of a step of a mechanical system, side by side.
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
  Lanes* const x = work.matrices.scratch;
  solve(work.matrices.C2, b, 1, x);
  add_product(-1.0, plain(work.Q2()), x, w);
}

// b += C w, b and C in units of the rows.
void add_rows_times(const MultibodyLaneWork& work, const Lanes* w, Lanes* b) {
  work.for_rows([&](int k, int j, const Lanes& entry) { b[k] += entry * w[j]; });
}

void take_rows(const MultibodyLaneWork& work, const LaneArray& all, Lanes* independent) {
  for (int k = 0; k < work.r; ++k) independent[k] = work.rows.units[k] * lanes(all[index(work.row(k))]);
}

// b += (C v + r)_q dq, in units of the rows.
void add_velocity_q_times(const MultibodyLaneWork& work, const Lanes* dq, Lanes* b) {
  if (!work.form.has_velocity_q()) return;
  const ConstView velocity_q = work.form.velocity_q();
  for (int k = 0; k < work.r; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.n; ++j) sum += velocity_q(work.row(k), j) * dq[j];
    b[k] += work.rows.units[k] * sum;
  }
}

// C in units of its rows, and the factors of C Q2.
bool fit(const MultibodyLaneWork& work, Lanes& smallest_pivot) {
  const ConstView Q2 = work.Q2();
  const int r = work.r;
  for (std::size_t e = 0; e < work.places().size(); ++e) {
    const int k = work.rows.position[work.places()[e].row];
    if (k >= 0) work.rows.entries[e] = work.rows.units[k] * lanes(work.terms.C.entries[e]);
  }
  clear(work.matrices.C2.A, r * r);
  work.for_rows([&](int k, int j, const Lanes& entry) {
    Lanes* const to = work.matrices.C2.A + k * r;
    for (int l = 0; l < r; ++l) to[l] += Q2(j, l) * entry;
  });
  return factor(work.matrices.C2, smallest_pivot, *work.at.sign);
}

enum class Solved { yes, not_this_way, not_at_all_points };

// a and mu for diagonal masses, as in MultibodyPoint::solve_by_masses.
Solved solve_by_masses(const MultibodyLaneWork& work, const Lanes& smallest_pivot) {
  if (!work.terms.has_diagonal_mass || work.terms.M.places.size() < index(work.n)) return Solved::not_this_way;
  const Lanes* const M = entries(work.terms.M);
  Lanes least = M[0], greatest = M[0];
  for (int j = 1; j < work.n; ++j) {
    least = M[j] < least ? M[j] : least;
    greatest = M[j] > greatest ? M[j] : greatest;
  }
  const LaneMask fits = (least > smallest_mass_ratio * greatest) & (smallest_pivot > smallest_pivot_with_masses);
  if (!all(fits)) return any(fits) ? Solved::not_at_all_points : Solved::not_this_way;
  const int n = work.n, r = work.r;
  Lanes* const b = work.matrices.scratch;
  Lanes *const A = work.matrices.reduced.A, *const inverse = work.matrices.MT;
  for (int j = 0; j < n; ++j) {
    inverse[j] = 1.0 / M[j];
    work.at.a[j] = lanes(work.terms.f[index(j)]);
  }
  clear(A, r * r);
  take_rows(work, work.terms.acceleration_rest, b);
  for (int j = 0; j < n; ++j)
    for (std::size_t e = work.rows.first[j]; e < work.rows.first[j + 1]; ++e) {
      const std::size_t one = work.rows.by_column[e];
      const int k = work.rows.position[work.places()[one].row];
      if (k < 0) continue;
      const Lanes entry = work.rows.entries[one] * inverse[j];
      b[k] += entry * lanes(work.terms.f[index(j)]);
      for (std::size_t m = work.rows.first[j]; m <= e; ++m) {
        const std::size_t other = work.rows.by_column[m];
        const int l = work.rows.position[work.places()[other].row];
        if (l >= 0) A[std::max(k, l) * r + std::min(k, l)] += entry * work.rows.entries[other];
      }
    }
  if (!factor_symmetric(r, A, work.matrices.reduced.inverse)) return Solved::not_at_all_points;
  solve_symmetric(r, A, work.matrices.reduced.inverse, b);
  work.for_rows([&](int k, int j, const Lanes& entry) { work.at.a[j] -= entry * b[k]; });
  for (int j = 0; j < n; ++j) work.at.a[j] *= inverse[j];
  for (int k = 0; k < r; ++k) work.at.mu[k] = work.rows.units[k] * b[k];
  return Solved::yes;
}

void subtract_masses_times(const MultibodyLaneWork& work, const Lanes* w, Lanes* force) {
  const Lanes* const M = entries(work.terms.M);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    force[work.terms.M.places[e].row] -= M[e] * w[work.terms.M.places[e].column];
}

// T = Q1 - Q2 (C Q2)^-1 C Q1, by rows
void complete_tangent(const MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, d = work.d;
  const ConstView Q1 = work.Q1(), Q2 = work.Q2();
  Lanes *const C1 = work.matrices.MT, *const E = work.matrices.scratch;
  clear(C1, r * d);
  work.for_rows([&](int k, int j, const Lanes& entry) {
    for (int c = 0; c < d; ++c) C1[k * d + c] += Q1(j, c) * entry;
  });
  solve(work.matrices.C2, C1, d, E);
  for (int j = 0; j < n; ++j)
    for (int c = 0; c < d; ++c) {
      Lanes sum = Lanes{} + Q1(j, c);
      for (int l = 0; l < r; ++l) sum -= Q2(j, l) * E[l * d + c];
      work.matrices.T[j * d + c] = sum;
    }
}

// As MultibodyPoint::solve_along. False: not possible at all points; same for solve_whole().
bool solve_along(const MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, d = work.d;
  complete_tangent(work);
  // The scratch before this is used by subtract and the factors.
  Lanes *const b = work.matrices.scratch + r, *const y = b + std::max(r, d), *const force = y + d;
  take_rows(work, work.terms.acceleration_rest, b);
  clear(work.at.a, n);
  subtract(work, b, work.at.a);
  for (int j = 0; j < n; ++j) force[j] = lanes(work.terms.f[index(j)]);
  subtract_masses_times(work, work.at.a, force);
  const Lanes* const M = entries(work.terms.M);
  clear(work.matrices.MT, n * d);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    for (int c = 0; c < d; ++c)
      work.matrices.MT[work.terms.M.places[e].row * d + c] +=
          M[e] * work.matrices.T[work.terms.M.places[e].column * d + c];
  Factors reduced = work.matrices.reduced;
  reduced.n = d;
  clear(reduced.A, d * d);
  clear(b, d);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < d; ++i) {
      const Lanes t = work.matrices.T[j * d + i];
      b[i] += t * force[j];
      for (int c = 0; c < d; ++c) reduced.A[i * d + c] += t * work.matrices.MT[j * d + c];
    }
  Lanes pivot, sign;
  if (!factor(reduced, pivot, sign)) return false;
  solve(reduced, b, 1, y);
  for (int j = 0; j < n; ++j)
    for (int c = 0; c < d; ++c) {
      work.at.a[j] += work.matrices.T[j * d + c] * y[c];
      force[j] -= work.matrices.MT[j * d + c] * y[c];
    }
  clear(b, r);
  add_product(1.0, transposed(work.Q2()), force, b);
  solve_transposed(work.matrices.C2, b, work.at.mu);
  for (int k = 0; k < r; ++k) work.at.mu[k] = work.rows.units[k] * work.at.mu[k];
  return true;
}

// K (a; mu) = (f; -s)
bool solve_whole(const MultibodyLaneWork& work) {
  const int n = work.n, r = work.r, order = n + r;
  if (!work.has_room_for_whole) return false;
  Factors reduced = work.matrices.reduced;
  reduced.n = order;
  Lanes* const K = reduced.A;
  clear(K, order * order);
  const Lanes* const M = entries(work.terms.M);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    K[work.terms.M.places[e].row * order + work.terms.M.places[e].column] = M[e];
  Lanes *const b = work.matrices.scratch, *const x = b + order;
  for (int j = 0; j < n; ++j) b[j] = lanes(work.terms.f[index(j)]);
  for (std::size_t e = 0; e < work.places().size(); ++e) {
    const auto [row, j] = work.places()[e];
    const int k = work.rows.position[row];
    if (k >= 0) K[(n + k) * order + j] = K[j * order + n + k] = lanes(work.terms.C.entries[e]);
  }
  for (int k = 0; k < r; ++k) b[n + k] = -lanes(work.terms.acceleration_rest[index(work.row(k))]);
  Lanes pivot, sign;
  if (!factor(reduced, pivot, sign)) return false;
  solve(reduced, b, 1, x);
  for (int j = 0; j < n; ++j) work.at.a[j] = x[j];
  for (int k = 0; k < r; ++k) work.at.mu[k] = x[n + k];
  return true;
}

// The changes of q and v that remove the residuals of the constraints.
void take_particular(const MultibodyLaneWork& work) {
  const int n = work.n, r = work.r;
  Lanes *const dq = work.at.particular, *const dv = dq + n, *const b = work.matrices.scratch + r;
  clear(dq, 2 * n);
  take_rows(work, work.terms.g, b);
  subtract(work, b, dq);
  if (work.terms.is_rheonomic) take_rows(work, work.terms.velocity_rest, b);
  else clear(b, r);
  add_rows_times(work, work.at.qv + n, b);
  add_velocity_q_times(work, dq, b);
  subtract(work, b, dv);
}

bool solve_for_forces(const MultibodyLaneWork& work) {
  Lanes smallest_pivot;
  if (!fit(work, smallest_pivot)) return false;
  const Solved solved = solve_by_masses(work, smallest_pivot);
  if (solved != Solved::not_this_way) return solved == Solved::yes;
  return work.along_tangents ? solve_along(work) : solve_whole(work);
}

struct Evaluation {
  const MultibodyLaneWork& work;
  bool is_good;
};

void evaluate_all(Evaluation& evaluation) {
  const MultibodyLaneWork& work = evaluation.work;
  const int n = work.n, d = work.d;
  evaluation.is_good = solve_for_forces(work);
  if (!evaluation.is_good) return;
  take_particular(work);
  // r := Q1^T (q', v') - Q1^T D_h w
  const ConstView Q1 = work.Q1();
  const Lanes *const dq = work.at.particular, *const dv = dq + n, *const v = work.at.qv + n;
  Lanes *const r = work.at.residuals, *const rates = work.matrices.scratch;
  for (int j = 0; j < n; ++j) rates[j] = v[j] + dv[j];
  clear(r, 2 * d);
  add_product(1.0, transposed(Q1), rates, r);
  add_product(1.0, transposed(Q1), work.at.a, r + d);
  add_product(1.0, plain(work.form.A_q()), dq, r + d);
  add_product(1.0, plain(work.form.A_v()), dv, r + d);
  const double rate = -1.0 / work.method.h;
  for (int k = 0; k < 2 * d; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.method.s; ++j) sum += work.at.moves[k][j] * work.method.D[j];
    r[k] += rate * sum;
  }
}

// y += product of x and a complex number in the lanes A, B, stored as in MultibodyStepMatrix.
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
  for (int j = 0; j < work.method.s; ++j) sum += x[j] * lanes(matrix[j]);
  y = sum;
}

// As MultibodyStepMatrix::solve_stages.
void solve_stages(const MultibodyLaneWork& work, const MultibodyStepMatrix::LaneInverses& inverses) {
  const int d = work.d;
  Lanes *const y = work.matrices.scratch, *const right = y + 2 * d, *const z = right + d;
  for (int k = 0; k < 2 * d; ++k) transform(work, inverses.T_inverse, work.at.residuals[k], y[k]);
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
    transform(work, inverses.T, quotient, work.at.z[i]);
    transform(work, inverses.T, z[i], work.at.z[d + i]);
  }
}

struct Change {
  const MultibodyLaneWork& work;
  const MultibodyStepMatrix::LaneInverses* inverses;
  const MultibodyLaneNorms& norms;
  double norm;
};

void change_all(Change& change) {
  const MultibodyLaneWork& work = change.work;
  const int n = work.n, r = work.r, d = work.d;
  if (change.inverses != nullptr) solve_stages(work, *change.inverses);
  const ConstView Q1 = work.Q1();
  Lanes *const dq = work.at.changes, *const dv = dq + n, *const b = work.matrices.scratch + r;
  for (int k = 0; k < 2 * d; ++k) work.at.moves[k] += work.at.z[k];
  clear(dq, 2 * n);
  add_product(1.0, plain(Q1), work.at.z, dq);
  add_product(1.0, plain(Q1), work.at.z + d, dv);
  clear(b, r);
  add_rows_times(work, dq, b);
  subtract(work, b, dq);
  clear(b, r);
  add_rows_times(work, dv, b);
  add_velocity_q_times(work, dq, b);
  subtract(work, b, dv);
  LaneMask bad{};
  for (int k = 0; k < 2 * n; ++k) {
    dq[k] += work.at.particular[k];
    work.at.qv[k] += dq[k];
    note_not_finite(dq[k], bad);
  }
  if (any(bad)) return;
  // As MultibodyIteration::norm_of.
  change.norm = largest_above_noise(dq, 2 * n, change.norms.noise, change.norms.inverse_weights);
}

SFDAE_LANE_KERNEL(evaluate_all, Evaluation)
SFDAE_LANE_KERNEL(change_all, Change)

}  // namespace

bool evaluate_stages(const MultibodyLaneWork& work) {
  Evaluation evaluation{work, false};
  run_evaluate_all(evaluation);
  return evaluation.is_good;
}

double change_stages(const MultibodyLaneWork& work, const MultibodyStepMatrix::LaneInverses* inverses,
                     const MultibodyLaneNorms& norms) {
  Change change{work, inverses, norms, std::numeric_limits<double>::quiet_NaN()};
  run_change_all(change);
  return change.norm;
}

}  // namespace sfdae::core
