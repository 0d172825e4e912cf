// The strangeness-free system of a mechanical system with constraints: points, constraints, partitions.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

namespace {

double largest(const std::vector<double>& values) { return max_abs(values.data(), static_cast<int>(values.size())); }

// What residuals are compared with.
double size_of(const std::vector<double>& values) {
  const double size = largest(values);
  return size > 0.0 ? size : 1.0;
}

}  // namespace

CharacteristicValues characteristic_values(const MultibodySizes& sizes, const MultibodyRanks& ranks) {
  CharacteristicValues values;
  values.mu = sizes.holonomic > 0 ? 2 : sizes.nonholonomic > 0 ? 1 : 0;
  values.d = sizes.positions - ranks.positions + sizes.velocities - ranks.velocities;
  values.a = sizes.unknowns() - values.d;
  values.u = values.v = 0;
  return values;
}

MultibodySystem::MultibodySystem(MultibodyProblem& problem, const Settings& settings, IndexAnalysis analysis,
                                 const double* q, const double* v)
    : DaeSystem(problem, problem.sizes().unknowns(), std::move(analysis), LeadingTerm::identity),
      problem_(problem),
      sizes_(problem.sizes()),
      settings_(settings) {
  update_traits();
  resize();
  const PointStatus status = set_point(analysis_.t, q, v);
  if (status == PointStatus::callback_error) throw Failure(callback_error_.status, callback_error_.message());
  if (status == PointStatus::singular)
    throw Failure(SFDAE_SINGULAR, format("[M C^T; C 0] is singular at t = %.15g.", t_));
}

MultibodySystem::MultibodySystem(MultibodyProblem& problem, const Settings& settings, Archive& saved)
    : DaeSystem(problem, problem.sizes().unknowns(), {}, LeadingTerm::identity),
      problem_(problem),
      sizes_(problem.sizes()),
      settings_(settings) {
  archive(saved);
}

void MultibodySystem::update_traits() {
  traits_ = {.unknowns = sizes_.unknowns(),
             .differential = analysis_.values.d,
             .leading_size = sizes_.positions + sizes_.velocities};
}

CharacteristicValues MultibodySystem::values_at(double) { return characteristic_values(sizes_, changed_ranks_); }

void MultibodySystem::resize() {
  const std::size_t d = index(differential()), size = index(leading_size());
  form_.resize(sizes_, settings_.ranks.positions, settings_.ranks.velocities);
  form_.set_rank_tol(settings_.rank_tol);
  jacobian_ = MultibodyJacobian(sizes_);
  // Operations of both ways, about.
  constexpr double worthwhile = 1.2;
  const double nv = sizes_.velocities, r = settings_.ranks.velocities, open = nv - r;
  const double along = 2.0 * nv * open * (nv + open) + 2.0 / 3.0 * std::pow(open, 3),
               whole = 2.0 / 3.0 * std::pow(nv + r, 3);
  along_tangents_ = r > 0 && worthwhile * along < whole;
  for (MultibodyPoint* point : {&linearized_, &work_, &end_, &accepted_}) point->resize(sizes_);
  chosen_.q.resize(index(sizes_.positions));
  chosen_.v.resize(index(sizes_.velocities));
  form_.resize_tangents(end_tangents_);
  matrix_.resize(differential());
  for (auto* values : {&change_, &noise_, &noise_at_rest_, &inverse_weights_}) values->assign(size + 1, 0.0);
  noise_of_rates_.assign(d + 1, 0.0);
  residuals_.assign(index(sizes_.constraints()) + 1, 0.0);
}

