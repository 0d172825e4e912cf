// Consistent initial values of a nonlinear problem: x is moved along the constraints toward the given values.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/nonlinear_values.h"

#include <algorithm>
#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "starts/linearized_constraints.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// The iteration ignores the curvature of the constraints and converges linearly if x is far from them: this accuracy is
// sufficient. Chosen, not measured.
constexpr double accuracy = 1e-8;

// weights: empty, or units of the components, whose squares may overflow.
double length(const Vector& v, const Vector& weights) {
  const auto entry = [&](std::size_t i) { return v[i] / (weights.empty() ? 1.0 : weights[i]); };
  double largest = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) largest = std::max(largest, std::fabs(entry(i)));
  if (largest == 0.0 || std::isinf(largest)) return largest;
  const int exponent = std::ilogb(largest);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double scaled = std::ldexp(entry(i), -exponent);
    sum += scaled * scaled;
  }
  return std::ldexp(std::sqrt(sum), exponent);
}

Vector difference(const Vector& a, const double* b) {
  Vector result(a);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] -= b[i];
  return result;
}

// Distance of a jet from the given values: the part that is minimized first, and the whole.
struct Distance {
  double of_differentiated = 0.0, whole = 0.0;
};

Distance distance_between(const ConstrainedPoint& point, const ConsistencyRequest& request, const Vector& given,
                          const Jet& jet) {
  const Vector dx = difference(given, jet.x.data());
  if (!request.differentiated_stay()) return {0.0, length(dx, request.weights)};
  return {length(differentiated_change(point, request, dx), request.sizes()), length(dx, request.sizes())};
}

// True if the distance is larger by more than the accuracy of the iteration: of differential variables or, if these do
// not differ, of all.
bool is_farther(const ConsistencyRequest& request, const Distance& one, const Distance& other) {
  // With weights, slow iterations at curved constraints end at a minimum only if every step leads toward it.
  if (request.is_weighted()) return one.whole >= other.whole;
  constexpr double nearer = 1.01, negligible = 1e-3;  // in tolerances
  if (one.of_differentiated > nearer * other.of_differentiated + negligible) return true;
  const double gained = other.of_differentiated - one.of_differentiated;
  if (gained > negligible + accuracy * other.of_differentiated) return false;
  return one.whole > nearer * other.whole;
}

}  // namespace

void prepare(JetSolver& solver, const ConsistencyRequest& request) {
  if (request.kind == InitialValues::fixed) solver.set_fixed(request.fixed);
  if (request.differentiated_stay()) solver.keep_differentiated(request.sizes());
}

namespace {

// The jet a part of the way from one to another.
Jet between(const Jet& from, const Jet& to, double part) {
  Jet jet = to;
  for (std::size_t i = 0; part < 1.0 && i < jet.x.size(); ++i) jet.x[i] = from.x[i] + part * (to.x[i] - from.x[i]);
  return jet;
}

// Derivatives far off may make up for constraints that x violates, as the linearized ones show. The first component
// that would have to change; -1: none.
int violated_component(const LinearizedConstraints& constraints, const Jet& jet, const ConsistencyRequest& request) {
  // Relative to a component, to the terms in its constraints, or to the largest value in the units of the equations,
  // compared with which it may be nothing; consistent jets are better by orders of magnitude. Chosen: one of 6000
  // random starts had 0.1.
  constexpr double consistent = 1e-6, beside = 1e-8, rounding = 1e-14;
  Vector tolerances = request.tolerances;
  tolerances.resize(index(jet.n), 0.0);
  const Vector violation = constraints.violation();
  const double largest = constraints.size_of(jet);
  for (int i = 0; i < jet.n; ++i) {
    const double allowed = std::max({consistent * std::fabs(jet.x[index(i)]), tolerances[index(i)],
                                     rounding * largest * constraints.point().units[i]});
    const double size = std::fabs(violation[index(i)]);
    if (!(size <= allowed) && !(size <= beside * constraints.size_beside(i, jet))) return i;
  }
  return -1;
}

void demand_constraints(const LinearizedConstraints& constraints, const Jet& jet, const ConsistencyRequest& request) {
  const int violated = violated_component(constraints, jet, request);
  if (violated < 0) return;
  throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                format("no consistent values were found near the guess at t = %.15g; in what was found constraints "
                       "are violated, by which x[%d] would have to change by %.3g. Give a better guess, or fix fewer "
                       "components.",
                       jet.t, violated, constraints.violation()[index(violated)]));
}

