// Consistent positions and velocities of a mechanical system with constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_consistency.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "multibody/multibody_rank_decisions.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

double length(const Vector& values) {
  double sum = 0.0;
  for (double value : values) sum += value * value;
  return std::sqrt(sum);
}

double size_of(const Vector& values) {
  const double size = max_abs(values.data(), static_cast<int>(values.size()));
  return size > 0.0 ? size : 1.0;
}

void demand(const CallbackError& error) {
  if (error.status != SFDAE_OK) error.raise();
}

// But for rounding errors of its formulas; 1e-12 leaves room for thousands of them. (Chosen.)
bool is_symmetric(const Matrix& A) {
  const double small = 1e-12 * max_abs(A);
  for (int j = 0; j < A.cols(); ++j)
    for (int i = 0; i < j; ++i)
      if (std::fabs(A(i, j) - A(j, i)) > small) return false;
  return true;
}

// R with A = R^T R; false if A is not positive definite by a margin, in which rounding errors have room.
bool factor_cholesky(Matrix& A) {
  constexpr double margin = 1e-12;
  const int n = A.rows();
  for (int j = 0; j < n; ++j) {
    const double diagonal = A(j, j);
    for (int i = 0; i <= j; ++i) {
      double sum = A(i, j);
      for (int k = 0; k < i; ++k) sum -= A(k, i) * A(k, j);
      if (i < j) A(i, j) = sum / A(i, i);
      else if (!(sum > margin * diagonal)) return false;
      else A(j, j) = std::sqrt(sum);
    }
  }
  return true;
}

// x of smallest norm with A x = b, but for singular values: damped by lambda, dropped below the threshold.
Vector damped_solution(const Svd& A, const Vector& b, double lambda, double threshold) {
  Vector x(index(A.V.rows()), 0.0);
  for (int k = 0; k < static_cast<int>(A.s.size()); ++k) {
    const double s = A.s[index(k)];
    if (s <= threshold) break;
    double along = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) along += A.U(static_cast<int>(i), k) * b[i];
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += A.V(static_cast<int>(i), k) * along * s / (s * s + lambda);
  }
  return x;
}

}  // namespace

MultibodyConsistency::MultibodyConsistency(MultibodyProblem& problem, double t, const ConsistencyRequest& request,
                                           bool tolerant)
    : problem_(problem),
      sizes_(problem.sizes()),
      t_(t),
      request_(request),
      scaled_g_(index(sizes_.holonomic)),
      tolerant_(tolerant) {
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

std::string MultibodyConsistency::name_of(int constraint) const {
  const bool is_holonomic = constraint < sizes_.holonomic;
  return format("%s constraint %d", is_holonomic ? "holonomic" : "nonholonomic",
                is_holonomic ? constraint : constraint - sizes_.holonomic);
}

// P: changes of the components that are not fixed, P^T W P = I.
Matrix MultibodyConsistency::metric(int first, int count, bool by_mass) const {
  std::vector<int> open;
  for (int i = 0; i < count; ++i)
    if (request_.kind != InitialValues::fixed || request_.fixed[index(first + i)] == 0) open.push_back(i);
  const int size = static_cast<int>(open.size());
  Matrix P(count, size);
  Matrix R(size, size);
  if (request_.weights.empty() && by_mass) {
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) R(i, j) = point_.terms.M(open[index(i)], open[index(j)]);
    if (is_symmetric(R) && factor_cholesky(R)) {
      Matrix inverse = identity(size);
      solve_upper(Op::plain, R, inverse);
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) P(open[index(i)], j) = inverse(i, j);
      return P;
    }
  }
  for (int i = 0; i < size; ++i)
    P(open[index(i)], i) = request_.weights.empty() ? 1.0 : request_.weights[index(first + open[index(i)])];
  return P;
}

