// The chord iteration for the stages of a step of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_iteration.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

PointStatus MultibodyIteration::run() {
  // Errors of the iteration in units of the tolerance, of BDF and of stages. The longer steps of the latter reach more
  // digits than the tolerance requires: with 0.02 up to 1.5 of them are lost, and 0.003 costs 5 percent.
  constexpr double step_tolerance = 0.02, stage_tolerance = 0.003;
  // The rate is measured from two changes, and may be small by chance; no figures were recorded.
  constexpr double least_rate = 0.03;
  if (!factor()) return PointStatus::singular;
  begin_lanes();
  // Slopes amplify errors of stages: at least two changes are made.
  const bool has_stages = discretization_.method != nullptr;
  const ChordTarget target{has_stages ? stage_tolerance : step_tolerance, least_rate, has_stages};
  const PointStatus status = parts_.linearization.chord().solve(target, *this);
  if (status != PointStatus::ok) return status;
  finish();
  parts_.linearization.count_iterations(discretization_.s, iterations_);
  return PointStatus::ok;
}

// The residuals in local coordinates. Those of the constraints are removed by the N of the stages themselves, without
// any old matrix.
void MultibodyIteration::copy_rows(double* rows) {
  if (in_lanes_) parts_.lanes.copy_residuals(parts_.stages);
  std::copy_n(parts_.stages.r.column(0), num_rows(), rows);
}

// Rounding errors of changes are known at the linearization; the matrix of the step converts them to residuals.
void MultibodyIteration::add(RowSums kind, double* rows) {
  const MultibodyForm& form = parts_.linearization.form();
  const int d = form.unknowns(), size = parts_.stages.qv.rows;
  const Arena::Frame frame(parts_.arena);
  const View M = parts_.arena.matrix(d, d);
  form.step_matrix(discretization_.coefficient(), M);
  double *of_qv = parts_.arena.take(index(size) + 1), *local = parts_.arena.take(index(d) + 1);
  if (in_lanes_) parts_.lanes.copy_values(parts_.stages);
  for (int i = 0; i < discretization_.s; ++i, rows += d) {
    const double *change = parts_.stages.changes.column(i), *qv = parts_.stages.qv.column(i);
    for (int k = 0; k < size; ++k)
      of_qv[k] = kind == RowSums::of_change   ? std::fabs(change[k])
                 : kind == RowSums::of_values ? std::max(parts_.noise.sums_of_steps(k), std::fabs(qv[k]))
                                              : 1.0 / inverse_weights_[k];
    project_sizes(of_qv, local);
    for (int j = 0; j < d; ++j)
      for (int k = 0; k < d; ++k) rows[k] += std::fabs(M(k, j)) * local[j];
  }
}

// |Q1|^T of sizes of (q, v).
void MultibodyIteration::project_sizes(const double* of_qv, double* local) const {
  const MultibodyForm& form = parts_.linearization.form();
  const auto project = [](ConstView Q1, const double* from, double* to) {
    std::fill_n(to, Q1.cols, 0.0);
    for (int j = 0; j < Q1.cols; ++j)
      for (int k = 0; k < Q1.rows; ++k) to[j] += std::fabs(Q1(k, j)) * from[k];
  };
  project(form.positions().Q1(), of_qv, local);
  project(form.velocities().Q1(), of_qv + parts_.equations.sizes().positions, local + form.positions().Q1().cols);
}

// Factors the matrix of the step, and those of its decoupled stages, unless these factors exist.
bool MultibodyIteration::factor() {
  auto& [equations, linearization, noise, stages, lanes, arena] = parts_;
  const MultibodyForm& form = linearization.form();
  MultibodyStepMatrix& matrix = linearization.matrix();
  long& count = equations.counts().factorizations;
  const double c = discretization_.coefficient();
  if (!matrix.is_valid() || !matrix.is_for(c)) {
    if (!matrix.factor(form, c, count)) return false;
    noise.measure_steps(form, matrix, arena);
  }
  return discretization_.method == nullptr || matrix.factor_stages(form, *discretization_.method, count);
}

void MultibodyIteration::begin_lanes() {
  auto& [equations, linearization, noise, stages, lanes, arena] = parts_;
  in_lanes_ = discretization_.method != nullptr && lanes.prepare(discretization_.s, equations, linearization.form());
  if (in_lanes_)
    lanes.begin(discretization_, linearization.form(), linearization.point().position_units.data(), stages);
}

// Residuals of all stages. If one of them cannot be evaluated with the others, they are evaluated one by one, which
// shows the reason.
PointStatus MultibodyIteration::evaluate(double* rows) {
  if (in_lanes_ && !parts_.lanes.evaluate(parts_.equations, parts_.linearization.form())) {
    parts_.lanes.leave(parts_.stages);
    in_lanes_ = false;
    has_moves_ = true;
  }
  const PointStatus status = in_lanes_ ? PointStatus::ok : evaluate_columns();
  if (status == PointStatus::ok) copy_rows(rows);
  return status;
}

PointStatus MultibodyIteration::evaluate_columns() {
  for (int i = 0; i < discretization_.s; ++i) {
    const PointStatus status = evaluate_stage(i);
    if (status != PointStatus::ok) return status;
    if (!has_moves_) start_moves(i);
  }
  has_moves_ = true;
  complete_residuals();
  return PointStatus::ok;
}

