// The stages of an implicit Runge-Kutta step for a nonlinear problem.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/nonlinear_stages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void NonlinearStages::resize(int s, const Jet& like) {
  s_ = s;
  const std::size_t stages = index(s), n = index(problem_.n()), rows = index(problem_.array_rows());
  for (auto* jets : {&jets_, &before_, &sizes_, &starts_})
    if (jets->size() < stages) jets->resize(stages, like);
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

// The equations of all stages for the chord iteration, side by side or one by one.
class NonlinearStages::Equations {
 public:
  Equations(NonlinearStages& stages, const StageEquations& step, ArrayLinearization& linearization,
            NonlinearIteration& iteration)
      : stages_(stages),
        step_(step),
        linearization_(linearization),
        iteration_(iteration),
        task_{.has_step = true,
              .c = 1.0 / (step.t_end - step.t),
              .inverse_weights = step.guess.inverse_weights,
              .tolerance = newton_tolerance},
        is_side_by_side_(stages.lanes_.prepare(step, stages.problem_, linearization)) {
    if (is_side_by_side_) stages_.lanes_.begin(step_, stages_.problem_, linearization_, stages_.jets_);
  }

  std::size_t num_rows() const { return index(stages_.s_) * linearization_.num_step_rows(); }
  PointStatus evaluate(double* rows) {
    if (is_side_by_side_ && !stages_.lanes_.evaluate(stages_.problem_, linearization_)) leave_lanes();
    if (is_side_by_side_) {
      stages_.lanes_.copy_rows(linearization_, rows);
      return PointStatus::ok;
    }
    return stages_.evaluate(step_, linearization_, rows);
  }
  void add(RowSums kind, double* rows) {
    if (is_side_by_side_) stages_.lanes_.leave(stages_.jets_, stages_.before_);
    const std::size_t s = index(stages_.s_);
    for (std::size_t i = 0; i < s; ++i)
      take_sizes(kind, {stages_.jets_[i], stages_.before_[i], step_.method.gamma * task_.c, task_.inverse_weights},
                 stages_.sizes_[i]);
    for (std::size_t i = 0; i < s; ++i, rows += linearization_.num_step_rows()) {
      stages_.measure_derivative(step_, kind, static_cast<int>(i));
      linearization_.add_step_terms(stages_.sizes_[i], stages_.xdot_.data(), rows);
    }
  }
  double change(const double*) {
    if (is_side_by_side_) return stages_.lanes_.change(linearization_, stages_.arena_);
    const int q = linearization_.form().unknowns();
    std::copy_n(stages_.jets_.begin(), stages_.s_, stages_.before_.begin());
    linearization_.matrix().solve_stages(step_.method, stages_.block(stages_.r_, q), stages_.block(stages_.z_, q),
                                         stages_.arena_);
    return stages_.apply_changes(task_, linearization_, iteration_);
  }
  bool may_end(int) const { return true; }

  void leave_lanes() {
    if (std::exchange(is_side_by_side_, false)) stages_.lanes_.leave(stages_.jets_, stages_.before_);
  }
  const IterationTask& task() const { return task_; }

 private:
  NonlinearStages& stages_;
  const StageEquations& step_;
  ArrayLinearization& linearization_;
  NonlinearIteration& iteration_;
  IterationTask task_;
  bool is_side_by_side_;
};

PointStatus NonlinearStages::solve(const StageEquations& step, ArrayLinearization& linearization,
                                   NonlinearIteration& iteration) {
  // A rate that is measured once may be small by chance, and steps that need more iterations are better shortened. x
  // and y correct each other alternately. Chosen, not measured.
  constexpr ChordTarget target{
      .tolerance = newton_tolerance, .least_rate = 1e-3, .most_iterations = 20, .alternates = true};
  std::copy_n(starts_.begin(), s_, jets_.begin());
  if (!linearization.factor_stages(step.method, step.t_end - step.t)) return PointStatus::singular;
  Equations equations(*this, step, linearization, iteration);
  const PointStatus status = iteration.chord().solve(target, equations);
  if (status != PointStatus::ok) return status;
  equations.leave_lanes();
  return iteration.check_redundant(equations.task(), linearization, last());
}

// Evaluates the residuals of all stages and their rows, xp and r.
PointStatus NonlinearStages::evaluate(const StageEquations& equations, ArrayLinearization& linearization,
                                      double* rows) {
  for (int i = 0; i < s_; ++i, rows += linearization.num_step_rows()) {
    const PointStatus status = evaluate_stage(equations, i, linearization);
    if (status != PointStatus::ok) return status;
    linearization.copy_step_rows(residuals(i).transformed, rows);
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

// Sets xdot_ to the slope of the collocation polynomial at stage i.
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

// Sets xdot_ to the sizes of the terms of that slope, or of their changes.
void NonlinearStages::measure_derivative(const StageEquations& equations, RowSums kind, int i) {
  const int n = problem_.n();
  const double h = equations.t_end - equations.t;
  std::fill_n(xdot_.data(), n, 0.0);
  for (int j = 0; j < s_; ++j) {
    const double weight = std::fabs(equations.method.D_at(i, j) / h);
    const double* x = sizes_[index(j)].x.data();
    for (int k = 0; k < n; ++k)
      xdot_[index(k)] += weight * (std::fabs(x[k]) + (kind == RowSums::of_values ? std::fabs(equations.x[k]) : 0.0));
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
