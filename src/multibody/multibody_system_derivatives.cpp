// Points of a mechanical system that are asked for: x, x', errors in x, checkpoints.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_system.h"

namespace sfdae::core {

// What later steps depend on stays as it is: points that are asked for must not change those that follow.
void MultibodySystem::restore(const double*, const double* x_free, double* x) {
  const int nq = sizes_.positions, nc = sizes_.constraints();
  const auto is_at = [&](const MultibodyPoint& point) {
    return point.t == t_ && std::equal(point.q.begin(), point.q.end(), x_free) &&
           std::equal(point.v.begin(), point.v.end(), x_free + nq);
  };
  const MultibodyPoint* point = &accepted_;
  if (!is_at(accepted_)) {
    is_end_new_ = false;
    end_.set(t_, x_free, x_free + nq);
    const PointStatus status = project(end_);
    if (status == PointStatus::callback_error) throw Failure(callback_error_.status, callback_error_.message());
    if (status != PointStatus::ok)
      throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                    format("no values consistent with the constraints were found at t = %.15g.", t_));
    point = &end_;
  }
  std::copy(point->q.begin(), point->q.end(), x);
  std::copy(point->v.begin(), point->v.end(), x + nq);
  std::copy_n(point->mu.data(), nc, x + leading_size());
}

// With a and mu known. Throws Failure.
const MultibodyPoint& MultibodySystem::point_at(const double* x) {
  const int nq = sizes_.positions;
  for (const MultibodyPoint* point : {&accepted_, &end_})
    if (point->t == t_ && std::equal(point->q.begin(), point->q.end(), x) &&
        std::equal(point->v.begin(), point->v.end(), x + nq))
      return *point;
  is_end_new_ = false;
  end_.set(t_, x, x + nq);
  const PointStatus status = evaluate(end_);
  if (status == PointStatus::callback_error) throw Failure(callback_error_.status, callback_error_.message());
  if (status != PointStatus::ok) throw Failure(SFDAE_SINGULAR, format("[M C^T; C 0] is singular at t = %.15g.", t_));
  end_.measure_rows();
  end_.take_least_norm(form_.velocities(), arena_);
  return end_;
}

// q' = S v and v' = a are exact; mu' stays.
void MultibodySystem::correct_derivative(double, const double* x, double* xdot) {
  const MultibodyPoint& point = point_at(x);
  point.rates(xdot);
  std::copy(point.a.begin(), point.a.end(), xdot + sizes_.positions);
}

