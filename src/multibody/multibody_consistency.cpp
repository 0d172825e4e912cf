// Consistent positions and velocities of a mechanical system with constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_consistency.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_metric.h"
#include "multibody/multibody_nearest_positions.h"
#include "multibody/multibody_rank_decisions.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Limit for a search for positions. (Chosen.)
constexpr int most_iterations = 200;

double size_of(const Vector& values) {
  const double size = max_abs(values.data(), static_cast<int>(values.size()));
  return size > 0.0 ? size : 1.0;
}

void demand(const CallbackError& error) {
  if (error.status != SFDAE_OK) error.raise();
}

// x of smallest norm with A x = b, but for singular values below the threshold.
Vector least_norm_solution(const Svd& A, const Vector& b, double threshold) {
  Vector x(index(A.V.rows()), 0.0);
  for (int k = 0; k < static_cast<int>(A.s.size()) && A.s[index(k)] > threshold; ++k) {
    double along = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) along += A.U(static_cast<int>(i), k) * b[i];
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += A.V(static_cast<int>(i), k) * along / A.s[index(k)];
  }
  return x;
}

}  // namespace

MultibodyConsistency::MultibodyConsistency(MultibodyProblem& problem, double t, const ConsistencyRequest& request,
                                           bool tolerant)
    : problem_(problem), sizes_(problem.sizes()), t_(t), request_(request), tolerant_(tolerant) {
  point_.resize(sizes_);
  point_.t = t;
}

void MultibodyConsistency::evaluate_at(const Vector& q) {
  point_.q = q;
  demand(problem_.at_position(t_, q.data(), point_.terms));
  point_.measure_rows();
}

bool MultibodyConsistency::has_fixed(int first, int count) const {
  return !request_.fixed.empty() &&
         std::any_of(request_.fixed.begin() + first, request_.fixed.begin() + first + count,
                     [](char flag) { return flag != 0; });
}

// The smallest tolerance; 0 if there is none.
double MultibodyConsistency::position_tolerance() const {
  const auto& all = request_.tolerances;
  return all.empty() ? 0.0 : *std::min_element(all.begin(), all.begin() + sizes_.positions);
}

PositionSearch MultibodyConsistency::search_at(const Vector& q) {
  PositionSearch search(problem_, t_, position_tolerance());
  search.move_to(q);
  return search;
}

Vector MultibodyConsistency::positions(const double* given) {
  const Vector start(given, given + sizes_.positions);
  if (sizes_.holonomic == 0) return start;
  PositionSearch search = search_at(start);
  if (search.holds_to_rounding()) return start;
  const PositionMetric metric = position_metric(search.point().terms, request_);
  // Far from the constraints, directions along single components are the most efficient.
  bool is_found = search.approach(metric.open, most_iterations);
  if (!is_found) {
    PositionSearch other = search_at(start);
    is_found = other.approach(metric.P, most_iterations);
    if (is_found) search.move_to(other.q());
  }
  if (is_found) NearestPositions(problem_, start, metric, search).approach();
  else refuse_positions(search, metric.open);
  return search.q();
}

