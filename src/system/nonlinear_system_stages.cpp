// The stages of an implicit Runge-Kutta step for a nonlinear problem: simplified Newton with one linearization.
//
// Stage i has its own x_i, y_i; with dx_i = xp_i + T2 z_i the equations of all stages are
//
//     tau/h sum_j D_ij (g0_j + G z_j) - B z_i = b_i,      b_i = Z1^T (A xp_i - tau F(t_i, x_i, sum_j D_ij (x_j - x) /
// h))
//     tau/h sum_j D_ij Uz^T z_j = -tau/h Uz^T T2^T sum_j D_ij (x_j - x)
//
// which transformed_stages.h decouples.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "system/nonlinear_system.h"

namespace sfdae::core {

PointStatus NonlinearSystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  const int s = equations.method.s, n = problem_.n();
  const double h = equations.t_end - equations.t;
  t_reached = equations.t_end;
  resize_stages(s);
  for (int i = 0; i < s; ++i) {
    const double t = i == s - 1 ? equations.t_end : equations.t + equations.method.c[index(i)] * h;
    guess_jet(t, equations.guess, i, stages_[index(i)]);
    stage_starts_[index(i)] = stages_[index(i)];
  }
  const auto iterate = [&] {
    std::copy_n(stage_starts_.begin(), s, stages_.begin());
    return iterate_stages(equations);
  };
  // The middle of the step is where one linearization serves all stages best. Ranks are known there only if what they
  // lead to confirms them: steps are long, and looked at one by one.
  const Jet& middle = stage_starts_[index(s / 2)];
  PointStatus status = s > 1 ? renew(middle, false) : iterate_with_renewal(middle, iterate);
  if (s > 1) {
    if (status == PointStatus::ok) status = iterate();
    if (status == PointStatus::ok) status = check_last_stage(s);
    if (status != PointStatus::ok && !(status == PointStatus::callback_error && !callback_error_.is_recoverable())) {
      chord_.forget_rate();
      const bool is_near_start = std::fabs(equations.t_end - before_.t) < std::fabs(equations.t_end - accepted_.t);
      status = renew_judged(is_near_start ? before_ : accepted_);
      if (status == PointStatus::ok) status = iterate();
      if (status == PointStatus::ok) status = check_last_stage(s);
    }
  }
  if (status != PointStatus::ok) return status;
  jet_ = stages_[index(s - 1)];
  for (int i = 0; i < s; ++i) {
    std::copy_n(stages_[index(i)].x.data(), n, x + static_cast<std::ptrdiff_t>(i) * n);
    std::copy_n(stages_[index(i)].x.data(), n, w + static_cast<std::ptrdiff_t>(i) * n);
  }
  return s == 1 ? review(true) : PointStatus::ok;
}

PointStatus NonlinearSystem::check_last_stage(int s) {
  jet_ = stages_[index(s - 1)];
  ++unjudged_;
  const PointStatus status = check_ranks();
  if (status == PointStatus::ok) unjudged_ = 0;
  return status;
}

void NonlinearSystem::resize_stages(int s) {
  const std::size_t stages = index(s), q = index(form_.unknowns()), n = index(problem_.n()),
                    rows = index(problem_.m()) * index(analysis_.values.mu + 1);
  const auto grow = [](std::vector<double>& values, std::size_t size) {
    if (values.size() < size + 1) values.resize(size + 1);
  };
  if (stages_.size() < stages) {
    stages_.resize(stages, jet_);
    stage_starts_.resize(stages, jet_);
  }
  grow(stage_f_, rows * stages);
  grow(stage_transformed_, rows * stages);
  grow(stage_xp_, n * stages);
  grow(stage_g0_, q * stages);
  grow(stage_r_, q * stages);
  grow(stage_z_, q * stages);
}