bool MultibodySystem::exact_derivative(const double* x, double* xdot) {
  const MultibodyPoint& point = point_at(x);
  const int nc = sizes_.constraints();
  if (nc > 0 && !difference_of_forces(point, residuals_.data())) return false;
  point.rates(xdot);
  std::copy(point.a.begin(), point.a.end(), xdot + sizes_.positions);
  std::copy_n(residuals_.data(), nc, xdot + leading_size());
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

// mu at t + s, q + s q', v + s v': mu(t, q, v) is smooth beside the constraints, too, so that the tangent will do.
PointStatus MultibodySystem::forces_beside(const MultibodyPoint& point, double s, double* mu) {
  work_.t = point.t + s;
  point.rates(work_.q.data());
  for (std::size_t i = 0; i < work_.q.size(); ++i) work_.q[i] = point.q[i] + s * work_.q[i];
  for (std::size_t i = 0; i < work_.v.size(); ++i) work_.v[i] = point.v[i] + s * point.a[i];
  const PointStatus status = evaluate(work_);
  if (status != PointStatus::ok) return status;
  work_.take_least_norm(form_.velocities(), arena_);
  std::copy_n(work_.mu.data(), sizes_.constraints(), mu);
  return PointStatus::ok;
}

// Differences of order 4 along the solution, on the side that may be evaluated.
bool MultibodySystem::difference_of_forces(const MultibodyPoint& point, double* mudot) {
  constexpr double part_of_time_scale = 1e-3;
  const int nc = sizes_.constraints();
  const Arena::Frame frame(arena_);
  double* mu = arena_.take(index(nc));
  double* rates = arena_.take(index(sizes_.positions));
  point.rates(rates);
  const double q = max_abs(point.q.data(), sizes_.positions), a = max_abs(point.a.data(), sizes_.velocities),
               speed = max_abs(rates, sizes_.positions);
  double tau = matrix_.is_valid() && matrix_.c() != 0.0 ? 3.0 / std::fabs(matrix_.c()) : 1.0;
  if (q > 0.0 && speed > 0.0) tau = std::min(tau, q / speed);
  if (q > 0.0 && a > 0.0) tau = std::min(tau, std::sqrt(q / a));
  double s = std::max(part_of_time_scale * tau, 1e6 * unit_roundoff * std::fabs(point.t));
  const double ahead = problem_.room(point.t, 1.0), behind = problem_.room(point.t, -1.0);
  const bool is_central = ahead >= 2.0 * s && behind >= 2.0 * s;
  if (!is_central) s = ahead >= behind ? std::min(s, 0.25 * ahead) : -std::min(s, 0.25 * behind);
  if (s == 0.0) return false;
  constexpr int central_places[] = {-2, -1, 1, 2}, side_places[] = {0, 1, 2, 3, 4};
  constexpr double central_weights[] = {1.0, -8.0, 8.0, -1.0}, side_weights[] = {-25.0, 48.0, -36.0, 16.0, -3.0};
  std::fill_n(mudot, nc, 0.0);
  for (int k = 0; k < (is_central ? 4 : 5); ++k) {
    const int place = is_central ? central_places[k] : side_places[k];
    const double weight = (is_central ? central_weights[k] : side_weights[k]) / (12.0 * s);
    if (place == 0) std::copy_n(point.mu.data(), nc, mu);
    else if (forces_beside(point, place * s, mu) != PointStatus::ok) {
      if (callback_error_.status != SFDAE_OK && !callback_error_.is_recoverable())
        throw Failure(callback_error_.status, callback_error_.message());
      return false;
    }
    for (int i = 0; i < nc; ++i) mudot[i] += weight * mu[i];
  }
  return all_finite(mudot, index(nc));
}

// Along Q2, g_q q' + g_t = 0 and C v' + s = 0; directions in Q1 of later partitions may be among them.
void MultibodySystem::correct_slopes(double* wdot, double* xdot) {
  const MultibodyTerms& terms = end_.terms;
  end_tangents_.positions.enforce(form_.positions(), terms.velocity_rest.data(), wdot, arena_);
  end_tangents_.of_velocities().enforce(form_.velocities(), terms.acceleration_rest.data(), wdot + sizes_.positions,
                                        arena_);
  std::copy_n(wdot, leading_size(), xdot);
}

void MultibodySystem::error_in_x(const double* dw, int count, double* dx) {
  const int n = unknowns(), size = leading_size(), d = differential();
  const Arena::Frame frame(arena_);
  const View yz = arena_.matrix(d, count), to{dx, n, count, n};
  form_.project(ConstView{dw, size, count, size}, yz);
  form_.expand(yz, to.top(size));
  error_of_forces(yz, to.block(size, 0, sizes_.constraints(), count));
}

// With (I - B / c)^-1 yz in place of yz: what is stiff over the step has hardly any error, but mu depends on it very
// much. yz is overwritten.
void MultibodySystem::error_of_forces(View yz, View dmu) {
  const int d = differential(), count = yz.cols;
  if (d == 0) return fill(dmu, 0.0);
  const Arena::Frame frame(arena_);
  const View dqv = arena_.matrix(leading_size(), count);
  if (matrix_.is_valid()) {
    matrix_.solve(yz);
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < d; ++k) yz(k, j) *= matrix_.c();
  }
  form_.expand(yz, dqv);
  change_of_forces(dqv, dmu);
}

// K (da; dmu) = (force_q dq + force_v dv; -(C a + s)_q dq - (C a + s)_v dv), from the linearization.
void MultibodySystem::change_of_forces(ConstView dqv, View dmu) {
  const int nq = sizes_.positions, nv = sizes_.velocities, nc = sizes_.constraints(), r = settings_.ranks.velocities,
            count = dqv.cols;
  const std::vector<int>& rows = form_.velocities().rows;
  fill(dmu, 0.0);
  if (r == 0) return;
  const Arena::Frame frame(arena_);
  const View forces = arena_.matrix(nv + r, count), rest = arena_.matrix(nc, count);
  const ConstView dq = dqv.top(nq), dv = dqv.block(nq, 0, nv, count);
  multiply(1.0, Op::plain, jacobian_.force_q, Op::plain, dq, 0.0, forces.top(nv));
  multiply(1.0, Op::plain, jacobian_.force_v, Op::plain, dv, 1.0, forces.top(nv));
  multiply(-1.0, Op::plain, jacobian_.acceleration_q, Op::plain, dq, 0.0, rest);
  multiply(-1.0, Op::plain, jacobian_.acceleration_v, Op::plain, dv, 1.0, rest);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < r; ++k) forces(nv + k, j) = rest(rows[index(k)], j);
  linearized_.solve(forces);
  for (int j = 0; j < count; ++j)
    for (int k = 0; k < r; ++k) dmu(rows[index(k)], j) = forces(nv + k, j);
  // As mu itself: with other units of the constraints the part that does not matter may be by far the largest.
  for (int j = 0; j < count; ++j) linearized_.take_least_norm(form_.velocities(), dmu.column(j), arena_);
}