// If no direction reduces residuals, constraints contradict each other, or fixed values contradict them.
void MultibodyConsistency::refuse_positions(const PositionSearch& search, const Matrix& open) {
  const Vector residuals = search.residuals();
  const auto worst = std::max_element(residuals.begin(), residuals.end(),
                                      [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  const std::string name = problem_.name_of_constraint(static_cast<int>(worst - residuals.begin()));
  const bool is_stationary = search.is_stationary(open);
  if (is_stationary && has_fixed(0, sizes_.positions))
    throw Failure(SFDAE_FIXED_VALUES,
                  format("the fixed positions contradict the constraints at t = %.15g: %s is violated by "
                         "%.3g (in units of its gradient). Fix fewer components, or correct their values.",
                         t_, name.c_str(), std::fabs(*worst)));
  if (is_stationary && tolerant_) {
    has_contradiction_ = true;
    return;
  }
  if (is_stationary)
    throw Failure(
        SFDAE_INCONSISTENT_EQUATIONS,
        format("the constraints contradict each other at t = %.15g: where they are violated least, %s is still "
               "violated by %.3g (in units of its gradient), and its gradient depends on those of the others.",
               t_, name.c_str(), std::fabs(*worst)));
  std::string list;
  for (int i = 0; i < sizes_.holonomic && i < 10; ++i)
    list += format("%s%.2g", i > 0 ? ", " : "", residuals[index(i)]);
  throw Failure(
      SFDAE_NO_CONSISTENT_VALUES,
      format("no positions consistent with the constraints were found at t = %.15g near those given; residuals in "
             "units of the gradients: %s.",
             t_, list.c_str()));
}

MultibodyRanks MultibodyConsistency::ranks(const Vector& q, double rank_tol, std::vector<RankDecision>& decisions) {
  rank_tol_ = rank_tol;
  evaluate_at(q);
  const MultibodyRanks ranks = ranks_of_constraints(point_, rank_tol, &decisions, arena_);
  rank_of_mass_ = check_acceleration_matrix(point_, ranks.velocities, decisions, arena_);
  if (sizes_.holonomic > 0) check_nearby(q, ranks);
  return ranks;
}

// Constraints that depend on each other at this point alone, or gradients that vanish where their constraints hold,
// indicate a singular configuration.
void MultibodyConsistency::check_nearby(const Vector& q, const MultibodyRanks& known) {
  // Distance of the neighboring point, relative to q; relative size of a gradient that counts as zero. No figures were
  // recorded.
  constexpr double distance = 1e-3, vanishing = 1e-6;
  const Vector units = point_.position_units;
  const double largest = max_abs(q.data(), sizes_.positions),
               size = largest > 0.0 ? std::max(largest, position_tolerance()) : 1.0;
  Vector beside(q);
  // An arbitrary direction, the same in every run.
  for (std::size_t i = 0; i < q.size(); ++i)
    beside[i] += distance * size * std::sin(1.0 + 2.3 * static_cast<double>(i));
  MultibodyRanks found;
  try {
    evaluate_at(beside);
    for (int i = 0; i < sizes_.holonomic; ++i)
      if (units[index(i)] < vanishing * point_.position_units[index(i)])
        throw Failure(
            SFDAE_CHARACTERISTICS_CHANGED,
            format("the configuration at t = %.15g is singular: the gradient of %s vanishes. Start elsewhere, or "
                   "write the constraint so that its gradient does not vanish where it holds.",
                   t_, problem_.name_of_constraint(i).c_str()));
    PositionSearch search = search_at(beside);
    if (!search.approach(position_metric(search.point().terms, request_).open, most_iterations)) return;
    evaluate_at(search.q());
    found = ranks_of_constraints(point_, rank_tol_, nullptr, arena_);
  } catch (const Failure& failure) {
    // A neighbor that cannot be reached is ignored.
    const int status = failure.status();
    if (status == SFDAE_CHARACTERISTICS_CHANGED || status == SFDAE_CALLBACK_STOPPED || status == SFDAE_STOPPED) throw;
    return;
  }
  if (found.positions <= known.positions && found.velocities <= known.velocities) return;
  throw Failure(
      SFDAE_CHARACTERISTICS_CHANGED,
      format("the configuration at t = %.15g is singular: %d of %d constraints are independent there, but %d "
             "beside it. Start elsewhere.",
             t_, known.velocities, sizes_.constraints(), found.velocities));
}

Vector MultibodyConsistency::scaled_velocity_residuals() const {
  Vector residuals(index(sizes_.constraints()) + 1);
  point_.velocity_residuals(residuals.data());
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (point_.velocity_units[i] > 0.0) residuals[i] /= point_.velocity_units[i];
  residuals.pop_back();
  return residuals;
}

Vector MultibodyConsistency::velocities(const Vector& q, const double* given, int rank) {
  const int nv = sizes_.velocities;
  Vector v(given, given + nv);
  if (sizes_.constraints() == 0) return v;
  evaluate_at(q);
  point_.v = v;
  if (velocities_hold_to_rounding(point_)) return v;
  const Matrix P = velocity_metric(point_.terms, request_).P;
  Matrix rows = to_matrix(point_.terms.C);
  for (int i = 0; i < rows.rows(); ++i)
    for (int j = 0; j < nv && point_.velocity_units[index(i)] > 0.0; ++j)
      rows(i, j) /= point_.velocity_units[index(i)];
  const Svd C = svd(product(rows, P));
  // Threshold for the known rank: a tenth of the smallest relevant singular value, and never less than rounding errors
  // of C.
  const double least = rank > 0 && rank <= static_cast<int>(C.s.size()) ? 0.1 * C.s[index(rank - 1)] : 0.0,
               threshold = std::max(least, C.s.empty() ? 0.0 : 1e-13 * C.s.front());
  // The second pass removes rounding errors of the first.
  for (int pass = 0; pass < 2; ++pass) {
    const Vector y = least_norm_solution(C, scaled_velocity_residuals(), threshold);
    multiply(-1.0, Op::plain, P, y.data(), 1.0, point_.v.data());
  }
  refuse_velocities(scaled_velocity_residuals(), given);
  return point_.v;
}

void MultibodyConsistency::refuse_velocities(const Vector& residuals, const double* given) {
  // Relative to velocities; rounding errors are smaller by orders of magnitude.
  constexpr double contradiction = 1e-9;
  const int nv = sizes_.velocities;
  const auto worst = std::max_element(residuals.begin(), residuals.end(),
                                      [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  // The given velocities count, too: if nothing can move, v consists of their rounding errors.
  double size = std::max(size_of(point_.v), size_of(Vector(given, given + nv)));
  for (int i = 0; i < sizes_.constraints(); ++i)
    if (point_.velocity_units[index(i)] > 0.0)
      size = std::max(size, std::fabs(point_.terms.velocity_rest[index(i)]) / point_.velocity_units[index(i)]);
  if (std::fabs(*worst) <= contradiction * size) return;
  const std::string name = problem_.name_of_constraint(static_cast<int>(worst - residuals.begin()));
  if (has_fixed(sizes_.positions, nv))
    throw Failure(SFDAE_FIXED_VALUES,
                  format("the fixed velocities contradict the constraints at t = %.15g: %s is violated by "
                         "%.3g. Fix fewer components, or correct their values.",
                         t_, name.c_str(), std::fabs(*worst)));
  has_contradiction_ = true;
  if (tolerant_) return;
  throw Failure(
      SFDAE_INCONSISTENT_EQUATIONS,
      format("the constraints on velocities contradict each other at t = %.15g: %s is violated by %.3g in any case.",
             t_, name.c_str(), std::fabs(*worst)));
}

}  // namespace sfdae::core