// Rates, accelerations, forces and the particular change of stage i.
PointStatus MultibodyIteration::evaluate_stage(int i) {
  auto& [equations, linearization, noise, stages, lanes, arena] = parts_;
  const MultibodyForm& form = linearization.form();
  MultibodyPoint& point = stages.point;
  const double* qv = stages.qv.column(i);
  point.set(stages.times[index(i)], qv, qv + equations.sizes().positions);
  PointStatus status = equations.at_velocity(point);
  if (status != PointStatus::ok) return status;
  // Lengths of rows are taken from the linearization.
  point.position_units = linearization.point().position_units;
  point.velocity_units = linearization.point().velocity_units;
  Tangents& tangents = stages.tangents[index(i)];
  if (!form.fit_tangents(point, tangents)) return PointStatus::singular;
  status = equations.accelerations(point, form.velocities(), tangents.of_velocities(), arena);
  if (status != PointStatus::ok) return status;
  std::copy_n(point.mu.data(), stages.mu.rows, stages.mu.column(i));
  double* particular = stages.particular.column(i);
  point.velocity_residuals(stages.residuals.data());
  form.particular(tangents, {point.terms.g.data(), stages.residuals.data()}, particular, arena);
  form.moved_rates(point, particular, stages.rates.column(i), arena);
  std::copy(point.a.begin(), point.a.end(), stages.a.column(i));
  return PointStatus::ok;
}

// Moves of the initial guess of stage i; there are no changes yet, so their memory is free.
void MultibodyIteration::start_moves(int i) {
  const auto& [s, method, h, c, w] = discretization_;
  MultibodyStages& stages = parts_.stages;
  const double* qv = stages.qv.column(i);
  double* change = stages.changes.column(i);
  for (int k = 0; k < stages.qv.rows; ++k) change[k] = method != nullptr ? qv[k] - w[k] : c * qv[k] + w[k];
  parts_.linearization.form().project(change, stages.moves.column(i));
}

// r := Q1^T (q', v') - Q1^T D_h w
void MultibodyIteration::complete_residuals() {
  const auto& [s, method, h, c, w] = discretization_;
  MultibodyStages& stages = parts_.stages;
  const View r = stages.r.view(s), moves = stages.moves.view(s);
  parts_.linearization.form().rates(stages.rates.view(s), stages.a.view(s), stages.particular.view(s), r);
  if (method != nullptr)
    multiply(-1.0 / h, Op::plain, moves, Op::transposed, ConstView{method->D.data(), s, s, s}, 1.0, r);
  else
    for (int k = 0; k < r.rows; ++k) r.data[k] -= moves.data[k];
}

// Changes all stages; the norm of the change.
double MultibodyIteration::change(const double*) {
  auto& [equations, linearization, noise, stages, lanes, arena] = parts_;
  const StageMethod* method = discretization_.method;
  const int s = discretization_.s;
  if (in_lanes_)
    return lanes.change(linearization.form(), linearization.matrix(), {noise.of_steps().data(), inverse_weights_},
                        stages, arena);
  const View r = stages.r.view(s), z = stages.z.view(s);
  if (method != nullptr) {
    linearization.matrix().solve_stages(*method, r, z, arena);
  } else {
    std::copy_n(r.data, r.rows, z.data);
    linearization.matrix().solve(z);
  }
  change_columns();
  double norm = 0.0;
  for (int i = 0; i < s; ++i) {
    const double own = norm_of(stages.changes.column(i));
    if (!std::isfinite(own)) return own;  // std::max would drop NaN
    norm = std::max(norm, own);
  }
  return norm;
}

// As Q1^T p = 0 the changes of Q1^T q and Q1^T v are known.
void MultibodyIteration::change_columns() {
  MultibodyStages& stages = parts_.stages;
  const int s = discretization_.s, size = stages.qv.rows;
  const View z = stages.z.view(s);
  double *moves = stages.moves.column(0), *changes = stages.changes.column(0), *qv = stages.qv.column(0);
  const double* particular = stages.particular.column(0);
  const double rate_of_moves = discretization_.rate_of_moves();
  for (int k = 0; k < s * z.rows; ++k) moves[k] += rate_of_moves * z.data[k];
  parts_.linearization.form().expand(stages.tangents.data(), z, stages.changes.view(s), parts_.arena);
  for (int k = 0; k < s * size; ++k) {
    changes[k] += particular[k];
    qv[k] += changes[k];
  }
}

void MultibodyIteration::finish() {
  MultibodyStages& stages = parts_.stages;
  if (in_lanes_) return parts_.lanes.finish(parts_.linearization.form(), stages);
  for (std::size_t i = 0; i < index(discretization_.s); ++i)
    stages.orientations[i] = stages.tangents[i].orientation();
}

// Norm in units of the tolerance; parts within rounding errors are ignored, as they do not decrease.
double MultibodyIteration::norm_of(const double* change) const {
  const std::vector<double>& noise = parts_.noise.of_steps();
  double norm = 0.0;
  for (int k = 0; k < parts_.stages.qv.rows; ++k) {
    if (!std::isfinite(change[k])) return change[k];
    norm = std::max(norm, (std::fabs(change[k]) - noise[index(k)]) * inverse_weights_[k]);
  }
  return norm;
}

}  // namespace sfdae::core