// The change of a consistent jet toward the target.
class Approach {
 public:
  Approach(JetSolver& solver, LinearizedConstraints& constraints, const ConsistencyRequest& request,
           const Vector& target)
      : solver_(solver), constraints_(constraints), request_(request), target_(target) {}

  // Goes from the jet toward `full` and back to the constraints, as far as that succeeds at a point with the known
  // ranks and, if required, brings it nearer; the constraints are then those of the resulting jet. False, with the jet
  // unchanged, if no part of the way succeeds.
  bool advance(const Jet& full, bool has_to_be_nearer, Jet& jet) {
    // Chosen, not measured.
    const double shortest = request_.is_weighted() ? 1.0 / 1024.0 : 1.0 / 32.0;
    const int mu = full.order - 1;
    for (double part = 1.0; part >= shortest; part *= 0.5) {
      Jet next = between(jet, full, part);
      if (!is_solved(next, mu)) continue;
      const bool is_allowed = !has_to_be_nearer || !is_farther(request_, distance(next), distance(jet));
      if (is_allowed && has_known_ranks(next)) {
        jet = std::move(next);
        return true;
      }
      if (is_allowed) constraints_.linearize(jet);
      else if (!request_.differentiated_stay() && !request_.is_weighted()) return false;
    }
    return false;
  }

 private:
  // Residuals of other ranks can be small where hidden constraints are violated.
  bool has_known_ranks(const Jet& jet) {
    constraints_.linearize(jet);
    return constraints_.has_known_ranks();
  }
  Distance distance(const Jet& jet) const { return distance_between(constraints_.point(), request_, target_, jet); }
  bool is_solved(Jet& jet, int mu) {
    try {
      solver_.solve(jet, mu);
      return true;
    } catch (const Failure& failure) {
      const int status = failure.status();
      if (status != SFDAE_NO_CONSISTENT_VALUES && status != SFDAE_NOT_FINITE && status != SFDAE_CALLBACK_FAILED)
        throw;
      return false;
    }
  }

  JetSolver& solver_;
  LinearizedConstraints& constraints_;
  const ConsistencyRequest& request_;
  const Vector& target_;
};

}  // namespace

ConsistentJetResult choose_consistent_jet(NonlinearProblem& problem, const IndexAnalysis& analysis,
                                          const Units& units, const ConsistencyRequest& request,
                                          const ConsistentJetStart& start) {
  // A few units of roundoff of x: there is nothing to change.
  constexpr double no_change = 1e-15;
  // Limits of iterations: those with shortened steps may be slow. Chosen, not measured.
  const bool keeps = request.differentiated_stay() || request.is_weighted();
  const int most = request.is_weighted() ? 300 : keeps ? 100 : 30;
  const bool may_move = request.kind == InitialValues::nearest || request.kind == InitialValues::fixed;
  const Vector& x = start.given;
  const Vector target = may_move ? with_inputs(problem, start.jet.t, x) : x;
  ConsistentJetResult result;
  result.jet = start.jet;
  result.jet.set_order(analysis.values.mu + 1);
  JetSolver solver(problem, units);
  prepare(solver, request);
  LinearizedConstraints constraints(problem, {analysis, units, start.rank_tol});
  if (may_move) constraints.follow_inputs();
  Approach approach(solver, constraints, request, target);
  double before = 0.0;
  constraints.linearize(result.jet);
  if (!constraints.has_known_ranks())
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  "the characteristic values known (" + describe(analysis.values) +
                      format(") do not hold at t = %.15g. Analyze the problem there.", start.jet.t));
  // A jet that was found with other values of parameters may be nearer than any consistent one.
  const bool begins_nearer = keeps && violated_component(constraints, result.jet, request) < 0;
  for (int iteration = 0; iteration < most; ++iteration) {
    Jet full = result.jet;
    const double change = constraints.move(request, target, full);
    if (iteration > 0 && change > before && !keeps) break;
    if (change > no_change && !approach.advance(full, begins_nearer || iteration > 0, result.jet)) break;
    if (change < accuracy) break;
    before = change;
  }
  demand_constraints(constraints, result.jet, request);
  const Vector found(result.jet.x.data(), result.jet.x.data() + problem.n());
  result.change.residual_before = length(difference(x, found.data()), {});
  result.change.residual_after = length(constraints.violation(), {});
  report_change(request, start.jet.t, x, found, result.change);
  result.value_change = change_of_differentiated(constraints.point(), request, x, found);
  return result;
}

}  // namespace sfdae::core
