// The stages of a step of a mechanical system side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "multibody/multibody_lane_algebra.h"

namespace sfdae::core {

using namespace lane_algebra;

namespace {

Lanes* to_lanes(LaneArray& blocks) { return reinterpret_cast<Lanes*>(blocks.data()); }
const Lanes* to_lanes(const LaneArray& blocks) { return reinterpret_cast<const Lanes*>(blocks.data()); }

}  // namespace

// All that the kernels work on; n positions, n velocities, r independent constraints, d = n - r.
struct MultibodyLaneWork {
  int n, r, d, s;
  const MultibodyForm& form;
  const MultibodyLaneTerms& terms;
  bool along_tangents, has_room_for_whole;
  // Entries of C in column j: by_column[first[j]] to by_column[first[j + 1]].
  const std::size_t *first, *by_column;
  const int* position_of_row;  // among the independent ones; -1: none of them
  const double* units;         // inverse ones of the independent rows
  Lanes* rows;                 // entries of C in these units
  Factors C2, reduced;
  Lanes *T, *MT, *scratch;
  Lanes *qv, *moves, *particular, *changes, *a, *mu, *residuals;
  Lanes* z;
  const Lanes* D;
  double h;
  const MultibodyStepMatrix::LaneInverses* inverses = nullptr;  // null: z is known
  const double* noise = nullptr;
  const double* inverse_weights = nullptr;
  // Results: whether all points could be evaluated here, signs of det C Q2, the norm of the change.
  bool is_good = true;
  Lanes sign{};
  double norm = 0.0;

