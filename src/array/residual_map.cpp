// The changes of x and y that solve a linearized derivative array, as one matrix.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/residual_map.h"

#include <algorithm>

#include "array/nonlinear_lane_kernels.h"
#include "linalg/dense.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// Largest number of residuals, in groups of lanes. (Chosen: larger products save less, and columns cost more.)
constexpr int most_columns = 3 * lane_count;

}  // namespace

void ResidualMap::resize(const AnalyzedEquations& problem) {
  const int m = problem.m(), n = problem.n(), mu = problem.mu(), rows = n * (mu + 2), columns = problem.array_rows();
  renewals_ = -1;
  matrix_ = Matrix();
  if (columns > most_columns) return;
  const auto set_size = [](LaneArray& blocks, int count) { blocks.assign(index(count) + 1, {}); };
  for (auto* blocks : {&f_, &transformed_}) set_size(*blocks, columns);
  for (auto* blocks : {&r_, &z_}) set_size(*blocks, n);
  set_size(changes_, rows);
  set_size(scratch_, scratch_of_lanes(m, n, mu));
  matrix_ = Matrix(rows, columns);
}

bool ResidualMap::make(const AnalyzedEquations& problem, const ArrayLinearization& linearization, Arena& arena) {
  if (renewals_ == linearization.renewals()) return is_usable_;
  const NullSpaceForm& form = linearization.form();
  const ConstraintFactors& constraints = form.constraints();
  is_usable_ = matrix_.rows() > 0 && linearization.elimination().is_combined() && problem.prescribed().empty() &&
               form.u == 0 && constraints.rows() == constraints.rank();
  renewals_ = linearization.renewals();
  if (!is_usable_) return false;
  const QuietArithmetic quiet;
  for (int first = 0; first < matrix_.cols(); first += lane_count) make_columns(first, linearization, arena);
  is_usable_ = all_finite(matrix_.data(), index(matrix_.rows()) * index(matrix_.cols()));
  return is_usable_;
}

// Columns for unit residuals, a lane for each.
void ResidualMap::make_columns(int first, const ArrayLinearization& linearization, Arena& arena) {
  const NullSpaceForm& form = linearization.form();
  const int count = std::min(lane_count, matrix_.cols() - first), d = form.d, rows = matrix_.rows();
  for (int k = 0; k < matrix_.cols(); ++k)
    for (int l = 0; l < lane_count; ++l) f_[index(k)].lane[l] = k == first + std::min(l, count - 1) ? 1.0 : 0.0;
  NonlinearLaneWork work{.data = linearization.data(),
                         .elimination = linearization.elimination(),
                         .form = form,
                         .s = count,
                         .h = 0.0,
                         .start = nullptr,
                         .D = nullptr,
                         .jets = nullptr,
                         .x_xdot = nullptr,
                         .f = to_lanes(f_),
                         .f_step = nullptr,
                         .transformed = to_lanes(transformed_),
                         .r = to_lanes(r_),
                         .z = to_lanes(z_),
                         .changes = to_lanes(changes_),
                         .scratch = to_lanes(scratch_),
                         .noise = nullptr,
                         .norms = nullptr,
                         .factors = nullptr};
  reduce_scaled_residuals(work);
  if (d > 0) {
    const Arena::Frame frame(arena);
    double* const q = arena.take(index(d) * index(count));
    double* const z = arena.take(index(d) * index(count));
    lanes_to_columns(r_.data(), d, count, q);
    for (int j = 0; j < count; ++j) form.solve_G(q + j * d, z + j * d, arena);
    columns_to_lanes(z, d, count, z_.data());
  }
  recover_changes(work);
  lanes_to_columns(changes_.data(), rows, count, matrix_.view().column(first));
}

void ResidualMap::apply(const double* f, double* changes) const {
  multiply(1.0, Op::plain, matrix_, f, 0.0, changes);
}

}  // namespace sfdae::core
