// The jump of a nonlinear problem from values of other equations to consistent ones.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/nonlinear_jump.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"
#include "starts/jet_solver.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Changes of the iteration relative to x: it converges quadratically, and ends with the second of them.
constexpr double converged_change = 1e-7, no_change = 1e-14;
constexpr int most_jump_iterations = 50;
// Changes that grow by more are overshoots: a part of the last one is made instead, first a quarter, down to this part.
// (Chosen.)
constexpr double most_growth = 2.0, shortest = 1e-3;
// Residual relative to the terms of an equation at another point: its factors differ there if it is larger. Iterations
// leave less. (Chosen.)
constexpr double same_factors = 1e-6;

struct Found : JumpPoint {
  Jump jump;
  double rounding = 0.0;  // in the equations of impulses
};

Vector jump_from(const Vector& a, const double* b) {
  Vector result(a);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] -= b[i];
  return result;
}

// Change relative to x, in the units of the equations.
double relative_change(const Vector& dx, const LinearizedConstraints& constraints, const Jet& jet,
                       const Units& units) {
  const double size = constraints.size_of(jet);
  const double largest = units.largest(dx.data(), jet.n);
  return size > 0.0 ? largest / size : largest;
}

// Unknowns in small units settle later than those in large ones: each counts relative to its own values. size: of the
// largest of them, in the units of the equations.
bool has_settled(const Vector& dx, const Jet& jet, const Vector& before, const Units& units, double size) {
  constexpr double roundings = 1e-13;
  for (int i = 0; i < jet.n; ++i) {
    const double own = std::max(std::fabs(jet.x[index(i)]), std::fabs(before[index(i)]));
    if (!(std::fabs(dx[index(i)]) <= std::max(converged_change * own, roundings * size * units[i]))) return false;
  }
  return true;
}

Found iterate(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Jet& start,
              const Vector& before) {
  const int mu = known.analysis.values.mu;
  Found found;
  found.jet = start;
  found.jet.set_order(mu + 1);
  JetSolver solver(problem, known.units);
  LinearizedConstraints constraints(problem, known);
  constraints.follow_inputs();
  const Vector inputs_after = with_inputs(problem, start.t, before);
  // The last change and where it began.
  Jet last = found.jet;
  Vector step;
  double part = 1.0, last_change = std::numeric_limits<double>::infinity();
  bool shortens = true;
  for (int iteration = 0; iteration < most_jump_iterations; ++iteration) {
    constraints.linearize(found.jet);
    if (!constraints.has_known_ranks()) break;
    InputsAfter inputs{problem.prescribed(), {}};
    for (int i : problem.prescribed()) inputs.values.push_back(inputs_after[index(i)] - found.jet.x[index(i)]);
    found.data = coefficients_of_jump(problem, known, found.jet, nullptr, {mu, mu, mu});
    const ConstrainedPoint point = constraints.point();
    double size = constraints.size_of(found.jet);
    for (int i = 0; i < found.jet.n; ++i) size = std::max(size, std::fabs(before[index(i)]) / known.units[i]);
    found.rounding = rounding_of_impulses(point, size);
    found.jump =
        jump_by_impulses({point, found.data, mu, inputs, size}, jump_from(before, found.jet.x.data()), &found.theta);
    const double change = relative_change(found.jump.x, constraints, found.jet, known.units);
    if (change > most_growth * last_change && shortens) {
      part *= 0.25;
      // Branches of conditions make algebraic unknowns jump, however short the change is.
      shortens = part > shortest;
      for (double& each : step) each *= 0.25;
      found.jet = last;
      constraints.linearize(found.jet);
      constraints.move_by(step, found.jet);
      solver.solve(found.jet, mu);
      continue;
    }
    last = found.jet, step = found.jump.x, last_change = change, part = 1.0;
    constraints.move_by(found.jump.x, found.jet);
    if (change > no_change) solver.solve(found.jet, mu);
    if (change > converged_change || !has_settled(step, found.jet, before, known.units, size)) continue;
    found.jump.x.assign(found.jet.x.data(), found.jet.x.data() + problem.n());
    return found;
  }
  throw Failure(
      SFDAE_NO_CONSISTENT_VALUES,
      format(
          "no values were found that impulses of the equations lead to from those before t = %.15g. Give the values "
          "after the jump yourself, with sfdae_start, and fix those that have to stay.",
          start.t));
}