  ConstView Q1() const { return form.positions().Q1(); }
  ConstView Q2() const { return form.positions().Q2(); }
  int row(int k) const { return form.positions().rows[index(k)]; }
  const std::vector<LaneMatrix::Place>& places() const { return terms.C.places; }
  template <class Action>
  void for_rows(Action action) const {
    for (std::size_t e = 0; e < places().size(); ++e) {
      const int k = position_of_row[places()[e].row];
      if (k >= 0) action(k, places()[e].column, rows[e]);
    }
  }
};

namespace {

using Work = MultibodyLaneWork;

void clear(Lanes* values, int count) {
  for (int k = 0; k < count; ++k) values[k] = Lanes{};
}

// w := w - Q2 (C Q2)^-1 b
void subtract(const Work& work, const Lanes* b, Lanes* w) {
  if (work.r == 0) return;
  Lanes* const x = work.scratch;
  solve(work.C2, b, 1, x);
  add_product(-1.0, plain(work.Q2()), x, w);
}

// b += C w, b and C in units of the rows.
void add_rows_times(const Work& work, const Lanes* w, Lanes* b) {
  work.for_rows([&](int k, int j, const Lanes& entry) { b[k] += entry * w[j]; });
}

void take_rows(const Work& work, const LaneArray& all, Lanes* independent) {
  for (int k = 0; k < work.r; ++k) independent[k] = work.units[k] * lanes(all[index(work.row(k))]);
}

// b += (C v + r)_q dq, in units of the rows.
void add_velocity_q_times(const Work& work, const Lanes* dq, Lanes* b) {
  if (!work.form.has_velocity_q()) return;
  const ConstView velocity_q = work.form.velocity_q();
  for (int k = 0; k < work.r; ++k) {
    Lanes sum{};
    for (int j = 0; j < work.n; ++j) sum += velocity_q(work.row(k), j) * dq[j];
    b[k] += work.units[k] * sum;
  }
}

// C in units of its rows, and the factors of C Q2.
bool fit(Work& work, Lanes& smallest_pivot) {
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

// a and mu where masses are diagonal, as MultibodyPoint::solve_by_masses. Not the way: is_good stays, false is returned.
bool solve_by_masses(Work& work, const Lanes& smallest_pivot) {
  // As there, and in MultibodyEquations::accelerations.
  constexpr double smallest_ratio = 1e-4, well_posed = 1e-2;
  if (!work.terms.has_diagonal_mass || work.terms.M.places.size() < index(work.n)) return false;
  const Lanes* const M = to_lanes(work.terms.M.entries);
  Lanes least = M[0], greatest = M[0];
  for (int j = 1; j < work.n; ++j) {
    least = M[j] < least ? M[j] : least;
    greatest = M[j] > greatest ? M[j] : greatest;
  }
  const LaneMask fits = (least > smallest_ratio * greatest) & (smallest_pivot > well_posed);
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

void subtract_masses_times(const Work& work, const Lanes* w, Lanes* force) {
  const Lanes* const M = to_lanes(work.terms.M.entries);
  for (std::size_t e = 0; e < work.terms.M.places.size(); ++e)
    force[work.terms.M.places[e].row] -= M[e] * w[work.terms.M.places[e].column];
}

// T = Q1 - Q2 (C Q2)^-1 C Q1, by rows
void complete_tangent(Work& work) {
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
void solve_along(Work& work) {
  const int n = work.n, r = work.r, d = work.d;
  complete_tangent(work);
  // What subtract and factors need lies before.
  Lanes *const b = work.scratch + r, *const y = b + std::max(r, d), *const force = y + d;
  take_rows(work, work.terms.acceleration_rest, b);
  clear(work.a, n);
  subtract(work, b, work.a);
  for (int j = 0; j < n; ++j) force[j] = lanes(work.terms.f[index(j)]);
  subtract_masses_times(work, work.a, force);
  const Lanes* const M = to_lanes(work.terms.M.entries);
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
void solve_whole(Work& work) {
  const int n = work.n, r = work.r, order = n + r;
  work.is_good = work.has_room_for_whole;
  if (!work.is_good) return;
  Lanes* const K = work.reduced.A;
  work.reduced.n = order;
  clear(K, order * order);
  const Lanes* const M = to_lanes(work.terms.M.entries);
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
void take_particular(Work& work) {
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

void evaluate_stages(Work& work) {
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
  const Lanes exchanged = __builtin_shufflevector(x, x, 0, 2, 1, 4, 3, 6, 5, 7);
  y += lanes(A) * x + lanes(B) * exchanged;
}

// Column j of a matrix in block j, its rows in lanes: y_i = sum_j matrix_ij x_j for the entries of x.
void transform(const Work& work, const LaneBlock* matrix, const Lanes& x, Lanes& y) {
  Lanes sum{};
  for (int j = 0; j < work.s; ++j) sum += x[j] * lanes(matrix[j]);
  y = sum;
}

// As MultibodyStepMatrix::solve_stages.
void solve_stages(Work& work) {
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

void change_stages(Work& work) {
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
  Lanes norms{};
  for (int k = 0; k < 2 * n; ++k) {
    Lanes size;
    set_abs(dq[k], size);
    size = (size - work.noise[k]) * work.inverse_weights[k];
    norms = size > norms ? size : norms;
  }
  work.norm = norms[0];
  for (int l = 1; l < lane_count; ++l) work.norm = norms[l] > work.norm ? norms[l] : work.norm;
}

SFDAE_LANE_KERNEL(evaluate_stages, Work)
SFDAE_LANE_KERNEL(change_stages, Work)

// K is not formed for larger systems.
constexpr int largest_whole = 48;

}  // namespace

bool MultibodyLanes::prepare(int s, MultibodyEquations& equations, const MultibodyForm& form) {
  // Up to so many independent constraints; beyond, BLAS is faster with one point after the other. Some eight points for
  // one or two would be too many. (Chosen.)
  constexpr int most_constraints = 64, fewest_stages = 3;
  const MultibodySizes& sizes = equations.sizes();
  const int n = sizes.positions, r = form.positions().rank, whole = n + r;
  if (!equations.has_lanes() || s < fewest_stages || r > most_constraints || form.unknowns() == 0) return false;
  along_tangents_ = equations.solves_along_tangents();
  if (!qv_.empty() && rank_ == r) return true;
  equations.prepare_lanes(terms_);
  if (!terms_.has_diagonal_mass && !along_tangents_ && whole > largest_whole) return false;
  rank_ = r;
  resize(n);
  return true;
}

void MultibodyLanes::resize(int n) {
  n_ = n;
  const int r = rank_, d = n - r, whole = n + r;
  const auto set_size = [](LaneArray& blocks, int count) { blocks.assign(index(count) + 1, {}); };
  for (auto* blocks : {&qv_, &particular_, &changes_}) set_size(*blocks, 2 * n);
  for (auto* blocks : {&moves_, &r_, &z_}) set_size(*blocks, 2 * d);
  set_size(t_, 1);
  set_size(a_, n);
  set_size(mu_, r);
  set_size(D_, max_stages);
  set_size(rows_, static_cast<int>(terms_.C.places.size()));
  set_size(lu_, r * r);
  set_size(inverse_, r);
  set_size(T_, n * d);
  set_size(MT_, n * std::max(d, 1));
  const int order = std::max({r, d, whole <= largest_whole ? whole : 0});
  set_size(reduced_, order * order);
  set_size(reduced_inverse_, order);
  set_size(scratch_, std::max({r * d, 2 * (r + d) + n, 2 * whole, 4 * d}));
  order_.assign(index(r) + 1, 0);
  reduced_order_.assign(index(order) + 1, 0);
  units_.assign(index(r) + 1, 1.0);
  // Entries of C by columns.
  first_of_column_.assign(index(n) + 1, 0);
  for (const LaneMatrix::Place& place : terms_.C.places) ++first_of_column_[index(place.column) + 1];
  for (std::size_t j = 0; j < index(n); ++j) first_of_column_[j + 1] += first_of_column_[j];
  std::vector<std::size_t> next = first_of_column_;
  by_column_.assign(terms_.C.places.size() + 1, 0);
  for (std::size_t e = 0; e < terms_.C.places.size(); ++e) by_column_[next[index(terms_.C.places[e].column)]++] = e;
  position_of_row_.assign(terms_.g.size(), -1);
}

MultibodyLaneWork MultibodyLanes::work(const MultibodyForm& form) {
  const int n = n_, r = rank_;
  return {.n = n,
          .r = r,
          .d = n - r,
          .s = discretization_->s,
          .form = form,
          .terms = terms_,
          .along_tangents = along_tangents_,
          .has_room_for_whole = n + r <= largest_whole,
          .first = first_of_column_.data(),
          .by_column = by_column_.data(),
          .position_of_row = position_of_row_.data(),
          .units = units_.data(),
          .rows = to_lanes(rows_),
          .C2 = {r, to_lanes(lu_), to_lanes(inverse_), order_.data()},
          .reduced = {0, to_lanes(reduced_), to_lanes(reduced_inverse_), reduced_order_.data()},
          .T = to_lanes(T_),
          .MT = to_lanes(MT_),
          .scratch = to_lanes(scratch_),
          .qv = to_lanes(qv_),
          .moves = to_lanes(moves_),
          .particular = to_lanes(particular_),
          .changes = to_lanes(changes_),
          .a = to_lanes(a_),
          .mu = to_lanes(mu_),
          .residuals = to_lanes(r_),
          .z = to_lanes(z_),
          .D = to_lanes(D_),
          .h = discretization_->h};
}

void MultibodyLanes::begin(const MultibodyDiscretization& discretization, const MultibodyForm& form,
                           const double* units, MultibodyStages& stages) {
  discretization_ = &discretization;
  const int n = n_, s = discretization.s, d = n - rank_;
  const StageMethod& method = *discretization.method;
  columns_to_lanes(stages.times.data(), 1, s, t_.data());
  columns_to_lanes(stages.qv.column(0), 2 * n, s, qv_.data());
  columns_to_lanes(method.D.data(), s, 1, D_.data());
  for (int j = 0; j < s; ++j)
    for (int l = 0; l < lane_count; ++l) D_[index(j)].lane[l] = method.D_at(std::min(l, s - 1), j);
  std::fill(position_of_row_.begin(), position_of_row_.end(), -1);
  for (int k = 0; k < rank_; ++k) {
    const int row = form.positions().rows[index(k)];
    position_of_row_[index(row)] = k;
    units_[index(k)] = units[row] > 0.0 ? 1.0 / units[row] : 1.0;
  }
  // Of the guesses; there are no changes yet, and their place is free.
  for (int k = 0; k < 2 * n; ++k) lanes(changes_[index(k)]) = lanes(qv_[index(k)]) - discretization.w[k];
  Lanes *const moves = to_lanes(moves_), *const changes = to_lanes(changes_);
  clear(moves, 2 * d);
  add_product(1.0, transposed(form.positions().Q1()), changes, moves);
  add_product(1.0, transposed(form.positions().Q1()), changes + n, moves + d);
}

void MultibodyLanes::leave(MultibodyStages& stages) const {
  const int s = discretization_->s;
  lanes_to_columns(qv_.data(), 2 * n_, s, stages.qv.column(0));
  lanes_to_columns(moves_.data(), 2 * (n_ - rank_), s, stages.moves.column(0));
}

bool MultibodyLanes::evaluate(MultibodyEquations& equations, const MultibodyForm& form) {
  const int s = discretization_->s;
  if (!equations.at_velocities(s, t_.data(), qv_.data(), terms_)) return false;
  MultibodyLaneWork kernel = work(form);
  run_evaluate_stages(kernel);
  if (!kernel.is_good) return false;
  equations.counts().factorizations += s;
  lanes(sign_) = kernel.sign;
  return true;
}

double MultibodyLanes::change(const MultibodyForm& form, MultibodyStepMatrix& matrix, const Norms& norms,
                              MultibodyStages& stages, Arena& arena) {
  const int s = discretization_->s;
  MultibodyLaneWork kernel = work(form);
  MultibodyStepMatrix::LaneInverses inverses{};
  if (matrix.has_lane_inverses()) {
    inverses = matrix.lane_inverses();
    kernel.inverses = &inverses;
  } else {
    lanes_to_columns(r_.data(), stages.r.rows, s, stages.r.column(0));
    matrix.solve_stages(*discretization_->method, stages.r.view(s), stages.z.view(s), arena);
    columns_to_lanes(stages.z.column(0), stages.z.rows, s, z_.data());
  }
  kernel.noise = norms.noise;
  kernel.inverse_weights = norms.inverse_weights;
  run_change_stages(kernel);
  return kernel.norm;
}

void MultibodyLanes::finish(const MultibodyForm& form, MultibodyStages& stages) const {
  const int s = discretization_->s;
  lanes_to_columns(qv_.data(), 2 * n_, s, stages.qv.column(0));
  lanes_to_columns(changes_.data(), 2 * n_, s, stages.changes.column(0));
  for (int i = 0; i < s; ++i) {
    double* const mu = stages.mu.column(i);
    std::fill_n(mu, stages.mu.rows, 0.0);
    for (int k = 0; k < rank_; ++k) mu[form.positions().rows[index(k)]] = mu_[index(k)].lane[i];
    const int sign = sign_.lane[i] < 0.0 ? -1 : 1;
    stages.orientations[index(i)] = {sign, sign};
  }
}

}  // namespace sfdae::core