PointStatus MultibodySystem::set_point(double t, const double* q, const double* v) {
  t_ = t;
  accepted_.set(t, q, v);
  callback_error_ = problem_.at_velocity(t, accepted_.q.data(), accepted_.v.data(), accepted_.terms);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  accepted_.measure_rows();
  partitions_ = 0;
  std::copy_n(q, sizes_.positions, change_.data());
  std::copy_n(v, sizes_.velocities, change_.data() + sizes_.positions);
  PointStatus status = linearize(t, change_.data());
  if (status != PointStatus::ok) return status;
  if (!(decided_ == settings_.ranks)) {
    changed_ranks_ = decided_;
    return PointStatus::changed;
  }
  end_ = accepted_;
  status = project(end_);
  if (status != PointStatus::ok) return status;
  end_orientation_ = orientation_ = orientation_of(end_tangents_);
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
  std::swap(accepted_, end_);
  orientation_ = end_orientation_;
  has_changed_ = false;
}

// a and mu at the point.
PointStatus MultibodySystem::evaluate(MultibodyPoint& point) {
  callback_error_ = problem_.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  ++counts_.factorizations;
  if (!point.factor(form_.velocities().rows, settings_.ranks.velocities)) return PointStatus::singular;
  point.solve_accelerations(form_.velocities().rows, settings_.ranks.velocities);
  return PointStatus::ok;
}

PointStatus MultibodySystem::accelerate(MultibodyPoint& point, Tangents& tangents) {
  // Below, C M^-1 C^T is too badly conditioned, as its condition is the square of that of C.
  constexpr double well_posed = 1e-2;
  ++counts_.factorizations;
  const Partition& partition = form_.velocities();
  Tangent& tangent = tangents.of_velocities();
  if (tangent.smallest_pivot() > well_posed && point.solve_by_masses(partition, tangent, arena_))
    return PointStatus::ok;
  if (along_tangents_) {
    if (!tangent.is_complete()) tangent.complete(partition, arena_);
    return point.solve_along(partition, tangent, arena_) ? PointStatus::ok : PointStatus::singular;
  }
  if (!point.factor(partition.rows, partition.rank)) return PointStatus::singular;
  point.solve_accelerations(partition.rows, partition.rank);
  return PointStatus::ok;
}

// g = 0 to rounding, along Q_q2. The tangent of the last linearization serves while it is good enough.
PointStatus MultibodySystem::project_positions(MultibodyPoint& point) {
  constexpr int most = 12;
  constexpr double negligible = 2.0 * unit_roundoff, small = 1e-11, slow = 1e-2, far_below_tolerance = 1e-3;
  if (settings_.ranks.positions == 0) return PointStatus::ok;
  const int nq = sizes_.positions;
  const Tangent* tangent = &form_.tangents().positions;
  double before = 0.0;
  int at_point = 0;  // iterations with N at the point itself
  for (int iteration = 0; iteration < most; ++iteration) {
    callback_error_ = problem_.constraints(point.t, point.q.data(), point.terms.g.data());
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    tangent->correction(form_.positions(), point.terms.g.data(), change_.data(), arena_);
    if (tangent != &form_.tangents().positions) ++at_point;
    double norm = 0.0, in_tolerances = 0.0;
    const double size = size_of(point.q);
    for (int k = 0; k < nq; ++k) {
      const double change = std::fabs(change_[index(k)]);
      norm = std::max(norm, change / std::max(std::fabs(point.q[index(k)]), 1e-2 * size));
      in_tolerances = std::max(in_tolerances, change * inverse_weights_[index(k)]);
      point.q[index(k)] += change_[index(k)];
    }
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    const double rate = iteration > 0 ? norm / std::max(before, negligible) : 1.0;
    if (norm <= negligible || rate * norm <= negligible) return PointStatus::ok;
    if (rate > 0.5 && iteration > 0 && norm <= small) return PointStatus::ok;
    // Rounding errors of g know lengths other than q, which may be zero.
    if (rate > 0.5 && at_point > 1 && in_tolerances <= far_below_tolerance) return PointStatus::ok;
    before = norm;
    if (rate < slow || iteration == 0) continue;
    // N at the point itself.
    callback_error_ = problem_.at_position(point.t, point.q.data(), point.terms);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
    point.measure_rows();
    if (!end_tangents_.positions.build(form_.positions(), point.position_rows(), arena_))
      return PointStatus::singular;
    tangent = &end_tangents_.positions;
  }
  return PointStatus::not_converged;
}

