// The strangeness-free system of a mechanical system with constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_system.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_force_differences.h"
#include "multibody/multibody_iteration.h"

namespace sfdae::core {

namespace {

std::string singular_message(double t) { return format("[M C^T; C 0] is singular at t = %.15g.", t); }

bool is_at(const MultibodyPoint& point, double t, const double* x) {
  return point.t == t && std::equal(point.q.begin(), point.q.end(), x) &&
         std::equal(point.v.begin(), point.v.end(), x + point.q.size());
}

// x = (q, v, mu)
void copy_unknowns(const MultibodyPoint& point, double* x) {
  double* v = std::copy(point.q.begin(), point.q.end(), x);
  double* mu = std::copy(point.v.begin(), point.v.end(), v);
  std::copy_n(point.mu.data(), point.terms.C.rows(), mu);
}

}  // namespace

MultibodySystem::MultibodySystem(MultibodyProblem& problem, const MultibodySettings& settings, IndexAnalysis analysis,
                                 const double* q, const double* v)
    : DaeSystem(problem, problem.sizes().unknowns(), std::move(analysis), LeadingTerm::identity),
      sizes_(problem.sizes()),
      settings_(settings),
      equations_(problem, callback_error_, counts_) {
  resize();
  const PointStatus status = set_point(analysis_.t, q, v);
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (status == PointStatus::singular) throw Failure(SFDAE_SINGULAR, singular_message(t_));
}

MultibodySystem::MultibodySystem(MultibodyProblem& problem, const MultibodySettings& settings, Archive& saved)
    : DaeSystem(problem, problem.sizes().unknowns(), {}, LeadingTerm::identity),
      sizes_(problem.sizes()),
      settings_(settings),
      equations_(problem, callback_error_, counts_) {
  archive(saved);
}

// Allocates memory by the characteristic values and the ranks.
void MultibodySystem::resize() {
  traits_ = {.unknowns = sizes_.unknowns(),
             .differential = analysis_.values.d,
             .leading_size = sizes_.positions + sizes_.velocities};
  equations_.set_ranks(settings_.ranks);
  linearization_.resize(sizes_, settings_);
  noise_.resize(sizes_, differential());
  stages_.resize(sizes_, differential());
  projection_.resize(sizes_, linearization_.form());
  monitor_.resize(sizes_, settings_);
  for (MultibodyPoint* point : {&accepted_, &end_}) point->resize(sizes_);
}

CharacteristicValues MultibodySystem::values_at(double) {
  return characteristic_values(sizes_, monitor_.change().ranks);
}

std::optional<double> MultibodySystem::change_nearby() {
  // Relative to the longest step, which shows how fast the system moves away from singularities
  // (docs/design/singular_points.md).
  constexpr double near = 0.5;
  const NearbySingularity found = nearby_singularity(accepted_, settings_.ranks, equations_, arena_);
  if (!(std::fabs(found.t - accepted_.t) <= near * longest_step_)) return std::nullopt;
  monitor_.note_singularity(accepted_, found, linearization_.form(), arena_);
  return found.t;
}

std::string MultibodySystem::about_change() const {
  if (!monitor_.has_changed()) return {};
  return monitor_.message(equations_.problem()) + format(" At t = %.12g the condition of the constraints is %.2g.",
                                                         accepted_.t,
                                                         condition_of_constraints(accepted_, partition()));
}

PointStatus MultibodySystem::set_point(double t, const double* q, const double* v) {
  t_ = t;
  accepted_.set(t, q, v);
  PointStatus status = equations_.at_velocity(accepted_);
  if (status != PointStatus::ok) return status;
  accepted_.measure_rows();
  monitor_.forget();
  longest_step_ = 0.0;
  // State of an earlier integration, which must not affect the next one.
  linearization_.chord() = ChordIteration();
  linearization_.renewal() = MultibodyRenewal();
  status = linearize(t, q, v);
  if (status != PointStatus::ok) return status;
  if (!monitor_.has_known_ranks()) return PointStatus::changed;
  end_ = accepted_;
  // Values that are consistent stay bit by bit.
  using Moves = MultibodyProjection::Moves;
  const Moves moves = !positions_hold_to_rounding(end_)    ? Moves::all
                      : !velocities_hold_to_rounding(end_) ? Moves::velocities
                                                           : Moves::nothing;
  status = projection_.project(end_, equations_, linearization_.form(), arena_, moves);
  if (status != PointStatus::ok) return status;
  monitor_.start(projection_.tangents());
  is_end_new_ = true;
  accept();
  return PointStatus::ok;
}

PointStatus MultibodySystem::move_to(double t) {
  t_ = t;
  return PointStatus::ok;
}

void MultibodySystem::accept() {
  if (!is_end_new_) return;
  is_end_new_ = false;
  longest_step_ = std::max(longest_step_, std::fabs(end_.t - accepted_.t));
  std::swap(accepted_, end_);
  monitor_.accept();
}

PointStatus MultibodySystem::linearize(double t, const double* q, const double* v) {
  PointStatus status = linearization_.move_to(t, q, v, equations_);
  if (status == PointStatus::ok && !monitor_.fits(linearization_, arena_))
    status = monitor_.choose(linearization_, accepted_, projection_, arena_);
  if (status == PointStatus::ok) status = linearization_.build(equations_, arena_);
  if (status == PointStatus::ok) noise_.measure(linearization_.point(), linearization_.form(), arena_);
  return status;
}

// Starts from the predicted x of each point. The linearization at the middle one suits all of them best.
PointStatus MultibodySystem::iterate_from(const MultibodyDiscretization& discretization, const Guess& guess,
                                          bool linearizes) {
  const int s = discretization.s, middle = s / 2;
  for (int i = 0; i < s; ++i)
    std::copy_n(guess.taylor + static_cast<std::ptrdiff_t>(i) * unknowns(), leading_size(), stages_.qv.column(i));
  if (linearizes) {
    const double* qv = stages_.qv.column(middle);
    const PointStatus status = linearize(stages_.times[index(middle)], qv, qv + sizes_.positions);
    if (status != PointStatus::ok) return status;
  }
  return MultibodyIteration(discretization, guess.inverse_weights,
                            {equations_, linearization_, noise_, stages_, lanes_, arena_})
      .run();
}

PointStatus MultibodySystem::solve_points(const MultibodyDiscretization& discretization, const Guess& guess) {
  const int last = discretization.s - 1;
  projection_.set_weights(guess.inverse_weights);
  PointStatus status = PointStatus::not_converged;
  if (linearization_.is_valid() && !linearization_.chord().is_slow())
    status = iterate_from(discretization, guess, false);
  if (status != PointStatus::ok && !is_hopeless(status)) status = iterate_from(discretization, guess, true);
  if (status == PointStatus::ok) {
    const double* qv = stages_.qv.column(last);
    end_.set(stages_.times[index(last)], qv, qv + sizes_.positions);
    is_end_new_ = false;
    status = project(end_);
  }
  if (status == PointStatus::ok)
    for (int i = 0; i < last && status == PointStatus::ok; ++i)
      status = monitor_.check_within(stages_.orientations[index(i)], linearization_);
  if (status == PointStatus::ok) {
    status = monitor_.check(end_, accepted_, projection_.tangents(), linearization_, arena_);
    is_end_new_ = status == PointStatus::ok;
    return status;
  }
  // Steps toward a known singular configuration become shorter.
  const bool is_near_change =
      monitor_.has_changed() && (status == PointStatus::singular || status == PointStatus::not_converged);
  return is_near_change ? PointStatus::changed : status;
}

PointStatus MultibodySystem::solve(const StepEquations& equations, double* x) {
  stages_.reserve(1, linearization_.form());
  stages_.times[0] = t_;
  const PointStatus status = solve_points({1, nullptr, 0.0, equations.c, equations.w_rest}, equations.guess);
  if (status == PointStatus::ok) copy_unknowns(end_, x);
  return status;
}

// Cost in floating-point operations: evaluations, work once a step expressed as additional ones, and the factors of the
// decoupled systems, a real one and (s - 1) / 2 complex ones.
double MultibodySystem::stage_cost(int s) const {
  // Measured on the pendulum, where overhead dominates, and on all problems of the test set.
  constexpr double overhead = 2000.0, iterations = 3.0, once = 8.0;
  const double n = leading_size(), r = settings_.ranks.velocities, d = differential();
  const double evaluation = overhead + 4.0 * n * r * r + 8.0 * n * n, systems = 2.0 * s - 1.0;
  return (iterations * s + once) * evaluation + systems * (2.0 / 3.0 * d * d * d + 2.0 * iterations * d * d);
}

PointStatus MultibodySystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  const int s = equations.method.s, n = unknowns(), size = leading_size(), nc = sizes_.constraints();
  const double h = equations.t_end - equations.t;
  stages_.reserve(s, linearization_.form());
  t_reached = t_ = equations.t_end;
  for (int i = 0; i < s; ++i)
    stages_.times[index(i)] = i == s - 1 ? equations.t_end : equations.t + equations.method.c[index(i)] * h;
  const PointStatus status = solve_points({s, &equations.method, h, 0.0, equations.w}, equations.guess);
  if (status != PointStatus::ok) return status;
  // mu of the inner stages is that before the last change: its slopes depend on it.
  const Arena::Frame frame(arena_);
  const View dmu = arena_.matrix(nc, s), mu = stages_.mu.view(s), to_x{x, n, s, n}, to_w{w, size, s, size};
  linearization_.change_of_forces(stages_.changes.view(s), dmu, arena_);
  for (int i = 0; i < s; ++i)
    for (int k = 0; k < nc; ++k) mu(k, i) += dmu(k, i);
  for (int i = 0; i < s - 1; ++i) {
    std::copy_n(stages_.qv.column(i), size, to_x.column(i));
    std::copy_n(stages_.mu.column(i), nc, to_x.column(i) + size);
  }
  copy_unknowns(end_, to_x.column(s - 1));
  for (int i = 0; i < s; ++i) std::copy_n(to_x.column(i), size, to_w.column(i));
  return PointStatus::ok;
}

