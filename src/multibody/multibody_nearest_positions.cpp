// Positions on the constraints nearest to given ones.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_nearest_positions.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Threshold for dependent constraints, far above rounding errors of gradients at an inexact point, as directions, not
// ranks, are wanted here.
constexpr double dependent = 1e-7;

double dot(const Vector& a, const Vector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double norm_of(const Vector& a) { return std::sqrt(dot(a, a)); }

// factor a + b
Vector sum(double factor, const Vector& a, const Vector& b) {
  Vector result(b);
  for (std::size_t i = 0; i < b.size(); ++i) result[i] += factor * a[i];
  return result;
}

}  // namespace

NearestPositions::NearestPositions(MultibodyProblem& problem, const Vector& given, const PositionMetric& metric,
                                   PositionSearch& search)
    : problem_(problem),
      given_(given),
      metric_(metric),
      search_(search),
      y_(index(metric.P.cols())),
      beside_(problem.sizes()) {}

// y of the present positions.
Vector NearestPositions::change() const {
  Vector y(y_.size());
  if (!y.empty()) multiply(1.0, Op::plain, metric_.R, sum(-1.0, given_, search_.q()).data(), 0.0, y.data());
  return y;
}

void NearestPositions::linearize() {
  y_ = change();
  Matrix B = product(search_.point().terms.g_q, metric_.P);
  units_ = scale_rows(B);
  B_ = svd(B);
  rank_ = B_.s.empty() || B_.s.front() == 0.0 ? 0 : rank_of(B_, dependent);
}

// Remainder of w without its components in the range of B^T.
Vector NearestPositions::open_part(const Vector& w) const {
  Vector open(w);
  for (int k = 0; k < rank_; ++k) {
    double along = 0.0;
    for (std::size_t i = 0; i < w.size(); ++i) along += B_.V(static_cast<int>(i), k) * w[i];
    for (std::size_t i = 0; i < w.size(); ++i) open[i] -= along * B_.V(static_cast<int>(i), k);
  }
  return open;
}

// f with y = -P^T g_q^T f, except for the open part.
Vector NearestPositions::forces() const {
  Vector f(units_.size(), 0.0);
  for (int k = 0; k < rank_; ++k) {
    double along = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) along -= B_.V(static_cast<int>(i), k) * y_[i];
    for (std::size_t i = 0; i < f.size(); ++i)
      if (units_[i] > 0.0) f[i] += B_.U(static_cast<int>(i), k) * along / (B_.s[index(k)] * units_[i]);
  }
  return f;
}

// P^T (g_q^T f)_q P w
Vector NearestPositions::bend(const Vector& forces, const Vector& w) {
  // Relative to q, as differences of the first order need.
  constexpr double relative_step = 1e-7;
  const Vector& q = search_.q();
  Vector dq(q.size()), bent(q.size()), result(w.size(), 0.0);
  multiply(1.0, Op::plain, metric_.P, w.data(), 0.0, dq.data());
  const double size = max_abs(q), change = max_abs(dq);
  if (change == 0.0) return result;
  const double part = relative_step * (size > 0.0 ? size : 1.0) / change;
  const CallbackError error = problem_.at_position(search_.point().t, sum(part, dq, q).data(), beside_);
  if (error.status != SFDAE_OK && !error.is_recoverable()) error.raise();
  if (error.status != SFDAE_OK) return result;
  multiply(1.0 / part, Op::transposed, beside_.g_q, forces.data(), 0.0, bent.data());
  multiply(-1.0 / part, Op::transposed, search_.point().terms.g_q, forces.data(), 1.0, bent.data());
  multiply(1.0, Op::transposed, metric_.P, bent.data(), 0.0, result.data());
  return result;
}

// Solves H step = -open in the open directions, with H the Hessian of |y|^2 / 2 + f^T g, up to the radius; at negative
// curvature the step ends at the radius [NW06, algorithm 7.2].
NearestPositions::Step NearestPositions::step_within(double radius, const Vector& open) {
  // Limit on iterations, each of which evaluates g_q; the relative residual that is enough.
  constexpr int most = 40;
  constexpr double coarsest = 0.1;
  const Vector f = forces(), none(y_.size(), 0.0);
  Step step{none, 0.0};
  Vector rest(open), direction(sum(-1.0, open, none));
  double squares = dot(rest, rest);
  const double target = squares * std::pow(std::min(coarsest, std::sqrt(squares) / norm_of(y_)), 2);
  for (int iteration = 0; iteration < most && squares > target; ++iteration) {
    const Vector image = sum(1.0, open_part(bend(f, direction)), direction);
    const double energy = dot(direction, image), along = dot(step.y, direction), size = dot(direction, direction),
                 room = radius * radius - dot(step.y, step.y),
                 farthest = (std::sqrt(along * along + size * std::max(room, 0.0)) - along) / size;
    const bool is_last = !(energy * farthest > squares);
    const double factor = is_last ? farthest : squares / energy;
    step.y = sum(factor, direction, step.y);
    step.expected += factor * (squares - 0.5 * factor * energy);
    if (is_last) break;
    rest = sum(factor, image, rest);
    const double next = dot(rest, rest);
    direction = sum(-1.0, rest, sum(next / squares, direction, none));
    squares = next;
  }
  return step;
}

// Takes the step and returns to the constraints: the decrease of |y|^2 / 2 in units of the expected one. If that fails,
// returns 0 and restores the search.
double NearestPositions::gain_of(const Step& step) {
  // Limit on iterations back, as steps are short; required part of the expected decrease; a relative change of |y|^2
  // that is a rounding error.
  constexpr int most = 15;
  constexpr double least = 1e-4, equal = 1e-14;
  const Vector start(search_.q());
  Vector trial(start);
  const double before = 0.5 * dot(y_, y_);
  multiply(1.0, Op::plain, metric_.P, step.y.data(), 1.0, trial.data());
  try {
    search_.move_to(trial);
    bool is_back = search_.approach(metric_.P, most);
    if (!is_back) {
      search_.move_to(trial);
      is_back = search_.approach(metric_.open, most);
    }
    if (is_back) {
      const Vector y = change();
      const double decrease = before - 0.5 * dot(y, y);
      if (decrease >= least * step.expected) return decrease / step.expected;
      if (step.expected <= equal * before && decrease >= -equal * before) return 1.0;
    }
  } catch (const Failure& failure) {
    if (failure.status() == SFDAE_CALLBACK_STOPPED || failure.status() == SFDAE_STOPPED) throw;
  }
  search_.move_to(start);
  return 0.0;
}

void NearestPositions::approach() {
  // Limit on iterations; part of the change that may remain in open directions at the end; smallest radius of steps.
  constexpr int most = 1000;
  constexpr double accuracy = 1e-9, smallest = 1e-12;
  // Gains below which the radius is too large, and above which it may be larger [NW06, algorithm 4.1].
  constexpr double poor = 0.25, good = 0.75;
  if (y_.empty()) return;
  linearize();
  double radius = norm_of(y_);
  for (int iteration = 0; iteration < most; ++iteration) {
    const Vector open = open_part(y_);
    if (!(norm_of(open) > accuracy * norm_of(y_)) || radius <= smallest * norm_of(y_)) return;
    const Step step = step_within(radius, open);
    const double gain = gain_of(step), size = norm_of(step.y);
    if (gain < poor) radius = 0.25 * size;
    else if (gain > good) radius = std::max(radius, 2.0 * size);
    if (gain > 0.0) linearize();
  }
}

}  // namespace sfdae::core