// Constraints on both levels hold to rounding, and a and mu are known, at a point near by.
PointStatus MultibodySystem::project(MultibodyPoint& point) {
  PointStatus status = project_positions(point);
  if (status != PointStatus::ok) return status;
  callback_error_ = problem_.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
  if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  point.measure_rows();
  if (!form_.build_tangents(point, end_tangents_, arena_)) return PointStatus::singular;
  // Linear in v: once is enough, but for what depends on v.
  constexpr double negligible = 1e-13;
  point.velocity_residuals(residuals_.data());
  end_tangents_.of_velocities().correction(form_.velocities(), residuals_.data(), change_.data(), arena_);
  for (int k = 0; k < sizes_.velocities; ++k) point.v[index(k)] += change_[index(k)];
  if (max_abs(change_.data(), sizes_.velocities) > negligible * largest(point.v)) {
    callback_error_ = problem_.at_velocity(point.t, point.q.data(), point.v.data(), point.terms);
    if (callback_error_.status != SFDAE_OK) return PointStatus::callback_error;
  }
  status = accelerate(point, end_tangents_);
  if (status != PointStatus::ok) return status;
  point.take_least_norm(form_.velocities(), arena_);
  kept_ = std::min(end_tangents_.positions.smallest_pivot(), end_tangents_.of_velocities().smallest_pivot());
  read_inconsistency(point);
  return PointStatus::ok;
}

// After a step: det C Q2 changes its sign where a configuration is singular, unless the constraints have turned too
// far from the partition for that to mean anything. Where two mechanisms are singular at once, the sign stays: what
// tells then is the way of all constraints from the point accepted last.
PointStatus MultibodySystem::check_ranks(const MultibodyPoint& point) {
  const bool has_rotated = end_tangents_.rotation() > largest_rotation();
  if (has_rotated) chord_.set_slow(true);
  end_orientation_ = orientation_of(end_tangents_);
  const Passage passage = passage_of_step();
  if (end_orientation_ == orientation_ && passage.positions.count + passage.velocities.count == 0)
    return PointStatus::ok;
  if (has_rotated && std::fabs(point.t - accepted_.t) > 1e-6 * std::fabs(accepted_.t) && !has_changed_) {
    is_linearized_ = false;
    return PointStatus::not_converged;
  }
  note_change(point, passage);
  return PointStatus::changed;
}

// From the point accepted last to the end of the step.
MultibodySystem::Passage MultibodySystem::passage_of_step() {
  Passage passage;
  passage.positions =
      end_tangents_.positions.passage_from(form_.positions(), accepted_.position_rows().matrix, arena_);
  passage.velocities = form_.tangents().same_rows
                           ? passage.positions
                           : end_tangents_.velocities.passage_from(form_.velocities(), accepted_.terms.C, arena_);
  return passage;
}

// Which constraint vanishes, in the units of its gradient, relative to the others, or altogether.
void MultibodySystem::note_change(const MultibodyPoint& point, const Passage& passage) {
  constexpr double independent = 0.1;
  has_changed_ = true;
  form_.judge(point, arena_, vanishing_row_, vanishing_value_);
  if (vanishing_value_ > independent) {
    vanishing_value_ = 0.0;
    if (passage.velocities.row >= 0) vanishing_row_ = passage.velocities.row;
  }
  changed_ranks_ = settings_.ranks;
  const auto lost = [](bool has_turned_over, int count) { return std::max(count, has_turned_over ? 1 : 0); };
  changed_ranks_.velocities -= lost(end_orientation_.velocities != orientation_.velocities, passage.velocities.count);
  changed_ranks_.positions -= lost(end_orientation_.positions != orientation_.positions, passage.positions.count);
}