double MultibodySystem::change_of_differentiated(const double* dx, const double* tolerances) const {
  double largest = 0.0;
  for (int i = 0; i < leading_size(); ++i)
    if (tolerances[i] > 0.0) largest = std::max(largest, std::fabs(dx[i]) / tolerances[i]);
  return largest;
}

// Data of later steps stay unchanged: output points must not affect later ones.
void MultibodySystem::restore(const double*, const double* x_free, const Guess&, double* x) {
  if (is_at(accepted_, t_, x_free)) return copy_unknowns(accepted_, x);
  is_end_new_ = false;
  end_.set(t_, x_free, x_free + sizes_.positions);
  const PointStatus status = projection_.project_output(end_, equations_, linearization_.form(), arena_);
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                  format("no values consistent with the constraints were found at t = %.15g.", t_));
  copy_unknowns(end_, x);
}

// The point at x, with a and mu. Throws Failure.
const MultibodyPoint& MultibodySystem::point_at(const double* x) {
  for (const MultibodyPoint* point : {&accepted_, &end_})
    if (is_at(*point, t_, x)) return *point;
  is_end_new_ = false;
  end_.set(t_, x, x + sizes_.positions);
  const PointStatus status = equations_.evaluate(end_, partition());
  if (status == PointStatus::callback_error) callback_error_.raise();
  if (status != PointStatus::ok) throw Failure(SFDAE_SINGULAR, singular_message(t_));
  end_.measure_rows();
  end_.take_least_norm(partition(), arena_);
  return end_;
}