Matrix MultibodyConsistency::scaled_rows(const ConstraintRows& rows) const {
  Matrix scaled = to_matrix(rows.matrix);
  for (int i = 0; i < scaled.rows(); ++i)
    for (int j = 0; j < scaled.cols() && rows.units[i] > 0.0; ++j) scaled(i, j) /= rows.units[i];
  return scaled;
}

// |g|, rows in units of their gradients at the point looked at last.
double MultibodyConsistency::residual(const Vector& q) {
  demand(problem_.constraints(t_, q.data(), scaled_g_.data()));
  for (std::size_t i = 0; i < scaled_g_.size(); ++i)
    if (point_.position_units[i] > 0.0) scaled_g_[i] /= point_.position_units[i];
  return all_finite(scaled_g_.data(), scaled_g_.size()) ? length(scaled_g_) : 1e300;
}

// One damped step, shortened until it helps. False if none does.
bool MultibodyConsistency::improve(Vector& q, double& norm) {
  // The shortest step is 1 / 4096 of the first; lambda is at most a tenth of the largest singular value squared; what
  // decreases the residual by less of it is no progress. No figures were recorded.
  constexpr int halvings = 12;
  constexpr double strongest = 0.1, least_gain = 1e-6;
  evaluate_at(q);
  norm = residual(q);
  const Svd J = svd(product(scaled_rows(point_.position_rows()), directions_));
  if (J.s.empty() || J.s.front() == 0.0) return false;
  const double lambda = std::pow(J.s.front(), 2) * std::min(strongest, norm / size_of(q));
  // Singular values that small are rounding errors of J.
  Vector p = damped_solution(J, scaled_g_, lambda, 1e-14 * J.s.front());
  Vector dq(q.size());
  multiply(-1.0, Op::plain, directions_, p.data(), 0.0, dq.data());
  double part = 1.0;
  for (int k = 0; k < halvings; ++k, part *= 0.5) {
    Vector trial(q);
    for (std::size_t i = 0; i < q.size(); ++i) trial[i] += part * dq[i];
    const double after = residual(trial);
    if (!(after < (1.0 - least_gain * part) * norm)) continue;
    q = trial;
    norm = after;
    return true;
  }
  return false;
}

// The smallest one; 0 if there is none.
double MultibodyConsistency::position_tolerance() const {
  const auto& all = request_.tolerances;
  return all.empty() ? 0.0 : *std::min_element(all.begin(), all.begin() + sizes_.positions);
}

void MultibodyConsistency::approach(Vector& q) {
  // Iterations; the residual that ends them, and the one that rounding errors may leave, relative to q, or a
  // millionth of the tolerances.
  constexpr int most = 100;
  constexpr double rounding = 1e-12, negligible = 4.0 * unit_roundoff, far_below_tolerance = 1e-6;
  double norm = 0.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    const bool is_better = improve(q, norm);
    if (norm <= negligible * size_of(q)) return;
    if (is_better) continue;
    break;
  }
  // Rounding errors of g know lengths other than q, which may be zero.
  if (norm <= std::max(rounding * size_of(q), far_below_tolerance * position_tolerance())) return;
  refuse_positions(q, norm);
}