// Residuals of all stages into stage_f_, stage_xp_ and r.
PointStatus NonlinearSystem::read_stages(const StageEquations& equations, View r) {
  const StageMethod& method = equations.method;
  const int s = method.s, n = problem_.n(), d = form_.d, u = form_.u, q = d + u;
  const std::ptrdiff_t rows = static_cast<std::ptrdiff_t>(problem_.m()) * (analysis_.values.mu + 1);
  const double h = equations.t_end - equations.t, factor = data_.time_scale / h;
  const Arena::Frame frame(arena_);
  const View g0{stage_g0_.data(), q, s, std::max(q, 1)};
  double* rest = arena_.take(index(n));
  double* along = arena_.take(index(q) + 1);
  for (int i = 0; i < s; ++i) {
    const Jet& jet = stages_[index(i)];
    PointStatus status = array_residuals(jet, stage_f_.data() + i * rows);
    if (status != PointStatus::ok) return status;
    std::fill_n(xdot_.data(), n, 0.0);
    for (int j = 0; j < s; ++j) {
      const double weight = method.D_at(i, j) / h;
      for (int k = 0; k < n; ++k) xdot_[index(k)] += weight * (stages_[index(j)].x[index(k)] - equations.x[k]);
    }
    if (d > 0) status = differential_residuals(jet.t, jet.x.data(), xdot_.data());
    if (status != PointStatus::ok) return status;
    status = read_stage_inputs(jet.t);
    if (status != PointStatus::ok) return status;
    read_constraints(jet, stage_f_.data() + i * rows, stage_transformed_.data() + i * rows);
    std::copy_n(form_.xp(), n, stage_xp_.data() + static_cast<std::ptrdiff_t>(i) * n);
    std::copy_n(form_.b(), d, r.column(i));
    std::copy_n(form_.g0(), d, g0.column(i));
    if (u == 0) continue;
    for (int k = 0; k < n; ++k) rest[k] = xdot_[index(k)] / units_[k];
    multiply(1.0, Op::transposed, form_.T2(), rest, 0.0, along);
    multiply(-data_.time_scale, Op::transposed, form_.Uz(), along, 0.0, r.column(i) + d);
  }
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < s; ++j)
      for (int k = 0; k < d; ++k) r(k, i) -= factor * method.D_at(i, j) * g0(k, j);
  return PointStatus::ok;
}

PointStatus NonlinearSystem::read_stage_inputs(double t) {
  if (problem_.prescribed().empty()) return PointStatus::ok;
  callback_error_ = problem_.evaluate_prescribed(t, prescribed_values_.data());
  return callback_error_.status == SFDAE_OK ? PointStatus::ok : PointStatus::callback_error;
}

// Known ranks that do not fit the jet of the linearization leave out equations that are not redundant: they
// contradict the others then.
PointStatus NonlinearSystem::check_redundant(const Task& task, const Jet& jet) {
  inconsistency_ = 0.0;
  if (analysis_.v_hat == 0) return PointStatus::ok;
  const PointStatus status = array_residuals(jet, array_f_.data());
  if (status != PointStatus::ok) return status;
  read_constraints(jet, array_f_.data(), transformed_f_.data());
  read_inconsistency(task, jet);
  return inconsistency_ > contradiction && !linearized_judged_ ? PointStatus::not_converged : PointStatus::ok;
}

PointStatus NonlinearSystem::iterate_stages(const StageEquations& equations) {
  constexpr int most = 20;
  const StageMethod& method = equations.method;
  const int s = method.s, n = problem_.n(), q = form_.unknowns();
  const std::ptrdiff_t rows = static_cast<std::ptrdiff_t>(problem_.m()) * (analysis_.values.mu + 1);
  const double h = equations.t_end - equations.t;
  if (!factor_step_matrix(method.gamma / h) ||
      !matrix_.factor_stages(form_, data_.time_scale, method, counts_.factorizations))
    return PointStatus::singular;
  const View r{stage_r_.data(), q, s, std::max(q, 1)}, z{stage_z_.data(), q, s, std::max(q, 1)};
  const Task task{true, 1.0 / h, nullptr, nullptr, equations.guess.inverse_weights, newton_tolerance};
  double before = 0.0;
  chord_.begin();
  for (int iteration = 0; iteration < most; ++iteration) {
    const PointStatus status = read_stages(equations, r);
    if (status != PointStatus::ok) return status;
    matrix_.solve_stages(method, r, z, arena_);
    double norm = 0.0;
    for (int i = 0; i < s; ++i) {
      double* dx = stage_xp_.data() + static_cast<std::ptrdiff_t>(i) * n;
      multiply(1.0, Op::plain, form_.T2(), z.column(i), 1.0, dx);
      apply_change(dx, stage_f_.data() + i * rows, stage_transformed_.data() + i * rows, stages_[index(i)]);
      norm = std::max(norm, change_norm(task, dx, stages_[index(i)]));
    }
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    if (has_converged(task, iteration, norm, before)) return check_redundant(task, stages_[index(s - 1)]);
    if (ChordIteration::is_too_slow(iteration, norm, before)) return PointStatus::not_converged;
    before = norm;
  }
  return PointStatus::not_converged;
}

}  // namespace sfdae::core
