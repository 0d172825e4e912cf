// The stages of an implicit Runge-Kutta step for a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_stages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "system/kept_matrix.h"

namespace sfdae::core {

void NonlinearStages::resize(int s, const Jet& like) {
  s_ = s;
  const std::size_t stages = index(s), n = index(problem_.n()), rows = index(problem_.array_rows());
  if (starts_.size() < stages) {
    jets_.resize(stages, like);
    starts_.resize(stages, like);
  }
  const auto grow = [](std::vector<double>& values, std::size_t size) {
    if (values.size() < size + 1) values.resize(size + 1);
  };
  for (auto* v : {&f_, &transformed_}) grow(*v, rows * stages);
  for (auto* v : {&xp_, &g0_, &r_, &z_}) grow(*v, n * stages);  // a form has n unknowns at most
  grow(xdot_, n);
}

void NonlinearStages::predict(const StageEquations& equations, const JetHistory& history,
                              const std::vector<char>& determined) {
  const StageMethod& method = equations.method;
  const double h = equations.t_end - equations.t;
  resize(method.s, history.accepted());
  for (int i = 0; i < s_; ++i) {
    Jet& start = starts_[index(i)];
    start.t = i == s_ - 1 ? equations.t_end : equations.t + method.c[index(i)] * h;
    history.predict(equations.guess, i, determined, problem_.units(), start);
  }
}

PointStatus NonlinearStages::solve(const StageEquations& equations, ArrayLinearization& linearization,
                                   NonlinearIteration& iteration) {
  // Steps that need more are better made smaller. Chosen, not measured.
  constexpr int most = 20;
  const double h = equations.t_end - equations.t;
  std::copy_n(starts_.begin(), s_, jets_.begin());
  if (!linearization.factor_stages(equations.method, h)) return PointStatus::singular;
  const int q = linearization.form().unknowns();
  const IterationTask task{.has_step = true,
                           .c = 1.0 / h,
                           .inverse_weights = equations.guess.inverse_weights,
                           .steep_arguments = equations.guess.steep_arguments,
                           .tolerance = newton_tolerance};
  double before = 0.0, earlier = 0.0;
  bool is_side_by_side = lanes_.prepare(equations, problem_, linearization);
  if (is_side_by_side) lanes_.begin(equations, problem_, linearization, jets_);
  iteration.chord().begin();
  for (int k = 0; k < most; ++k) {
    double norm;
    if (is_side_by_side && !lanes_.evaluate(problem_, linearization)) {
      lanes_.leave(jets_);
      is_side_by_side = false;
    }
    if (is_side_by_side) {
      norm = lanes_.change(linearization, arena_);
    } else {
      const PointStatus status = evaluate(equations, linearization);
      if (status != PointStatus::ok) return status;
      linearization.matrix().solve_stages(equations.method, block(r_, q), block(z_, q), arena_);
      norm = apply_changes(task, linearization, iteration);
    }
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    const auto is_out_of_date = [&] {
      if (task.steep_arguments == nullptr) return false;
      if (std::exchange(is_side_by_side, false)) lanes_.leave(jets_);
      return std::any_of(jets_.begin(), jets_.begin() + s_, [&](const Jet& jet) {
        return have_fallen(task.steep_arguments, linearization.origin().jet, jet);
      });
    };
    if (iteration.has_converged(task, k, norm, before, is_out_of_date)) {
      if (is_side_by_side) lanes_.leave(jets_);
      return iteration.check_redundant(task, linearization, last());
    }
    // x and y correct each other in turn: every second change may be hardly smaller than the one before.
    if (ChordIteration::is_too_slow(k, norm, std::max(before, earlier))) return PointStatus::not_converged;
    earlier = before;
    before = norm;
  }
  return PointStatus::not_converged;
}

// Residuals of all stages, xp and r.
PointStatus NonlinearStages::evaluate(const StageEquations& equations, ArrayLinearization& linearization) {
  for (int i = 0; i < s_; ++i) {
    const PointStatus status = evaluate_stage(equations, i, linearization);
    if (status != PointStatus::ok) return status;
  }
  const NullSpaceForm& form = linearization.form();
  const double h = equations.t_end - equations.t, factor = linearization.data().time_scale / h;
  const View r = block(r_, form.unknowns()), g0 = block(g0_, form.unknowns());
  for (int i = 0; i < s_; ++i)
    for (int j = 0; j < s_; ++j) {
      const double weight = factor * equations.method.D_at(i, j);
      const double* from = g0.column(j);
      double* to = r.column(i);
      for (int k = 0; k < form.d; ++k) to[k] -= weight * from[k];
    }
  return PointStatus::ok;
}

PointStatus NonlinearStages::evaluate_stage(const StageEquations& equations, int i,
                                            ArrayLinearization& linearization) {
  const NullSpaceForm& form = linearization.form();
  const int n = problem_.n(), d = form.d;
  const Jet& jet = jets_[index(i)];
  PointStatus status = linearization.evaluate_array(jet, residuals(i));
  if (status != PointStatus::ok) return status;
  set_derivative(equations, i);
  if (d > 0) status = linearization.evaluate_differential(jet.t, jet.x.data(), xdot_.data());
  if (status != PointStatus::ok) return status;
  status = problem_.evaluate_inputs(jet.t);
  if (status != PointStatus::ok) return status;
  linearization.set_constraints(jet, residuals(i));
  double* r = block(r_, form.unknowns()).column(i);
  std::copy_n(form.xp(), n, block(xp_, n).column(i));
  std::copy_n(form.b(), d, r);
  std::copy_n(form.g0(), d, block(g0_, form.unknowns()).column(i));
  if (form.u > 0) linearization.free_part(-linearization.data().time_scale, xdot_.data(), r + d);
  return PointStatus::ok;
}

// xdot_: the slope of the collocation polynomial at stage i.
void NonlinearStages::set_derivative(const StageEquations& equations, int i) {
  const int n = problem_.n();
  const double h = equations.t_end - equations.t;
  double* xdot = xdot_.data();
  const double* start = equations.x;
  std::fill_n(xdot, n, 0.0);
  for (int j = 0; j < s_; ++j) {
    const double weight = equations.method.D_at(i, j) / h;
    const double* x = jets_[index(j)].x.data();
    for (int k = 0; k < n; ++k) xdot[k] += weight * (x[k] - start[k]);
  }
}

// The largest norm of the changes of all stages.
double NonlinearStages::apply_changes(const IterationTask& task, const ArrayLinearization& linearization,
                                      NonlinearIteration& iteration) {
  const NullSpaceForm& form = linearization.form();
  const View z = block(z_, form.unknowns());
  double norm = 0.0;
  for (int i = 0; i < s_; ++i) {
    double* dx = block(xp_, problem_.n()).column(i);
    multiply(1.0, Op::plain, form.T2(), z.column(i), 1.0, dx);
    norm = std::max(norm, iteration.apply_change(task, linearization, residuals(i), dx, jets_[index(i)]));
  }
  return norm;
}

void NonlinearStages::copy_to(double* x) const {
  const int n = problem_.n();
  for (int i = 0; i < s_; ++i) std::copy_n(jets_[index(i)].x.data(), n, x + static_cast<std::ptrdiff_t>(i) * n);
}

}  // namespace sfdae::core
