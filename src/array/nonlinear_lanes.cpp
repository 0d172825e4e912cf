// The stages of a Radau step of recorded equations side by side.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_lanes.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// The stage of a lane in a step with s stages; lanes beyond repeat the last stage.
int stage_of(int lane, int s) { return std::min(lane, s - 1); }

}  // namespace

bool NonlinearLanes::prepare(const StageEquations& step, const AnalyzedEquations& problem,
                             const ArrayLinearization& linearization) {
  // With fewer stages, too many lanes would be idle.
  constexpr int fewest_stages = 3;
  const ConstraintFactors& constraints = linearization.form().constraints();
  if (step.method.s < fewest_stages || step.guess.inverse_weights == nullptr || !problem.prescribed().empty() ||
      linearization.form().u > 0 || constraints.rows() > constraints.rank() ||
      !problem.problem().has_lanes(problem.mu()))
    return false;
  if (m_ != problem.m() || n_ != problem.n() || mu_ != problem.mu()) resize(problem.m(), problem.n(), problem.mu());
  return true;
}

void NonlinearLanes::resize(int m, int n, int mu) {
  mu_ = -1;  // until there is memory for all
  const auto set_size = [](LaneArray& blocks, int count) { blocks.assign(index(count) + 1, {}); };
  set_size(t_, 1);
  set_size(D_, max_stages);
  for (auto* blocks : {&jets_, &before_, &changes_}) set_size(*blocks, (mu + 2) * n);
  for (auto* blocks : {&f_, &transformed_}) set_size(*blocks, (mu + 1) * m);
  for (auto* blocks : {&r_, &z_}) set_size(*blocks, n);
  set_size(x_xdot_, 2 * n);
  set_size(f_step_, m + n);
  set_size(scratch_, scratch_of_lanes(m, n, mu));
  for (auto* numbers : {&norms_, &factors_}) numbers->assign(index(mu + 2) * index(n) + 1, 0.0);
  for (auto* numbers : {&r_columns_, &z_columns_}) numbers->assign(index(n) * index(max_stages) + 1, 0.0);
  m_ = m;
  n_ = n;
  mu_ = mu;
}

NonlinearLaneWork NonlinearLanes::work(const ArrayLinearization& linearization) {
  return {.data = linearization.data(),
          .elimination = linearization.elimination(),
          .form = linearization.form(),
          .s = step_->method.s,
          .h = step_->t_end - step_->t,
          .start = step_->x,
          .D = to_lanes(D_),
          .jets = to_lanes(jets_),
          .x_xdot = to_lanes(x_xdot_),
          .f = to_lanes(f_),
          .f_step = to_lanes(f_step_),
          .transformed = to_lanes(transformed_),
          .r = to_lanes(r_),
          .z = to_lanes(z_),
          .changes = to_lanes(changes_),
          .scratch = to_lanes(scratch_),
          .noise = linearization.noise().data(),
          .norms = norms_.data(),
          .factors = factors_.data()};
}

void NonlinearLanes::begin(const StageEquations& step, const AnalyzedEquations& problem,
                           const ArrayLinearization& linearization, const std::vector<Jet>& jets) {
  step_ = &step;
  const StageMethod& method = step.method;
  const int s = method.s;
  for (int l = 0; l < lane_count; ++l) {
    const Jet& jet = jets[index(stage_of(l, s))];
    t_[0].lane[l] = jet.t;
    for (std::size_t k = 0; k < index((mu_ + 2) * n_); ++k) jets_[k].lane[l] = jet.x[k];
    for (int j = 0; j < s; ++j) D_[index(j)].lane[l] = method.D_at(stage_of(l, s), j);
  }
  // Like NonlinearIteration::weighted_norm and Jet::add_scaled.
  const double tau = linearization.data().time_scale, ratio = std::fabs(step.t_end - step.t) / tau;
  double power = 1.0, power_of_tau = 1.0;
  for (int k = 0; k <= mu_ + 1; ++k) {
    if (k > 0) power *= ratio;
    if (k > 0) power_of_tau *= tau;
    for (int i = 0; i < n_; ++i) {
      const double unit = problem.units()[i];
      norms_[index(k * n_ + i)] = power / std::max(k, 1) * unit * step.guess.inverse_weights[i];
      factors_[index(k * n_ + i)] = unit / (std::max(k, 1) * power_of_tau);
    }
  }
}

bool NonlinearLanes::evaluate(AnalyzedEquations& problem, const ArrayLinearization& linearization) {
  const int s = step_->method.s;
  NonlinearLaneWork kernel = work(linearization);
  if (!problem.problem().residuals_side_by_side(s, t_.data(), jets_.data(), mu_, f_.data())) return false;
  if (kernel.form.d > 0) {
    take_slopes(kernel);
    if (!problem.problem().residuals_side_by_side(s, t_.data(), x_xdot_.data(), 0, f_step_.data())) return false;
  }
  reduce_residuals(kernel);
  return true;
}

void NonlinearLanes::copy_rows(const ArrayLinearization& linearization, double* rows) const {
  const NullSpaceForm& form = linearization.form();
  for (int l = 0; l < step_->method.s; ++l) {
    for (int k = 0; k < form.d; ++k) *rows++ = f_step_[index(m_ + k)].lane[l];
    for (int k = 0; k < form.rank_of_constraints(); ++k)
      *rows++ = transformed_[index(form.constraints().pivots()[k])].lane[l];
  }
}

// Diverging iterations overflow, which ends them.
double NonlinearLanes::change(ArrayLinearization& linearization, Arena& arena) {
  const QuietArithmetic quiet;
  std::copy(jets_.begin(), jets_.end(), before_.begin());
  const int s = step_->method.s, d = linearization.form().d;
  if (d > 0) {
    lanes_to_columns(r_.data(), d, s, r_columns_.data());
    linearization.matrix().solve_stages(step_->method, {r_columns_.data(), d, s, d}, {z_columns_.data(), d, s, d},
                                        arena);
    columns_to_lanes(z_columns_.data(), d, s, z_.data());
  }
  NonlinearLaneWork kernel = work(linearization);
  change_jets(kernel);
  return kernel.norm;
}

void NonlinearLanes::leave(std::vector<Jet>& jets, std::vector<Jet>& before) const {
  for (int l = 0; l < step_->method.s; ++l)
    for (std::size_t k = 0; k < index((mu_ + 2) * n_); ++k) {
      jets[index(l)].x[k] = jets_[k].lane[l];
      before[index(l)].x[k] = before_[k].lane[l];
    }
}

}  // namespace sfdae::core