void MultibodySystem::archive(Archive& archive) {
  MultibodyRanks& ranks = settings_.ranks;
  bool has_matrix = matrix_.is_valid(), is_slow = chord_.is_slow(), has_linearization = is_linearized_;
  archive.small(ranks.positions, ranks.velocities, analysis_.rank_E, has_matrix, has_linearization, is_slow,
                orientation_.positions, orientation_.velocities);
  archive.small(is_fresh_, fresh_iterations_, kept_iterations_, fresh_in_a_row_);
  long unused = 0;
  archive.counts(partitions_, unused);
  archive.real(analysis_.t);
  chord_.archive_rate(archive);
  matrix_.archive_c(archive);
  chord_.set_slow(is_slow);
  const double rate = chord_.rate(), c = matrix_.c();
  if (archive.is_reading()) {
    const bool plausible = ranks.positions >= 0 && ranks.positions <= std::min(sizes_.positions, sizes_.holonomic) &&
                           ranks.velocities >= 0 &&
                           ranks.velocities <= std::min(sizes_.velocities, sizes_.constraints());
    if (!plausible || partitions_ < 1) throw DamagedArchive();
    analysis_.values = characteristic_values(sizes_, ranks);
    analysis_.v_hat = sizes_.constraints() - ranks.velocities;
    update_traits();
    resize();
  }
  // Where there is no linearization, that at the last point will do.
  if (!archive.is_reading() && !is_linearized_) linearized_ = accepted_;
  for (MultibodyPoint* point : {&accepted_, &chosen_, &linearized_}) {
    archive.real(point->t);
    archive.reals(point->q, index(sizes_.positions));
    archive.reals(point->v, index(sizes_.velocities));
  }
  archive.reals(accepted_.a, index(sizes_.velocities));
  archive.reals(accepted_.mu, index(sizes_.constraints()) + 1);
  if (archive.is_reading()) rebuild(has_linearization, has_matrix ? c : 0.0, rate);
}

// The partition and the linearization as they were. c != 0: steps that differ from it by rounding are taken with this
// very matrix.
void MultibodySystem::rebuild(bool has_linearization, double c, double rate) {
  const bool was_slow = chord_.is_slow(), was_fresh = is_fresh_;
  const MultibodyPoint where = linearized_;
  t_ = accepted_.t;
  callback_error_ = problem_.at_velocity(t_, accepted_.q.data(), accepted_.v.data(), accepted_.terms);
  if (callback_error_.status != SFDAE_OK) throw DamagedArchive();
  accepted_.measure_rows();
  end_ = accepted_;
  const Orientation orientation = orientation_;
  const long partitions = partitions_;
  linearized_.set(chosen_.t, chosen_.q.data(), chosen_.v.data());
  callback_error_ = problem_.at_position(chosen_.t, chosen_.q.data(), linearized_.terms);
  if (callback_error_.status != SFDAE_OK) throw DamagedArchive();
  linearized_.measure_rows();
  if (choose_partition() != PointStatus::ok) throw DamagedArchive();
  partitions_ = partitions;
  orientation_ = end_orientation_ = orientation;
  std::copy(where.q.begin(), where.q.end(), change_.data());
  std::copy(where.v.begin(), where.v.end(), change_.data() + sizes_.positions);
  if (linearize(where.t, change_.data()) != PointStatus::ok) throw DamagedArchive();
  is_linearized_ = has_linearization;
  chord_.set_slow(was_slow);
  is_fresh_ = was_fresh;
  chord_.set_rate(rate);
  matrix_.forget();
  if (c == 0.0) return;
  long uncounted = 0;
  if (matrix_.factor(form_, 1.0, c, uncounted)) measure_noise_of_step();
}

}  // namespace sfdae::core
