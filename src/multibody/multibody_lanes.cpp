// The stages of a step of a mechanical system side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_lanes.h"

#include <algorithm>

#include "linalg/index.h"
#include "multibody/multibody_lane_kernels.h"

namespace sfdae::core {

namespace {

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
  if (rank_ == r) return is_usable_;
  rank_ = -1;  // until there is memory for all
  equations.prepare_lanes(terms_);
  is_usable_ = terms_.has_diagonal_mass || along_tangents_ || whole <= largest_whole;
  if (is_usable_) resize(n, r);
  rank_ = r;
  return is_usable_;
}

void MultibodyLanes::resize(int n, int r) {
  n_ = n;
  const int d = n - r, whole = n + r;
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
  std::fill(moves_.begin(), moves_.end(), LaneBlock());
  lane_algebra::add_product(1.0, lane_algebra::transposed(form.positions().Q1()), changes, moves);
  lane_algebra::add_product(1.0, lane_algebra::transposed(form.positions().Q1()), changes + n, moves + d);
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
  evaluate_stages(kernel);
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
  change_stages(kernel);
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