std::string MultibodySystem::about_change() const {
  if (!has_changed_) return {};
  const bool is_holonomic = vanishing_row_ < sizes_.holonomic;
  const std::string gradient = format(" The configuration is singular: the gradient of %s constraint %d ",
                                      is_holonomic ? "holonomic" : "nonholonomic",
                                      is_holonomic ? vanishing_row_ : vanishing_row_ - sizes_.holonomic);
  if (vanishing_value_ == 0.0) return gradient + "vanishes.";
  return gradient + format("depends on those of the others, with singular value %.2g.", vanishing_value_);
}

// Constraints that follow from others hold with them, or there is no solution.
void MultibodySystem::read_inconsistency(const MultibodyPoint& point) {
  constexpr double rounding = 1e-11;
  inconsistency_ = 0.0;
  inconsistent_row_ = -1;
  const auto read = [&](const Partition& partition, const double* residuals, const double* units, double size) {
    for (std::size_t k = index(partition.rank); k < partition.rows.size(); ++k) {
      const std::size_t i = index(partition.rows[k]);
      const double relative = std::fabs(residuals[i]) / (size * (units[i] > 0.0 ? units[i] : 1.0));
      if (relative <= std::max(rounding, inconsistency_)) continue;
      inconsistency_ = relative;
      inconsistent_row_ = static_cast<int>(i);
    }
  };
  // What is a thousandth of the tolerances counts as little as 1e-8, the contradiction that is refused by default:
  // where values are near zero it may be nothing but rounding errors.
  constexpr double tolerances = 1e5;
  const auto size = [&](const std::vector<double>& values, const double* inverse_weights) {
    double floor = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) floor = std::max(floor, inverse_weights[k]);
    return std::max(size_of(values), floor > 0.0 ? tolerances / floor : 0.0);
  };
  read(form_.positions(), point.terms.g.data(), point.position_units.data(), size(point.q, inverse_weights_.data()));
  point.velocity_residuals(residuals_.data());
  read(form_.velocities(), residuals_.data(), point.velocity_units.data(),
       size(point.v, inverse_weights_.data() + sizes_.positions));
}

std::string MultibodySystem::inconsistency_message() const {
  const bool is_holonomic = inconsistent_row_ < sizes_.holonomic;
  return format(
      "constraints contradict each other at t = %.15g: the gradient of %s constraint %d depends on those of the "
      "others, but it is violated by %.3g (relative) where they hold. Correct the constraints, or set "
      "ignore_inconsistency.",
      t_, is_holonomic ? "holonomic" : "nonholonomic",
      is_holonomic ? inconsistent_row_ : inconsistent_row_ - sizes_.holonomic, inconsistency_);
}

double MultibodySystem::condition() const {
  const Partition& partition = form_.velocities();
  const int r = partition.rank, nv = sizes_.velocities;
  if (r == 0) return 1.0;
  Matrix C(r, nv);
  for (int k = 0; k < r; ++k) {
    const int i = partition.rows[index(k)];
    for (int j = 0; j < nv; ++j) C(k, j) = accepted_.terms.C(i, j) / accepted_.velocity_units[index(i)];
  }
  const double smallest = singular_values(product(C, partition.Q2())).back();
  return smallest > 0.0 ? singular_values(C).front() / smallest : std::numeric_limits<double>::infinity();
}

double MultibodySystem::position_residual() const {
  double worst = 0.0;
  for (int i = 0; i < sizes_.holonomic; ++i) {
    const double unit = accepted_.position_units[index(i)];
    worst = std::max(worst, std::fabs(accepted_.terms.g[index(i)]) / (unit > 0.0 ? unit : 1.0));
  }
  return worst;
}

double MultibodySystem::velocity_residual() const {
  std::vector<double> residuals(index(sizes_.constraints()) + 1);
  accepted_.velocity_residuals(residuals.data());
  double worst = 0.0;
  for (int i = 0; i < sizes_.constraints(); ++i) {
    const double unit = accepted_.velocity_units[index(i)];
    worst = std::max(worst, std::fabs(residuals[index(i)]) / (unit > 0.0 ? unit : 1.0));
  }
  return worst;
}

}  // namespace sfdae::core
