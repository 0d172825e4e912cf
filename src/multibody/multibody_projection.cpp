// Nearby points at which the constraints of a mechanical system hold on both levels.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_projection.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Scale for residuals.
double nonzero_size_of(const std::vector<double>& values) {
  const double size = max_abs(values);
  return size > 0.0 ? size : 1.0;
}

// Norms of a change of positions: relative to each component, at least to a hundredth of the largest one, and in units
// of the tolerance.
struct ChangeNorms {
  double relative = 0.0, in_tolerances = 0.0;
};

ChangeNorms add_change(const double* change, const double* inverse_weights, std::vector<double>& q) {
  ChangeNorms norms;
  const double size = nonzero_size_of(q);
  for (std::size_t k = 0; k < q.size(); ++k) {
    const double length = std::fabs(change[k]);
    norms.relative = std::max(norms.relative, length / std::max(std::fabs(q[k]), 1e-2 * size));
    norms.in_tolerances = std::max(norms.in_tolerances, length * inverse_weights[k]);
    q[k] += change[k];
  }
  return norms;
}

}  // namespace

void MultibodyProjection::resize(const MultibodySizes& sizes, const MultibodyForm& form) {
  form.resize_tangents(tangents_);
  inverse_weights_.assign(index(sizes.positions + sizes.velocities) + 1, 0.0);
}

void MultibodyProjection::set_weights(const double* inverse_weights) {
  std::copy_n(inverse_weights, inverse_weights_.size() - 1, inverse_weights_.data());
}

// The tangent of the linearization is used while it is good enough.
PointStatus MultibodyProjection::project_positions(MultibodyPoint& point, MultibodyEquations& equations,
                                                   const MultibodyForm& form, Arena& arena) {
  // Limit on iterations; relative changes within rounding errors, and those that are rounding errors once they do not
  // decrease; the rate from which on N is recomputed; negligible changes, in units of the tolerance. No figures were
  // recorded.
  constexpr int most = 12;
  constexpr double negligible = 2.0 * unit_roundoff, small = 1e-11, slow = 1e-2, far_below_tolerance = 1e-3;
  const Partition& partition = form.positions();
  if (partition.rank == 0) return PointStatus::ok;
  const Arena::Frame frame(arena);
  double* change = arena.take(point.q.size());
  const Tangent* tangent = &form.tangents().positions;
  double before = 0.0;
  int at_point = 0;  // iterations with N at the point itself
  for (int iteration = 0; iteration < most; ++iteration) {
    PointStatus status = equations.constraints(point);
    if (status != PointStatus::ok) return status;
    tangent->correction(partition, point.terms.g.data(), change, arena);
    if (tangent == &tangents_.positions) ++at_point;
    const auto [norm, in_tolerances] = add_change(change, inverse_weights_.data(), point.q);
    if (!std::isfinite(norm)) return PointStatus::not_converged;
    const double rate = iteration > 0 ? norm / std::max(before, negligible) : 1.0;
    if (norm <= negligible || rate * norm <= negligible) return PointStatus::ok;
    if (rate > 0.5 && iteration > 0 && norm <= small) return PointStatus::ok;
    // Rounding errors of g depend on other lengths than q, which may be zero.
    if (rate > 0.5 && at_point > 1 && in_tolerances <= far_below_tolerance) return PointStatus::ok;
    before = norm;
    if (rate < slow || iteration == 0) continue;
    // N at the point itself.
    status = equations.at_position(point);
    if (status != PointStatus::ok) return status;
    point.measure_rows();
    if (!tangents_.positions.build(partition, point.position_rows(), arena)) return PointStatus::singular;
    tangent = &tangents_.positions;
  }
  return PointStatus::not_converged;
}