// Where no direction makes residuals smaller, constraints contradict each other, or fixed values contradict them.
void MultibodyConsistency::refuse_positions(const Vector& q, double norm) {
  // The part of the residual that directions at hand can remove, to first order.
  constexpr double stationary = 1e-2;
  evaluate_at(q);
  residual(q);
  const Matrix J = product(scaled_rows(point_.position_rows()), directions_);
  Vector slope(index(J.cols()) + 1, 0.0);
  multiply(1.0, Op::transposed, J, scaled_g_.data(), 0.0, slope.data());
  const auto worst = std::max_element(scaled_g_.begin(), scaled_g_.end(),
                                      [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  const int row = static_cast<int>(worst - scaled_g_.begin());
  const bool is_stationary = length(slope) <= stationary * norm * std::max(max_abs(J), 1e-300);
  if (is_stationary && has_fixed(0, sizes_.positions))
    throw Failure(SFDAE_FIXED_VALUES,
                  format("the fixed positions contradict the constraints at t = %.15g: %s is violated by "
                         "%.3g (in units of its gradient). Fix fewer components, or correct their values.",
                         t_, name_of(row).c_str(), std::fabs(*worst)));
  if (is_stationary && tolerant_) {
    has_contradiction_ = true;
    return;
  }
  if (is_stationary)
    throw Failure(
        SFDAE_INCONSISTENT_EQUATIONS,
        format("the constraints contradict each other at t = %.15g: where they are violated least, %s is still "
               "violated by %.3g (in units of its gradient), and its gradient depends on those of the others.",
               t_, name_of(row).c_str(), std::fabs(*worst)));
  std::string list;
  for (int i = 0; i < sizes_.holonomic && i < 10; ++i)
    list += format("%s%.2g", i > 0 ? ", " : "", scaled_g_[index(i)]);
  throw Failure(
      SFDAE_NO_CONSISTENT_VALUES,
      format("no positions consistent with the constraints were found at t = %.15g near those given; residuals in "
             "units of the gradients: %s.",
             t_, list.c_str()));
}

// Along the constraints toward what was given; linear convergence where it is far away, and it need not be exact.
void MultibodyConsistency::minimize_change(const Vector& given, Vector& q) {
  // Iterations; the step that is short enough; singular values, relative, of constraints that count as dependent
  // here, where directions, not ranks, are wanted: far above rounding errors of the Jacobian at a point that is not
  // exact.
  constexpr int most = 30;
  constexpr double accuracy = 1e-8, dependent = 1e-7;
  if (directions_.cols() == 0) return;
  const Svd metric = svd(directions_);
  const auto distance = [&](const Vector& at) {
    Vector difference(given);
    for (std::size_t i = 0; i < at.size(); ++i) difference[i] -= at[i];
    return difference;
  };
  const auto in_metric = [&](const Vector& dq) { return damped_solution(metric, dq, 0.0, 0.0); };
  double last_step = 0.0;
  for (int iteration = 0; iteration < most; ++iteration) {
    evaluate_at(q);
    residual(q);
    const Matrix J = product(scaled_rows(point_.position_rows()), directions_);
    const Svd decomposition = svd(J);
    Vector p = in_metric(distance(q));
    const double before = length(p);
    Vector rest(scaled_g_);
    multiply(1.0, Op::plain, J, p.data(), 1.0, rest.data());
    const Vector normal = damped_solution(decomposition, rest, 0.0, dependent * decomposition.s.front());
    for (std::size_t i = 0; i < p.size(); ++i) p[i] -= normal[i];
    Vector trial(q);
    multiply(1.0, Op::plain, directions_, p.data(), 1.0, trial.data());
    const double step = length(p);
    if (!(step > accuracy * std::max(before, accuracy * size_of(q))) || (iteration > 0 && step > 0.9 * last_step))
      return;
    last_step = step;
    try {
      approach(trial);
    } catch (const Failure& failure) {
      if (failure.status() == SFDAE_CALLBACK_STOPPED || failure.status() == SFDAE_STOPPED) throw;
      return;
    }
    // Distances say little near the nearest point.
    if (length(in_metric(distance(trial))) > 1.01 * before) return;
    q = trial;
  }
}

Vector MultibodyConsistency::positions(const double* given) {
  const Vector start(given, given + sizes_.positions);
  Vector q(start);
  if (sizes_.holonomic == 0) return q;
  evaluate_at(q);
  directions_ = metric(0, sizes_.positions, point_.terms.S.rows() == 0);
  approach(q);
  minimize_change(start, q);
  return q;
}

MultibodyRanks MultibodyConsistency::ranks(const Vector& q, double rank_tol, std::vector<RankDecision>& decisions) {
  rank_tol_ = rank_tol;
  evaluate_at(q);
  const MultibodyRanks ranks = ranks_of_constraints(point_, rank_tol, &decisions, arena_);
  rank_of_mass_ = check_acceleration_matrix(point_, ranks.velocities, decisions, arena_);
  if (sizes_.holonomic > 0) check_nearby(q, ranks);
  return ranks;
}

// Constraints that depend on each other at the point alone, or gradients that vanish where their constraints hold,
// make it a singular configuration.
void MultibodyConsistency::check_nearby(const Vector& q, const MultibodyRanks& known) {
  // To the neighbour, relative to q; a gradient so much smaller than there counts as zero. No figures were recorded.
  constexpr double distance = 1e-3, vanishing = 1e-6;
  const Vector units = point_.position_units;
  const double largest = max_abs(q.data(), sizes_.positions),
               size = largest > 0.0 ? std::max(largest, position_tolerance()) : 1.0;
  Vector beside(q);
  // No direction in particular, and the same in every run.
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
                   t_, name_of(i).c_str()));
    approach(beside);
    evaluate_at(beside);
    found = ranks_of_constraints(point_, rank_tol_, nullptr, arena_);
  } catch (const Failure& failure) {
    // A neighbour that cannot be reached says nothing.
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

Vector MultibodyConsistency::velocities(const Vector& q, const double* given, int rank) {
  // Relative to velocities; rounding errors are smaller by orders of magnitude.
  constexpr double contradiction = 1e-9;
  const int nv = sizes_.velocities, nc = sizes_.constraints();
  Vector v(given, given + nv);
  if (nc == 0) return v;
  evaluate_at(q);
  point_.v = v;
  const Matrix P = metric(sizes_.positions, nv, true);
  const Svd C = svd(product(scaled_rows(point_.velocity_rows()), P));
  Vector residuals(index(nc));
  const auto read = [&] {
    point_.velocity_residuals(residuals.data());
    for (int i = 0; i < nc; ++i)
      if (point_.velocity_units[index(i)] > 0.0) residuals[index(i)] /= point_.velocity_units[index(i)];
  };
  // Twice, for rounding errors of the first time.
  for (int pass = 0; pass < 2; ++pass) {
    read();
    // Of known rank: a tenth of the smallest value that counts, and never less than rounding errors of C.
    const double least = rank > 0 && rank <= static_cast<int>(C.s.size()) ? 0.1 * C.s[index(rank - 1)] : 0.0;
    const Vector p = damped_solution(C, residuals, 0.0, std::max(least, C.s.empty() ? 0.0 : 1e-13 * C.s.front()));
    multiply(-1.0, Op::plain, P, p.data(), 1.0, point_.v.data());
  }
  read();
  const auto worst = std::max_element(residuals.begin(), residuals.end(),
                                      [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  // Those given count, too: where nothing can move, v is rounding errors of them.
  double size = std::max(size_of(point_.v), size_of(Vector(given, given + nv)));
  for (int i = 0; i < nc; ++i)
    if (point_.velocity_units[index(i)] > 0.0)
      size = std::max(size, std::fabs(point_.terms.velocity_rest[index(i)]) / point_.velocity_units[index(i)]);
  if (std::fabs(*worst) <= contradiction * size) return point_.v;
  const std::string name = name_of(static_cast<int>(worst - residuals.begin()));
  if (has_fixed(sizes_.positions, nv))
    throw Failure(SFDAE_FIXED_VALUES,
                  format("the fixed velocities contradict the constraints at t = %.15g: %s is violated by "
                         "%.3g. Fix fewer components, or correct their values.",
                         t_, name.c_str(), std::fabs(*worst)));
  if (tolerant_) {
    has_contradiction_ = true;
    return point_.v;
  }
  throw Failure(
      SFDAE_INCONSISTENT_EQUATIONS,
      format("the constraints on velocities contradict each other at t = %.15g: %s is violated by %.3g in any case.",
             t_, name.c_str(), std::fabs(*worst)));
}

}  // namespace sfdae::core
