// Positions near given ones that fulfil the constraints.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_position_search.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

double length(const Vector& a) {
  double sum = 0.0;
  for (const double value : a) sum += value * value;
  return std::sqrt(sum);
}

// Rounding errors of singular values, relative to the largest one.
constexpr double singular_value_roundoff = 1e-14;

// A step for residuals c, damped by lambda, and the reduction of |c|^2 to first order if a fraction of it is taken.
struct DampedStep {
  DampedStep(const Svd& A, int rank, const Vector& c, double lambda, double part) : step(index(A.V.rows()), 0.0) {
    for (int k = 0; k < rank; ++k) {
      const double s = A.s[index(k)], share = part * s * s / (s * s + lambda);
      double along = 0.0;
      for (std::size_t i = 0; i < c.size(); ++i) along += A.U(static_cast<int>(i), k) * c[i];
      for (std::size_t i = 0; i < step.size(); ++i) step[i] -= A.V(static_cast<int>(i), k) * along * share / s;
      expected += along * along * share * (2.0 - share);
    }
  }
  Vector step;
  double expected = 0.0;
};

}  // namespace

Vector scale_rows(Matrix& A) {
  Vector lengths(index(A.rows()), 0.0);
  for (int i = 0; i < A.rows(); ++i) {
    // Squares of units near overflow would overflow.
    double greatest = 0.0, squares = 0.0;
    for (int j = 0; j < A.cols(); ++j) greatest = std::max(greatest, std::fabs(A(i, j)));
    if (greatest == 0.0) continue;
    for (int j = 0; j < A.cols(); ++j) squares += (A(i, j) / greatest) * (A(i, j) / greatest);
    const double root = std::sqrt(squares);
    for (int j = 0; j < A.cols(); ++j) A(i, j) = A(i, j) / greatest / root;
    lengths[index(i)] = greatest * root;
  }
  return lengths;
}

int rank_of(const Svd& A, double part) {
  int rank = 0;
  while (index(rank) < A.s.size() && A.s[index(rank)] > part * A.s.front()) ++rank;
  return rank;
}

PositionSearch::PositionSearch(MultibodyProblem& problem, double t, double tolerance)
    : problem_(problem), tolerance_(tolerance) {
  point_.resize(problem.sizes());
  point_.t = t;
}

void PositionSearch::move_to(const Vector& q) {
  point_.q = q;
  const CallbackError error = problem_.at_position(point_.t, q.data(), point_.terms);
  if (error.status != SFDAE_OK) error.raise();
  point_.measure_rows();
}

PositionSearch::Linear PositionSearch::linear_along(const Matrix& P) const {
  Linear linear{product(point_.terms.g_q, P), {}, point_.terms.g};
  linear.units = scale_rows(linear.B);
  for (std::size_t i = 0; i < linear.units.size(); ++i) {
    double& unit = linear.units[i];
    // If nothing that the constraint depends on may move, the unit of its gradient stays.
    if (unit == 0.0) unit = point_.position_units[i] > 0.0 ? point_.position_units[i] : 1.0;
    linear.c[i] /= unit;
  }
  return linear;
}

// |c| at q; it counts as too large if callbacks cannot evaluate it.
double PositionSearch::residual_at(const Vector& q, const Vector& units) {
  constexpr double too_large = 1e300;
  Vector c(units.size());
  const CallbackError error = problem_.constraints(point_.t, q.data(), c.data());
  if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
  if (error.status != SFDAE_OK || !all_finite(c.data(), c.size())) return too_large;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] /= units[i];
  const double norm = length(c);
  return norm < too_large ? norm : too_large;
}

// One step that reduces |c|. False if there is none.
bool PositionSearch::improve(const Matrix& P) {
  // Required part of the expected decrease; fractions of a Gauss-Newton step to try; first damping parameter relative
  // to the smallest singular value squared, and ratio of successive ones; the last one relative to the largest.
  constexpr double least_gain = 0.1, first = 1e-2, ratio = 10.0, last = 100.0;
  constexpr double parts[] = {1.0, 0.25, 0.0625};
  const auto [B, units, c] = linear_along(P);
  const Svd A = svd(B);
  if (A.s.empty() || A.s.front() == 0.0) return false;
  const int rank = rank_of(A, singular_value_roundoff);
  const double before = std::pow(length(c), 2);
  const auto helps = [&, &units = units](const DampedStep& damped) {
    if (!(damped.expected > singular_value_roundoff * before)) return false;
    Vector trial(q());
    multiply(1.0, Op::plain, P, damped.step.data(), 1.0, trial.data());
    const double after = residual_at(trial, units);
    if (!(after * after <= before - least_gain * damped.expected)) return false;
    move_to(trial);
    return true;
  };
  for (const double part : parts)
    if (helps(DampedStep(A, rank, c, 0.0, part))) return true;
  const double end = last * std::pow(A.s.front(), 2);
  for (double lambda = first * std::pow(A.s[index(rank - 1)], 2); lambda < end; lambda *= ratio)
    if (helps(DampedStep(A, rank, c, lambda, 1.0))) return true;
  return false;
}

bool PositionSearch::approach(const Matrix& P, int most) {
  // Thresholds if nothing reduces residuals: relative to q, those that rounding errors may leave, as those of g depend
  // on other lengths than q; and those that are negligible compared with the tolerance.
  constexpr double small = 1e-12, far_below_tolerance = 1e-6;
  for (int iteration = 0; iteration < most; ++iteration) {
    if (holds_to_rounding()) return true;
    if (!improve(P)) break;
  }
  const double size = max_abs(q()) > 0.0 ? max_abs(q()) : 1.0;
  return length(residuals()) <= std::max(small * size, far_below_tolerance * tolerance_);
}

Vector PositionSearch::residuals() const {
  Vector result(point_.terms.g.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double unit = point_.position_units[i];
    result[i] = point_.terms.g[i] / (unit > 0.0 ? unit : 1.0);
  }
  return result;
}

bool PositionSearch::is_stationary(const Matrix& P) const {
  // Part of the residual that the directions can remove to first order, and threshold for dependent constraints.
  constexpr double removable = 1e-2, nearly_dependent = 1e-4;
  const auto [B, units, c] = linear_along(P);
  const Svd A = svd(B);
  if (A.s.empty() || A.s.front() == 0.0) return true;
  const DampedStep step(A, rank_of(A, nearly_dependent), c, 0.0, 1.0);
  return step.expected <= removable * removable * std::pow(length(c), 2);
}

}  // namespace sfdae::core