// Constraints are linear in v: one change is enough. Then terms that depend on v are evaluated again unless the change
// is a rounding error.
PointStatus MultibodyProjection::project_velocities(MultibodyPoint& point, MultibodyEquations& equations,
                                                    const MultibodyForm& form, Arena& arena, bool has_approached) {
  // Relative to v: some hundred rounding errors. No figures were recorded.
  constexpr double negligible = 1e-13;
  const int nv = static_cast<int>(point.v.size());
  const Arena::Frame frame(arena);
  double* residuals = arena.take(point.velocity_units.size());
  double* change = arena.take(point.v.size());
  point.velocity_residuals(residuals);
  // If directions depend on each other, changes by rounding errors are not so small.
  if (has_approached && velocities_hold_to_rounding(point, residuals, nullptr)) return PointStatus::ok;
  tangents_.of_velocities().correction(form.velocities(), residuals, change, arena);
  for (int k = 0; k < nv; ++k) point.v[index(k)] += change[k];
  if (max_abs(change, nv) > negligible * max_abs(point.v)) return equations.at_velocity(point);
  return PointStatus::ok;
}

PointStatus MultibodyProjection::project(MultibodyPoint& point, MultibodyEquations& equations,
                                         const MultibodyForm& form, Arena& arena, Moves moves) {
  PointStatus status = PointStatus::ok;
  if (moves == Moves::all) {
    status = project_positions(point, equations, form, arena);
    if (status == PointStatus::ok) status = equations.at_velocity(point);
    if (status != PointStatus::ok) return status;
    point.measure_rows();
  }
  return build_tangents(point, form, arena) ? finish(point, equations, form, arena, moves) : PointStatus::singular;
}

PointStatus MultibodyProjection::project_output(MultibodyPoint& point, MultibodyEquations& equations,
                                                const MultibodyForm& form, Arena& arena) {
  const std::size_t nq = point.q.size(), nv = point.v.size();
  {
    const Arena::Frame frame(arena);
    double* const given = arena.take(nq + nv);
    std::copy_n(point.v.data(), nv, std::copy_n(point.q.data(), nq, given));
    if (!approach(point, equations, form, arena)) {
      std::copy_n(given, nq, point.q.data());
      std::copy_n(given + nq, nv, point.v.data());
      return project(point, equations, form, arena);
    }
  }
  // Rows have practically the same lengths as at the given point.
  const PointStatus status = equations.at_velocity(point);
  if (status != PointStatus::ok) return status;
  return form.fit_tangents(point, tangents_, Tangent::Uses::few) ? finish(point, equations, form, arena, Moves::rest)
                                                                 : PointStatus::singular;
}

// Newton's method with N of the given point: positions to machine precision, velocities so near that one more change
// alters forces by a rounding error as a rule. False: not possible here, or too slow.
bool MultibodyProjection::approach(MultibodyPoint& point, MultibodyEquations& equations, const MultibodyForm& form,
                                   Arena& arena) {
  // Limit on iterations; relative changes as in project_positions; changes of velocities that project_velocities need
  // not check again; a rate that Newton's method has only because of rounding errors. (Chosen: iterations by the number
  // needed.)
  constexpr int most = 5;
  constexpr double negligible = 2.0 * unit_roundoff, small = 1e-11, negligible_in_v = 2e-14, slow = 1e-2;
  if (!form.has_velocities_as_rates() || form.positions().rank == 0) return false;
  const Arena::Frame frame(arena);
  const std::size_t nq = point.q.size(), nl = point.terms.g.size();
  double* const residuals = arena.take(2 * nl);
  double* const change = arena.take(2 * nq);
  double before = 0.0, before_in_v = 0.0;
  bool has_positions = false;
  for (int iteration = 0; iteration < most; ++iteration) {
    const std::optional<PointStatus> status = equations.both_levels(point, iteration == 0, residuals);
    if (status != PointStatus::ok) return false;
    if (iteration == 0) {
      point.measure_rows();
      if (!form.fit_tangents(point, tangents_, Tangent::Uses::few)) return false;
    }
    if (has_positions) tangents_.positions.correction(form.velocities(), residuals + nl, change + nq, arena);
    else form.particular(tangents_, {residuals, residuals + nl}, change, arena);
    const double norm = has_positions ? 0.0 : add_change(change, inverse_weights_.data(), point.q).relative;
    for (std::size_t k = 0; k < nq; ++k) point.v[k] += change[nq + k];
    const double norm_in_v = max_abs(change + nq, static_cast<int>(nq)) / nonzero_size_of(point.v);
    if (!std::isfinite(norm) || !std::isfinite(norm_in_v)) return false;
    const double rate = iteration > 0 ? norm / std::max(before, negligible) : 1.0,
                 rate_in_v = iteration > 0 ? norm_in_v / std::max(before_in_v, negligible_in_v) : 1.0;
    has_positions = norm <= negligible || rate * norm <= negligible || (iteration > 0 && rate > 0.5 && norm <= small);
    // Rounding errors depend on other lengths than v, which may be zero: at most one more iteration.
    if (has_positions && (iteration > 1 || rate_in_v * norm_in_v <= negligible_in_v)) return true;
    if (!has_positions && iteration > 0 && rate > slow && norm > small) return false;
    before = norm;
    before_in_v = norm_in_v;
  }
  return false;
}

