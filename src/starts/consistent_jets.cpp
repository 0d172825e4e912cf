// Consistent jets of a nonlinear problem near a guess.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/consistent_jets.h"

#include <algorithm>
#include <utility>

#include "problem/failure.h"
#include "starts/jet_solver.h"

namespace sfdae::core {

namespace {

// True if the search may succeed from another start.
bool depends_on_start(const Failure& failure) {
  return failure.status() == SFDAE_NOT_FINITE || failure.status() == SFDAE_CALLBACK_FAILED ||
         failure.status() == SFDAE_NO_CONSISTENT_VALUES;
}

}  // namespace

ConsistentJets::ConsistentJets(NonlinearProblem& problem, double t, const double* x, std::vector<char> fixed)
    : problem_(problem), fixed_(std::move(fixed)) {
  Point first;
  first.jet.t = t;
  first.jet.n = problem.n();
  first.jet.x.assign(x, x + problem.n());
  points_.push_back(std::move(first));
}

void ConsistentJets::guess_derivative(const double* xdot) {
  Jet& jet = points_.front().jet;
  jet.set_order(1);
  std::copy_n(xdot, jet.n, jet.column(1));
}

// A new point starts from the Taylor polynomial of the first one, as far as that is determined.
ConsistentJets::Point& ConsistentJets::point_at(double t) {
  for (Point& point : points_)
    if (point.jet.t == t) return point;
  points_.push_back(points_.front());
  Point& point = points_.back();
  Jet& jet = point.jet;
  const int level = std::max(points_.front().level, 0);
  if (jet.order > level) {
    // The highest coefficients are determined in part; the rest are as guessed.
    const std::vector<double> highest(jet.column(level + 1), jet.column(level + 1) + jet.n);
    jet.set_order(level);
    jet.shift(t - jet.t);
    jet.set_order(level + 1);
    std::copy(highest.begin(), highest.end(), jet.column(level + 1));
  } else {
    jet.shift(t - jet.t);
  }
  point.jet.t = t;
  point.level = -1;
  point.is_unshifted = false;
  return point;
}

// Polynomials of stiff problems lead far off within a short time: derivatives of fast components are large unless these
// are at rest. x alone is a better start then.
const Jet& ConsistentJets::jet_at(double t, int level) {
  Point& point = point_at(t);
  if (&point == &points_.front()) {
    solve(point, level);
    return point.jet;
  }
  try {
    solve(point, level);
    return point.jet;
  } catch (const Failure& failure) {
    if (point.is_unshifted || !depends_on_start(failure)) throw;
  }
  point.jet = points_.front().jet;
  point.jet.set_order(0);
  point.jet.t = t;
  point.level = -1;
  point.is_unshifted = true;
  solve(point, level);
  return point.jet;
}

void ConsistentJets::solve(Point& point, int level) {
  JetSolver solver(problem_, units_);
  if (&point == &points_.front()) solver.set_fixed(fixed_);
  solver.keep_differentiated(sizes_);
  while (point.level < level) {
    Jet next = point.jet;  // stays as it is if the next level has none
    solver.solve(next, point.level + 1);
    point.jet = std::move(next);
    ++point.level;
  }
}

CallbackError ConsistentJets::evaluate(double t, Orders orders, double time_scale, TaylorData& data, RowScaling rows,
                                       const std::vector<double>* preferred_rows) {
  const int level = std::max({orders.E, orders.A, orders.f});
  const Jet& jet = jet_at(t, level);
  return problem_.linearize(t, jet.x.data(), orders, {time_scale, rows, preferred_rows, &units_}, data);
}

}  // namespace sfdae::core
