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
  // Largest number of independent constraints; for more, BLAS is faster point by point. Eight lanes for one or two
  // points would be a waste. (Chosen.)
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
  const int d = n - r, whole = n + r, order = std::max({r, d, whole <= largest_whole ? whole : 0});
  struct Part {
    Lanes** at;
    int count;
  };
  const Part parts[] = {{&at_.t, 1},
                        {&at_.qv, 2 * n},
                        {&at_.moves, 2 * d},
                        {&at_.particular, 2 * n},
                        {&at_.changes, 2 * n},
                        {&at_.a, n},
                        {&at_.mu, r},
                        {&at_.residuals, 2 * d},
                        {&at_.z, 2 * d},
                        {&at_.sign, 1},
                        {&D_, max_stages},
                        {&rows_.entries, static_cast<int>(terms_.C.places.size())},
                        {&matrices_.C2.A, r * r},
                        {&matrices_.C2.inverse, r},
                        {&matrices_.reduced.A, order * order},
                        {&matrices_.reduced.inverse, order},
                        {&matrices_.T, n * d},
                        {&matrices_.MT, n * std::max(d, 1)},
                        {&matrices_.scratch, std::max({r * d, 2 * (r + d) + n, 2 * whole, 4 * d})}};
  std::size_t size = 0;
  for (const Part& part : parts) size += index(part.count);
  memory_.assign(size, {});
  Lanes* next = to_lanes(memory_);
  for (const Part& part : parts) {
    *part.at = next;
    next += part.count;
  }
  orders_.assign(index(r + order), 0);
  matrices_.C2.n = r;
  matrices_.C2.order = orders_.data();
  matrices_.reduced.order = orders_.data() + r;
  rows_.units.assign(index(r), 1.0);
  rows_.position.assign(terms_.g.size(), -1);
  list_columns();
}

// Entries of C by columns.
void MultibodyLanes::list_columns() {
  const std::vector<LaneMatrix::Place>& places = terms_.C.places;
  rows_.first.assign(index(n_) + 1, 0);
  for (const LaneMatrix::Place& place : places) ++rows_.first[index(place.column) + 1];
  for (std::size_t j = 0; j < index(n_); ++j) rows_.first[j + 1] += rows_.first[j];
  std::vector<std::size_t> next = rows_.first;
  rows_.by_column.assign(places.size(), 0);
  for (std::size_t e = 0; e < places.size(); ++e) rows_.by_column[next[index(places[e].column)]++] = e;
}

MultibodyLaneWork MultibodyLanes::work(const MultibodyForm& form) const {
  return {.n = n_,
          .r = rank_,
          .d = n_ - rank_,
          .along_tangents = along_tangents_,
          .has_room_for_whole = n_ + rank_ <= largest_whole,
          .form = form,
          .terms = terms_,
          .rows = rows_,
          .method = {discretization_->s, discretization_->h, D_},
          .at = at_,
          .matrices = matrices_};
}

void MultibodyLanes::begin(const MultibodyDiscretization& discretization, const MultibodyForm& form,
                           const double* units, MultibodyStages& stages) {
  discretization_ = &discretization;
  const int n = n_, s = discretization.s, d = n - rank_;
  const StageMethod& method = *discretization.method;
  columns_to_lanes(stages.times.data(), 1, s, to_blocks(at_.t));
  columns_to_lanes(stages.qv.column(0), 2 * n, s, to_blocks(at_.qv));
  for (int j = 0; j < s; ++j)
    for (int l = 0; l < lane_count; ++l) D_[j][l] = method.D_at(std::min(l, s - 1), j);
  std::fill(rows_.position.begin(), rows_.position.end(), -1);
  for (int k = 0; k < rank_; ++k) {
    const int row = form.positions().rows[index(k)];
    rows_.position[index(row)] = k;
    rows_.units[index(k)] = units[row] > 0.0 ? 1.0 / units[row] : 1.0;
  }
  // Moves of the initial guesses; there are no changes yet, so their memory is free.
  for (int k = 0; k < 2 * n; ++k) at_.changes[k] = at_.qv[k] - discretization.w[k];
  clear(at_.moves, 2 * d);
  lane_algebra::add_product(1.0, lane_algebra::transposed(form.positions().Q1()), at_.changes, at_.moves);
  lane_algebra::add_product(1.0, lane_algebra::transposed(form.positions().Q1()), at_.changes + n, at_.moves + d);
}

void MultibodyLanes::leave(MultibodyStages& stages) const {
  const int s = discretization_->s;
  lanes_to_columns(to_blocks(at_.qv), 2 * n_, s, stages.qv.column(0));
  lanes_to_columns(to_blocks(at_.moves), 2 * (n_ - rank_), s, stages.moves.column(0));
}

bool MultibodyLanes::evaluate(MultibodyEquations& equations, const MultibodyForm& form) {
  const int s = discretization_->s;
  if (!equations.at_velocities(s, to_blocks(at_.t), to_blocks(at_.qv), terms_)) return false;
  if (!evaluate_stages(work(form))) return false;
  equations.counts().factorizations += s;
  return true;
}

void MultibodyLanes::copy_residuals(MultibodyStages& stages) const {
  lanes_to_columns(to_blocks(at_.residuals), stages.r.rows, discretization_->s, stages.r.column(0));
}

void MultibodyLanes::copy_values(MultibodyStages& stages) const {
  lanes_to_columns(to_blocks(at_.qv), 2 * n_, discretization_->s, stages.qv.column(0));
  lanes_to_columns(to_blocks(at_.changes), 2 * n_, discretization_->s, stages.changes.column(0));
}

double MultibodyLanes::change(const MultibodyForm& form, MultibodyStepMatrix& matrix, const Norms& norms,
                              MultibodyStages& stages, Arena& arena) {
  const int s = discretization_->s;
  const bool by_inverses = matrix.has_lane_inverses();
  if (!by_inverses) {
    matrix.solve_stages(*discretization_->method, stages.r.view(s), stages.z.view(s), arena);
    columns_to_lanes(stages.z.column(0), stages.z.rows, s, to_blocks(at_.z));
  }
  const auto inverses = by_inverses ? matrix.lane_inverses() : MultibodyStepMatrix::LaneInverses{};
  return change_stages(work(form), by_inverses ? &inverses : nullptr, norms);
}

void MultibodyLanes::finish(const MultibodyForm& form, MultibodyStages& stages) const {
  const int s = discretization_->s;
  copy_values(stages);
  for (int i = 0; i < s; ++i) {
    double* const mu = stages.mu.column(i);
    std::fill_n(mu, stages.mu.rows, 0.0);
    for (int k = 0; k < rank_; ++k) mu[form.positions().rows[index(k)]] = at_.mu[k][i];
    const int sign = (*at_.sign)[i] < 0.0 ? -1 : 1;
    stages.orientations[index(i)] = {sign, sign};
  }
}

}  // namespace sfdae::core