PointStatus MultibodyProjection::finish(MultibodyPoint& point, MultibodyEquations& equations,
                                        const MultibodyForm& form, Arena& arena, Moves moves) {
  PointStatus status = PointStatus::ok;
  if (moves != Moves::nothing) status = project_velocities(point, equations, form, arena, moves == Moves::rest);
  if (status != PointStatus::ok) return status;
  status = equations.accelerations(point, form.velocities(), tangents_.of_velocities(), arena);
  if (status != PointStatus::ok) return status;
  point.take_least_norm(form.velocities(), arena);
  smallest_pivot_ = std::min(tangents_.positions.smallest_pivot(), tangents_.of_velocities().smallest_pivot());
  measure_inconsistency(point, form, arena);
  return PointStatus::ok;
}

// Constraints that follow from others hold with them, or there is no solution.
void MultibodyProjection::measure_inconsistency(const MultibodyPoint& point, const MultibodyForm& form,
                                                Arena& arena) {
  inconsistency_ = 0.0;
  inconsistent_row_ = -1;
  const auto has_dependent_rows = [](const Partition& partition) {
    return index(partition.rank) < partition.rows.size();
  };
  if (!has_dependent_rows(form.positions()) && !has_dependent_rows(form.velocities())) return;
  // A thousandth of the tolerances counts as little as 1e-8, the contradiction that is refused by default: near zero
  // values it may be a rounding error.
  constexpr double tolerances = 1e5;
  const auto size = [&](const std::vector<double>& values, const double* inverse_weights) {
    double floor = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) floor = std::max(floor, inverse_weights[k]);
    return std::max(nonzero_size_of(values), floor > 0.0 ? tolerances / floor : 0.0);
  };
  const double* inverse_weights = inverse_weights_.data();
  compare(form.positions(), point.terms.g.data(), point.position_units.data(), size(point.q, inverse_weights));
  const Arena::Frame frame(arena);
  double* residuals = arena.take(point.velocity_units.size());
  point.velocity_residuals(residuals);
  compare(form.velocities(), residuals, point.velocity_units.data(), size(point.v, inverse_weights + point.q.size()));
}

// Residuals of the dependent constraints, in units of their gradients, with the size of the unknowns.
void MultibodyProjection::compare(const Partition& partition, const double* residuals, const double* units,
                                  double size) {
  // Largest residuals by rounding errors; no figures were recorded.
  constexpr double rounding = 1e-11;
  for (std::size_t k = index(partition.rank); k < partition.rows.size(); ++k) {
    const std::size_t i = index(partition.rows[k]);
    const double relative = std::fabs(residuals[i]) / (size * (units[i] > 0.0 ? units[i] : 1.0));
    if (relative <= std::max(rounding, inconsistency_)) continue;
    inconsistency_ = relative;
    inconsistent_row_ = static_cast<int>(i);
  }
}

std::string MultibodyProjection::inconsistency_message(const MultibodyProblem& problem, double t) const {
  return format(
      "constraints contradict each other at t = %.15g: the gradient of %s depends on those of the others, but it is "
      "violated by %.3g (relative) where they hold. Correct the constraints, or set ignore_inconsistency.",
      t, problem.name_of_constraint(inconsistent_row_).c_str(), inconsistency_);
}

}  // namespace sfdae::core