// False if factors differ, or if the equations cannot be evaluated there (row = -1).
bool has_same_factors(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Found& found,
                      const Jet& jet, int& row) {
  const int mu = known.analysis.values.mu;
  TaylorData data;
  try {
    data = coefficients_of_jump(problem, known, jet, &found.data.row_scale, {mu, mu, mu});
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_NOT_FINITE && failure.status() != SFDAE_CALLBACK_FAILED) throw;
    row = -1;
    return false;
  }
  const Vector left = residuals_of_impulses(data, mu, found.theta, found.rounding);
  const auto worst = std::max_element(left.begin(), left.end());
  if (worst == left.end() || *worst <= same_factors) return true;
  row = static_cast<int>(worst - left.begin()) % problem.m();
  return false;
}

// True if something jumps beyond roundoff.
bool has_jumped(const Found& found, const Units& units) {
  const double largest = units.largest(found.jet.x.data(), found.jet.n);
  return max_abs(found.theta) > std::max(1e-10 * largest, found.rounding);
}

void demand_linearity(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Found& found) {
  if (!has_jumped(found, known.units)) return;
  for (const double part : {0.0, 0.37, 1.0}) {
    int row = -1;
    bool is_same = false;
    for (double strength = 1.0; !is_same && row < 0 && strength > 1e-7; strength *= 1e-3)
      is_same = has_same_factors(problem, known, found, jet_aside(known, found, part, strength), row);
    if (is_same) continue;
    throw Failure(
        SFDAE_NO_CONSISTENT_VALUES,
        format("the jump at t = %.15g is not determined: %s Write the equation so that what jumps is in it linearly, "
               "with "
               "factors that stay (differentiate a charge instead of C(v) v'), or give the values after the jump "
               "yourself, with sfdae_start.",
               found.jet.t,
               row < 0 ? "the equations cannot be evaluated between the values before and after it."
                       : (problem.equation_names().row(row) +
                          " multiplies what jumps, or has an impulse, by a factor that jumps itself.")
                             .c_str()));
  }
}

}  // namespace

TaylorData coefficients_of_jump(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Jet& jet,
                                const Vector* rows, Orders orders) {
  const WithoutStructure whole(problem);
  TaylorData data;
  const NonlinearProblem::Scaling scaling{
      known.analysis.time_scale, rows != nullptr ? RowScaling::given : known.analysis.rows, rows, &known.units};
  const CallbackError error = problem.linearize(jet.t, jet.x.data(), orders, scaling, data);
  if (error.status != SFDAE_OK) error.raise();
  return data;
}

Jet jet_aside(const LinearizedConstraints::Known& known, const JumpPoint& at, double part, double strength) {
  Jet jet = at.jet;
  const int n = jet.n;
  double largest = 0.0;
  for (int i = 0; i < n; ++i)
    largest = std::max({largest, std::fabs(jet.x[index(i)]) / known.units[i], std::fabs(at.theta(i, 0))});
  const double tau = at.data.time_scale;
  for (int i = 0; i < n; ++i) {
    const double unit = known.units[i];
    jet.column(0)[i] -= (1.0 - part) * unit * at.theta(i, 0);
    for (int k = 1; k < at.theta.cols(); ++k) jet.column(0)[i] += strength * unit * at.theta(i, k);
    double scale = strength * unit * (largest > 0.0 ? largest : 1.0);
    for (int k = 1; k <= jet.order; ++k) {
      scale /= tau;
      // Any numbers, different for all.
      jet.column(k)[i] += scale * std::sin(1.0 + 2.3 * i + 5.1 * k + 7.7 * part);
    }
  }
  return jet;
}

Jump find_jump(NonlinearProblem& problem, const LinearizedConstraints::Known& known, const Vector& before,
               Jet& start) {
  Found found = iterate(problem, known, start, before);
  demand_linearity(problem, known, found);
  start = std::move(found.jet);
  return std::move(found.jump);
}

}  // namespace sfdae::core
