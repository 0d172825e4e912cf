// Objects of the theory for a nonlinear problem at a jet.
// SPDX-License-Identifier: BSD-3-Clause
#include "starts/jet_theory.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/rank_sequence.h"
#include "starts/jet_solver.h"

namespace sfdae::core {

namespace {

TaylorData linearize(NonlinearProblem& problem, const Units& units, double time_scale, const Jet& jet, int level) {
  TaylorData data;
  const NonlinearProblem::Scaling scaling{time_scale, RowScaling::each, nullptr, &units};
  const CallbackError error = problem.linearize(jet.t, jet.x.data(), {level, level, level}, scaling, data);
  if (error.status != SFDAE_OK) error.raise();
  return data;
}

// Ranks that fit the known values; if v^ is unknown, it is taken as found.
std::optional<RankSequence> fitting_ranks(const TaylorData& data, const AnalysisSettings& settings,
                                          IndexAnalysis& known) {
  const int mu = known.values.mu;
  Arena arena;
  NullSpaceForm form;
  if (known.v_hat >= 0) return matching_ranks(data, mu, known, settings.rank_tol, {arena, form});
  for (const NoiseModel noise : {NoiseModel::pivots, NoiseModel::carried, NoiseModel::data}) {
    const RankResult found = find_ranks(data, mu, {settings.rank_tol, false, noise, nullptr}, {arena, form});
    if (found.ranks.a != known.values.a || found.ranks.d != known.values.d) continue;
    known.v_hat = found.ranks.v_hat;
    return found.list;
  }
  return std::nullopt;
}

// False if there is no such jet near `jet`.
bool solve_for_derivatives(NonlinearProblem& problem, const Units& units, int level, Jet& jet) {
  JetSolver solver(problem, units);
  solver.set_fixed(std::vector<char>(index(jet.n), 1));
  try {
    for (int l = std::min(level, std::max(jet.order - 1, 0)); l <= level; ++l) solver.solve(jet, l);
    return true;
  } catch (const Failure& failure) {
    if (failure.status() != SFDAE_NO_CONSISTENT_VALUES) throw;
    return false;
  }
}

}  // namespace

Jet jet_through(NonlinearProblem& problem, const Units& units, const Jet& start, int level) {
  Jet jet = start;
  if (jet.order > level + 1) jet.set_order(level + 1);
  if (solve_for_derivatives(problem, units, level, jet)) return jet;
  jet = start;
  jet.set_order(0);
  if (solve_for_derivatives(problem, units, level, jet)) return jet;
  throw_inconsistent_jet(start.t, level);
}

void throw_inconsistent_jet(double t, int level) {
  throw Failure(
      SFDAE_INCONSISTENT_VALUES,
      format("no derivatives of x fulfil the equations and their derivatives up to order %d at t = %.15g: x "
             "is not consistent. Call sfdae_make_consistent first.",
             level, t));
}

DerivativeArray derivative_array(NonlinearProblem& problem, const Jet& jet, int level) {
  const Units none;
  return derivative_array(linearize(problem, none, 0.0, jet, level), level, none);
}

Projectors projectors(NonlinearProblem& problem, const Units& units, const IndexAnalysis& known,
                      const AnalysisSettings& settings, const Jet& jet) {
  const TaylorData data = linearize(problem, units, known.time_scale, jet, known.values.mu);
  IndexAnalysis found = known;
  const std::optional<RankSequence> ranks = fitting_ranks(data, settings, found);
  if (!ranks)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED, "the characteristic values known (" + describe(known.values) +
                                                     format(") do not hold at this jet at t = %.15g.", jet.t));
  return projectors(data, units, found, {settings.rank_tol, false, NoiseModel::pivots, &*ranks});
}

void move_to_jet(const Jet& jet, DerivativeArray& array) {
  std::vector<double> y;
  double factorial = 1.0;
  for (int k = 1; static_cast<int>(y.size()) < array.M.cols(); ++k) {
    factorial *= k;
    for (int j = 0; j < jet.n; ++j) y.push_back(factorial * jet.column(k)[j]);
  }
  multiply(1.0, Op::plain, array.N, jet.column(0), 1.0, array.g.data());
  multiply(-1.0, Op::plain, array.M, y.data(), 1.0, array.g.data());
}

}  // namespace sfdae::core