// q' = S v and v' = a are exact; mu' stays.
void MultibodySystem::correct_derivative(double, const double* x, double* xdot) {
  const MultibodyPoint& point = point_at(x);
  point.rates(xdot);
  std::copy(point.a.begin(), point.a.end(), xdot + sizes_.positions);
}

bool MultibodySystem::exact_derivative(const double* x, double* xdot) {
  // Steps h of BDF have c = alpha / h with alpha between 1 and 2.3: 3 / c is a step or some more.
  constexpr double steps = 3.0;
  const MultibodyPoint& point = point_at(x);
  const int nc = sizes_.constraints();
  const MultibodyStepMatrix& matrix = linearization_.matrix();
  const double time_scale = matrix.is_valid() && matrix.c() != 0.0 ? steps / std::fabs(matrix.c()) : 1.0;
  const Arena::Frame frame(arena_);
  double* mudot = arena_.take(index(nc));
  if (nc > 0 &&
      !MultibodyForceDifferences(equations_, partition(), stages_.point, arena_).derivative(point, time_scale, mudot))
    return false;
  point.rates(xdot);
  std::copy(point.a.begin(), point.a.end(), xdot + sizes_.positions);
  std::copy_n(mudot, nc, xdot + leading_size());
  return true;
}

bool MultibodySystem::consistent_derivative(const double* x, double, double* xdot) {
  const int nc = sizes_.constraints();
  if (!exact_derivative(x, xdot)) {
    correct_derivative(0.0, x, xdot);
    std::fill_n(xdot + leading_size(), nc, 0.0);
  }
  return nc == 0;
}

// Along Q2, g_q q' + g_t = 0 and C v' + s = 0; directions in Q1 of later partitions may be among them.
void MultibodySystem::correct_slopes(double* wdot, double* xdot) {
  const Tangents& tangents = projection_.tangents();
  const MultibodyForm& form = linearization_.form();
  tangents.positions.enforce(form.positions(), end_.terms.velocity_rest.data(), wdot, arena_);
  tangents.of_velocities().enforce(form.velocities(), end_.terms.acceleration_rest.data(), wdot + sizes_.positions,
                                   arena_);
  std::copy_n(wdot, leading_size(), xdot);
}

