// Steps of a mechanical system: the chord iteration for one point or several together.
//
// With (y_i, z_i) the changes of stage i in local coordinates and p_i = -N (residuals) its particular change, the
// stages are
//
//     sum_j D_ij / h (y_j, z_j) - B (y_i, z_i) = (Q_q1^T S v_i, Q_v1^T a_i) + (those of p_i) - (Q1^T D_h w)_i
//
// where Q1^T p_i = 0.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_system.h"

namespace sfdae::core {

// A partition from which the constraints have turned by more than 45 degrees is replaced; components as they are
// differ by a factor from the beginning.
double MultibodySystem::largest_rotation() const {
  return settings_.coordinates == Coordinates::orthogonal ? 1.0 : 10.0;
}

void MultibodySystem::resize_stages(int s) {
  const std::size_t stages = index(s), size = index(leading_size()), d = index(differential()),
                    nc = index(sizes_.constraints());
  const auto grow = [](std::vector<double>& values, std::size_t count) {
    if (values.size() < count + 1) values.resize(count + 1);
  };
  while (stage_tangents_.size() < stages) form_.resize_tangents(stage_tangents_.emplace_back());
  grow(times_, stages);
  for (auto* values : {&stage_qv_, &stage_particular_, &stage_changes_}) grow(*values, stages * size);
  grow(stage_rates_, stages * index(sizes_.positions));
  grow(stage_a_, stages * index(sizes_.velocities));
  grow(stage_mu_, stages * nc);
  for (auto* values : {&stage_moves_, &stage_r_, &stage_z_}) grow(*values, stages * d);
}

PointStatus MultibodySystem::linearize(double t, const double* qv) {
  is_linearized_ = false;
  matrix_.forget();
  linearized_.set(t, qv, qv + sizes_.positions);
  callback_error_ = problem_.at_velocity(t, linearized_.q.data(), linearized_.v.data(), linearized_.terms);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  linearized_.measure_rows();
  if (partitions_ == 0 || !form_.build_tangents(linearized_, arena_) ||
      form_.tangents().rotation() > largest_rotation()) {
    const PointStatus status = choose_partition();
    if (status != PointStatus::ok) return status;
  }
  if (!linearized_.factor(form_.velocities().rows, settings_.ranks.velocities)) return PointStatus::singular;
  linearized_.solve_accelerations(form_.velocities().rows, settings_.ranks.velocities);
  callback_error_ = problem_.linearize(linearized_.state(), linearized_.terms, jacobian_);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  form_.build(linearized_, jacobian_, arena_);
  measure_noise();
  ++counts_.reductions;
  ++counts_.factorizations;
  is_linearized_ = is_fresh_ = true;
  chord_.forget_rate();
  return PointStatus::ok;
}

// At the point to be linearized; the orientation is that of the point accepted last.
PointStatus MultibodySystem::choose_partition() {
  const MultibodyForm::Ranks found = form_.choose(linearized_, settings_.coordinates, arena_);
  decided_ = {found.positions.rank, found.velocities.rank};
  if (!form_.build_tangents(linearized_, arena_)) return PointStatus::singular;
  chosen_.set(linearized_.t, linearized_.q.data(), linearized_.v.data());
  ++partitions_;
  if (form_.build_tangents(accepted_, end_tangents_, arena_)) orientation_ = orientation_of(end_tangents_);
  return PointStatus::ok;
}

// Errors of a rounding of what is added up in each equation, of either sign, go the way of residuals. One sample
// tells their size to some factor.
void MultibodySystem::measure_noise() {
  const int nq = sizes_.positions, nv = sizes_.velocities, nl = sizes_.holonomic, nc = sizes_.constraints(),
            r = settings_.ranks.velocities;
  const MultibodyPoint& point = linearized_;
  const MultibodyTerms& terms = point.terms;
  const Arena::Frame frame(arena_);
  double* g = arena_.zeros(index(nl) + 1);
  double* velocity = arena_.zeros(index(nc) + 1);
  double* forces = arena_.zeros(index(nv + nc) + 1);
  double* rates = arena_.zeros(index(nq + nv));
  const auto sign = [](int i) { return i % 2 == 0 ? unit_roundoff : -unit_roundoff; };
  for (int j = 0; j < nq; ++j)
    for (int i = 0; i < nl; ++i) g[i] += sign(i) * std::fabs(terms.g_q(i, j) * point.q[index(j)]);
  for (int j = 0; j < nv; ++j) {
    const std::size_t column = index(j);
    for (int i = 0; i < nc; ++i) velocity[i] += sign(i) * std::fabs(terms.C(i, j) * point.v[column]);
    for (int i = 0; i < nv; ++i) forces[i] += sign(i) * std::fabs(terms.M(i, j) * point.a[column]);
    for (int i = 0; i < nc; ++i) forces[j] += sign(j) * std::fabs(terms.C(i, j) * point.mu[index(i)]);
    forces[j] += sign(j) * std::fabs(terms.f[column]);
    for (int k = 0; k < r; ++k)
      forces[nv + k] += sign(k) * std::fabs(terms.C(form_.velocities().rows[index(k)], j) * point.a[column]);
  }
  for (int k = 0; k < r; ++k)
    forces[nv + k] += sign(k) * std::fabs(terms.acceleration_rest[index(form_.velocities().rows[index(k)])]);
  form_.particular(form_.tangents(), {g, velocity}, noise_at_rest_.data(), arena_);
  point.solve(forces);
  std::copy_n(forces, nv, rates + nq);
  form_.project(rates, noise_of_rates_.data());
  // What local coordinates are rounded to.
  double* yz = arena_.take(index(differential()) + 1);
  for (int k = 0; k < nq; ++k) rates[k] = sign(k) * std::fabs(point.q[index(k)]);
  for (int k = 0; k < nv; ++k) rates[nq + k] = sign(k) * std::fabs(point.v[index(k)]);
  form_.project(rates, yz);
  const int d = differential(), ld = std::max(d, 1);
  form_.expand(ConstView{yz, d, 1, ld}, View{change_.data(), nq + nv, 1, nq + nv});
  for (int k = 0; k < nq + nv; ++k)
    noise_at_rest_[index(k)] =
        std::fabs(noise_at_rest_[index(k)]) + std::fabs(change_[index(k)]) + std::fabs(rates[k]);
}

void MultibodySystem::measure_noise_of_step() {
  constexpr double samples = 8.0;
  const int d = differential();
  const Arena::Frame frame(arena_);
  double* yz = arena_.take(index(d) + 1);
  std::copy_n(noise_of_rates_.data(), d, yz);
  matrix_.solve(yz);
  form_.expand(ConstView{yz, d, 1, std::max(d, 1)}, View{noise_.data(), leading_size(), 1, leading_size()});
  for (int k = 0; k < leading_size(); ++k)
    noise_[index(k)] = samples * (std::fabs(noise_[index(k)]) + noise_at_rest_[index(k)]);
}

bool MultibodySystem::factor_step_matrices(const Task& task) {
  const double c = task.method != nullptr ? task.method->gamma / task.h : task.c;
  if (!matrix_.is_valid() || !matrix_.is_for(c)) {
    if (!matrix_.factor(form_, 1.0, c, counts_.factorizations)) return false;
    measure_noise_of_step();
  }
  return task.method == nullptr || matrix_.factor_stages(form_, 1.0, *task.method, counts_.factorizations);
}

// Right-hand side of stage i but for slopes, and its particular change.
PointStatus MultibodySystem::read_stage(const Task& task, int i, bool is_first) {
  const int nq = sizes_.positions, size = leading_size(), d = differential(), nc = sizes_.constraints();
  const double* qv = stage(i);
  work_.set(times_[index(i)], qv, qv + nq);
  callback_error_ = problem_.at_velocity(work_.t, work_.q.data(), work_.v.data(), work_.terms);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  // Rows are about as long as at the linearization.
  work_.position_units = linearized_.position_units;
  work_.velocity_units = linearized_.velocity_units;
  Tangents& tangents = stage_tangents_[index(i)];
  if (!form_.fit_tangents(work_, tangents)) return PointStatus::singular;
  const PointStatus status = accelerate(work_, tangents);
  if (status != PointStatus::ok) return status;
  std::copy_n(work_.mu.data(), nc, stage_mu_.data() + static_cast<std::ptrdiff_t>(i) * nc);
  double* particular = stage_particular_.data() + static_cast<std::ptrdiff_t>(i) * size;
  work_.velocity_residuals(residuals_.data());
  form_.particular(tangents, {work_.terms.g.data(), residuals_.data()}, particular, arena_);
  form_.moved_rates(work_, particular, stage_rates_.data() + static_cast<std::ptrdiff_t>(i) * nq, arena_);
  std::copy(work_.a.begin(), work_.a.end(), stage_a_.begin() + static_cast<std::ptrdiff_t>(i) * sizes_.velocities);
  if (!is_first) return PointStatus::ok;
  for (int k = 0; k < size; ++k)
    change_[index(k)] = task.method != nullptr ? qv[k] - task.w[k] : task.c * qv[k] + task.w[k];
  form_.project(change_.data(), stage_moves_.data() + static_cast<std::ptrdiff_t>(i) * d);
  return PointStatus::ok;
}

// r := Q1^T (q', v') - Q1^T D_h w
void MultibodySystem::complete_residuals(const Task& task) {
  const int d = differential(), ld = std::max(d, 1), s = task.s, size = leading_size(), nq = sizes_.positions,
            nv = sizes_.velocities;
  const View r{stage_r_.data(), d, s, ld};
  form_.rates({stage_rates_.data(), nq, s, nq}, {stage_a_.data(), nv, s, nv},
              {stage_particular_.data(), size, s, size}, r);
  if (task.method != nullptr)
    multiply(-1.0 / task.h, Op::plain, ConstView{stage_moves_.data(), d, s, ld}, Op::transposed,
             ConstView{task.method->D.data(), s, s, s}, 1.0, r);
  else
    for (int k = 0; k < d; ++k) r.data[k] -= stage_moves_[index(k)];
}

PointStatus MultibodySystem::iterate(const Task& task) {
  constexpr int most = 12;
  const int size = leading_size(), d = differential(), ld = std::max(d, 1), s = task.s;
  if (!factor_step_matrices(task)) return PointStatus::singular;
  double before = 0.0;
  chord_.begin();
  for (int iteration = 0; iteration < most; ++iteration) {
    for (int i = 0; i < s; ++i) {
      const PointStatus status = read_stage(task, i, iteration == 0);
      if (status != PointStatus::ok) return status;
    }
    complete_residuals(task);
    const View r{stage_r_.data(), d, s, ld}, z{stage_z_.data(), d, s, ld};
    if (task.method != nullptr) {
      matrix_.solve_stages(*task.method, r, z, arena_);
    } else {
      std::copy_n(r.data, d, z.data);
      matrix_.solve(z.data);
    }
    // As Q1^T p = 0 the changes of Q1^T q and Q1^T v are known.
    const double rate_of_moves = task.method != nullptr ? 1.0 : task.c;
    for (int k = 0; k < s * d; ++k) stage_moves_[index(k)] += rate_of_moves * stage_z_[index(k)];
    form_.expand(stage_tangents_.data(), z, {stage_changes_.data(), size, s, size}, arena_);
    double norm = 0.0;
    for (int k = 0; k < s * size; ++k) {
      stage_changes_[index(k)] += stage_particular_[index(k)];
      stage_qv_[index(k)] += stage_changes_[index(k)];
    }
    for (int i = 0; i < s; ++i)
      norm = std::max(norm, change_norm(task, stage_changes_.data() + static_cast<std::ptrdiff_t>(i) * size));
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    if (has_converged(task, iteration, norm, before)) {
      judge_linearization(s, iteration + 1);
      return PointStatus::ok;
    }
    if (ChordIteration::is_too_slow(iteration, norm, before)) return PointStatus::not_converged;
    before = norm;
  }
  return PointStatus::not_converged;
}

// In units of the tolerance; rounding errors will not become less.
double MultibodySystem::change_norm(const Task& task, const double* change) const {
  double norm = 0.0;
  for (int k = 0; k < leading_size(); ++k) {
    if (!std::isfinite(change[k])) return change[k];
    norm = std::max(norm, (std::fabs(change[k]) - noise_[index(k)]) * task.inverse_weights[k]);
  }
  return norm;
}

// Slopes amplify errors of stages: at least two changes are made.
bool MultibodySystem::has_converged(const Task& task, int iteration, double norm, double before) {
  constexpr double least_rate = 0.03;
  const bool has_stages = task.method != nullptr;
  const ChordTarget target{has_stages ? stage_tolerance : step_tolerance, least_rate, has_stages};
  return chord_.has_converged(target, iteration, norm, before);
}

// A new linearization for the next step pays if it saves enough iterations; how many it needs, and how many more the
// one of the step before, is known from the steps taken last.
void MultibodySystem::judge_linearization(int s, int iterations) {
  // Every so often one is kept to see.
  constexpr int most_in_a_row = 10;
  // In evaluations of one stage, measured: the linear algebra of its own grows faster than theirs.
  const double cost = 2.0 + differential() / 8.0;
  if (is_fresh_) {
    fresh_iterations_ = iterations;
    if (fresh_in_a_row_ < most_in_a_row) ++fresh_in_a_row_;
    else fresh_in_a_row_ = kept_iterations_ = 0;
  } else {
    kept_iterations_ = iterations;
  }
  is_fresh_ = false;
  if (s * (kept_iterations_ - fresh_iterations_) >= cost) chord_.set_slow(true);
}

// guess: predicted x of each point. The middle one is where one linearization serves all of them best.
PointStatus MultibodySystem::solve_points(const Task& task, const double* guess) {
  const int n = unknowns(), size = leading_size(), middle = task.s / 2;
  std::copy_n(task.inverse_weights, size, inverse_weights_.data());
  const auto start = [&] {
    for (int i = 0; i < task.s; ++i) std::copy_n(guess + static_cast<std::ptrdiff_t>(i) * n, size, stage(i));
  };
  PointStatus status = PointStatus::not_converged;
  if (is_linearized_ && !chord_.is_slow()) {
    start();
    status = iterate(task);
  }
  if (status != PointStatus::ok && !is_hopeless(status)) {
    start();
    status = linearize(times_[index(middle)], stage(middle));
    if (status == PointStatus::ok) status = iterate(task);
  }
  if (status == PointStatus::ok) {
    const double* last = stage(task.s - 1);
    end_.set(times_[index(task.s - 1)], last, last + sizes_.positions);
    is_end_new_ = false;
    status = project(end_);
  }
  if (status == PointStatus::ok) {
    status = check_ranks(end_);
    is_end_new_ = status == PointStatus::ok;
    return status;
  }
  // Shorter steps toward a singular configuration that has been seen already.
  const bool is_near_change =
      has_changed_ && (status == PointStatus::singular || status == PointStatus::not_converged);
  return is_near_change ? PointStatus::changed : status;
}

PointStatus MultibodySystem::solve(const StepEquations& equations, double* x) {
  resize_stages(1);
  times_[0] = t_;
  const Task task{1, nullptr, 0.0, equations.c, equations.w_rest, equations.guess.inverse_weights};
  const PointStatus status = solve_points(task, equations.guess.taylor);
  if (status != PointStatus::ok) return status;
  std::copy(end_.q.begin(), end_.q.end(), x);
  std::copy(end_.v.begin(), end_.v.end(), x + sizes_.positions);
  std::copy_n(end_.mu.data(), sizes_.constraints(), x + leading_size());
  return PointStatus::ok;
}

// In floating-point operations: evaluations, what is done once a step as if it were some more of them, and the
// factors of the decoupled systems, a real one and (s - 1) / 2 complex ones.
double MultibodySystem::stage_cost(int s) const {
  // Measured on the pendulum, where there is hardly anything else, and from all problems of the test set.
  constexpr double overhead = 2000.0, iterations = 3.0, once = 8.0;
  const double n = leading_size(), r = settings_.ranks.velocities, d = differential();
  const double evaluation = overhead + 4.0 * n * r * r + 8.0 * n * n, systems = 2.0 * s - 1.0;
  return (iterations * s + once) * evaluation + systems * (2.0 / 3.0 * d * d * d + 2.0 * iterations * d * d);
}

PointStatus MultibodySystem::solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) {
  const int s = equations.method.s, n = unknowns(), size = leading_size(), nc = sizes_.constraints();
  const double h = equations.t_end - equations.t;
  resize_stages(s);
  t_reached = t_ = equations.t_end;
  for (int i = 0; i < s; ++i)
    times_[index(i)] = i == s - 1 ? equations.t_end : equations.t + equations.method.c[index(i)] * h;
  const Task task{s, &equations.method, h, 0.0, equations.w, equations.guess.inverse_weights};
  const PointStatus status = solve_points(task, equations.guess.taylor);
  if (status != PointStatus::ok) return status;
  // mu of the stages within is that before the last change: slopes of mu depend on it.
  const Arena::Frame frame(arena_);
  const View dmu = arena_.matrix(nc, s);
  change_of_forces({stage_changes_.data(), size, s, size}, dmu);
  for (int i = 0; i < s; ++i)
    for (int k = 0; k < nc; ++k) stage_mu_[index(i * nc + k)] += dmu(k, i);
  std::copy(end_.q.begin(), end_.q.end(), stage(s - 1));
  std::copy(end_.v.begin(), end_.v.end(), stage(s - 1) + sizes_.positions);
  std::copy_n(end_.mu.data(), nc, stage_mu_.data() + static_cast<std::ptrdiff_t>(s - 1) * nc);
  for (int i = 0; i < s; ++i) {
    std::copy_n(stage(i), size, x + static_cast<std::ptrdiff_t>(i) * n);
    std::copy_n(stage(i), size, w + static_cast<std::ptrdiff_t>(i) * size);
    std::copy_n(stage_mu_.data() + static_cast<std::ptrdiff_t>(i) * nc, nc,
                x + static_cast<std::ptrdiff_t>(i) * n + size);
  }
  return PointStatus::ok;
}

}  // namespace sfdae::core