void MultibodySystem::error_in_x(const double* dw, int count, double* dx) {
  const int n = unknowns(), size = leading_size();
  const Arena::Frame frame(arena_);
  const View yz = arena_.matrix(differential(), count), to{dx, n, count, n};
  linearization_.form().project(ConstView{dw, size, count, size}, yz);
  linearization_.form().expand(yz, to.top(size));
  linearization_.error_of_forces(yz, to.block(size, 0, sizes_.constraints(), count), arena_);
}

void MultibodySystem::archive(Archive& archive) {
  const std::size_t nq = index(sizes_.positions), nv = index(sizes_.velocities);
  MultibodyRanks& ranks = settings_.ranks;
  ChordIteration& chord = linearization_.chord();
  MultibodyStepMatrix& matrix = linearization_.matrix();
  MultibodyOrientation orientation = monitor_.orientation();
  bool has_matrix = matrix.is_valid(), is_slow = chord.is_slow(), is_valid = linearization_.is_valid();
  archive.small(ranks.positions, ranks.velocities, analysis_.rank_E, has_matrix, is_valid, is_slow,
                orientation.positions, orientation.velocities);
  linearization_.renewal().archive(archive);
  long partitions = monitor_.count(), unused = 0;
  archive.counts(partitions, unused);
  archive.real(analysis_.t);
  chord.archive_rate(archive);
  matrix.archive_c(archive);
  if (archive.is_reading()) {
    const bool plausible = ranks.positions >= 0 && ranks.positions <= std::min(sizes_.positions, sizes_.holonomic) &&
                           ranks.velocities >= 0 &&
                           ranks.velocities <= std::min(sizes_.velocities, sizes_.constraints()) &&
                           ranks.velocities <= ranks.positions + sizes_.nonholonomic;
    if (!plausible || partitions < 1) throw DamagedArchive();
    analysis_.values = characteristic_values(sizes_, ranks);
    analysis_.v_hat = sizes_.constraints() - ranks.velocities;
    chord.set_slow(is_slow);
    linearization_.set_valid(is_valid);
    monitor_.restore(orientation, partitions);
    resize();
  } else if (!is_valid) {
    // If there is no linearization, the last point is used.
    linearization_.move_to(accepted_);
  }
  const auto archive_point = [&](auto& point) {
    archive.real(point.t);
    archive.reals(point.q, nq);
    archive.reals(point.v, nv);
  };
  MultibodyPhasePoint linearized = linearization_.point().phase_point();
  archive_point(accepted_);
  archive_point(monitor_.origin());
  archive_point(linearized);
  archive.real(longest_step_);
  archive.reals(accepted_.a, nv);
  archive.reals(accepted_.mu, index(sizes_.constraints()) + 1);
  if (archive.is_reading()) rebuild(linearized, has_matrix ? matrix.c() : 0.0);
}

// Restores the partition and the linearization. c != 0: steps whose coefficient differs from it by rounding errors use
// this matrix unchanged.
void MultibodySystem::rebuild(const MultibodyPhasePoint& linearized, double c) {
  ChordIteration& chord = linearization_.chord();
  const bool was_slow = chord.is_slow(), was_valid = linearization_.is_valid(),
             was_fresh = linearization_.renewal().is_fresh();
  const double rate = chord.rate();
  const MultibodyOrientation orientation = monitor_.orientation();
  const long partitions = monitor_.count();
  const MultibodyPhasePoint& origin = monitor_.origin();
  const auto demand = [](PointStatus status) {
    if (status != PointStatus::ok) throw DamagedArchive();
  };
  t_ = accepted_.t;
  demand(equations_.at_velocity(accepted_));
  const bool same_rows = accepted_.terms.S.rows() == 0 && sizes_.nonholonomic == 0;
  if (same_rows && settings_.ranks.positions != settings_.ranks.velocities) throw DamagedArchive();
  accepted_.measure_rows();
  end_ = accepted_;
  demand(linearization_.move_to_position(origin.t, origin.q.data(), origin.v.data(), equations_));
  demand(monitor_.choose(linearization_, accepted_, projection_, arena_));
  monitor_.restore(orientation, partitions);
  demand(linearize(linearized.t, linearized.q.data(), linearized.v.data()));
  linearization_.set_valid(was_valid);
  chord.set_slow(was_slow);
  chord.set_rate(rate);
  linearization_.renewal().set_fresh(was_fresh);
  MultibodyStepMatrix& matrix = linearization_.matrix();
  matrix.forget();
  long uncounted = 0;
  if (c != 0.0 && matrix.factor(linearization_.form(), c, uncounted))
    noise_.measure_steps(linearization_.form(), matrix, arena_);
}

}  // namespace sfdae::core
