// Schedule of the rank decisions of a nonlinear system.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/rank_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"
#include "reduction/index_analysis.h"
#include "reduction/index_search.h"
#include "reduction/rank_sequence.h"
#include "starts/consistent_jets.h"
#include "system/jet_coefficients.h"
#include "system/relative_orientation.h"

namespace sfdae::core {

namespace {

// Linearizations are renewed, and ranks judged, after this many points at the latest
// (docs/design/derivative_array.md). Chosen, not measured.
constexpr int most_unjudged = 10;
// The convergence rate after a renewal is at most this, as a rule. Chosen, not measured.
constexpr double rate_after_renewal = 0.1;

// True if all matrices agree: then the ranks do, and the forms for a right-hand side 0.
bool has_same_matrices(const TaylorData& a, const TaylorData& b) {
  if (a.m != b.m || a.n != b.n || a.orders.E != b.orders.E || a.orders.A != b.orders.A || a.has_errors() ||
      b.has_errors() || a.time_scale != b.time_scale || a.differentiations != b.differentiations ||
      a.residual_noise != b.residual_noise || a.E0_was_rounding != b.E0_was_rounding || a.row_scale != b.row_scale)
    return false;
  const std::size_t size = index(a.m) * index(a.n);
  for (int k = 0; k <= a.orders.E; ++k)
    if (!std::equal(a.E(k).data, a.E(k).data + size, b.E(k).data)) return false;
  for (int k = 0; k <= a.orders.A; ++k)
    if (!std::equal(a.A(k).data, a.A(k).data + size, b.A(k).data)) return false;
  return true;
}

}  // namespace

PointStatus RankCheck::renew(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration) {
  unjudged_ = 0;
  const PointStatus status = judge(jet, linearization, iteration);
  if (status != PointStatus::changed || linearization.ranks().count == 0) return status;
  const Finding finding = analyze(jet);
  if (finding == Finding::other_values || linearization.renew(jet, false) != PointStatus::ok) return status;
  const bool holds = finding == Finding::known_values || !linearization.has_tiny_pivots();
  return holds ? PointStatus::ok : status;
}

PointStatus RankCheck::judge(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration) {
  const PointStatus status = linearization.renew(jet, true);
  if (status != PointStatus::changed || linearization.ranks().count == 0) return status;
  // With the known ranks residuals become roundoff in a few iterations, unless the ranks do not hold.
  refined_ = jet;
  if (linearization.renew(jet, false) != PointStatus::ok ||
      iteration.solve(IterationTask{}, linearization, refined_) != PointStatus::ok)
    return status;
  return linearization.renew(refined_, true);
}

RankCheck::Finding RankCheck::analyze(const Jet& jet) const {
  ConsistentJets jets(problem_.problem(), jet.t, jet.x.data(), {});
  jets.set_units(problem_.units());
  try {
    IndexSearch search({jets, problem_.settings(), arena_}, jet.t);
    const SearchResult found = search.search(problem_.settings().max_index);
    if (!found.last.clear) return Finding::unclear;
    return found.values == problem_.analysis().values ? Finding::known_values : Finding::other_values;
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
    return Finding::unclear;
  }
}

PointStatus RankCheck::compare(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration) {
  if (unjudged_ == 0 || compared_t_ == jet.t) return PointStatus::ok;
  PointStatus status = match_known_ranks(jet, linearization);
  if (status == PointStatus::changed) {
    // Residuals left by the iteration look like nonzero pivots.
    refined_ = jet;
    if (linearization.is_usable() && iteration.solve_to_rounding(linearization, refined_) == PointStatus::ok)
      status = match_known_ranks(refined_, linearization);
  }
  if (status == PointStatus::changed) {
    JetCoefficients source(problem_.problem(), jet, problem_.units());
    if (known_values_hold(source, jet.t, problem_.settings(), problem_.analysis(), arena_) ||
        analyze(jet) != Finding::other_values)
      status = PointStatus::ok;
  }
  if (status == PointStatus::ok) compared_t_ = jet.t;
  return status;
}

PointStatus RankCheck::match_known_ranks(const Jet& jet, const ArrayLinearization& linearization) {
  const long constant = problem_.problem().constant_matrices();
  if (has_form_ && constant >= 0 && constant == constant_matrices_) return PointStatus::ok;
  const bool had_form = std::exchange(has_form_, false);
  std::swap(data_, data_before_);
  const PointStatus status = problem_.linearize(jet, linearization.preferred_rows(), data_);
  if (status != PointStatus::ok) return status;
  constant_matrices_ = constant;
  has_form_ = had_form && has_same_matrices(data_, data_before_);
  if (has_form_) return PointStatus::ok;
  has_form_ = matching_form(data_, problem_.mu(), problem_.analysis(), problem_.settings().rank_tol, {arena_, form_});
  return has_form_ ? PointStatus::ok : PointStatus::changed;
}

bool RankCheck::count_point() { return ++unjudged_ >= most_unjudged; }

void RankCheck::expect_fast(ChordIteration& chord) { chord.set_rate(std::min(chord.rate(), rate_after_renewal)); }

PointStatus RankCheck::review(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration) {
  const bool is_due = count_point(), contradicts = iteration.has_contradiction();
  ChordIteration& chord = iteration.chord();
  if (!chord.is_slow() && !is_due && !contradicts) return PointStatus::ok;
  const PointStatus status = renew(jet, linearization, iteration);
  expect_fast(chord);
  if (status != PointStatus::ok || !contradicts) return status;
  // A linearization from another point may have left residuals in redundant equations.
  refined_ = jet;
  iteration.solve_to_rounding(linearization, refined_);
  return PointStatus::ok;
}

PointStatus RankCheck::review_by_comparison(const Jet& jet, const double* inverse_weights,
                                            ArrayLinearization& linearization, NonlinearIteration& iteration) {
  ++unjudged_;
  const PointStatus status = compare(jet, linearization, iteration);
  if (status != PointStatus::ok) return status;
  unjudged_ = 0;
  if (problem_.analysis().v_hat == 0 || iteration.has_contradiction() ||
      serves_at(jet, inverse_weights, linearization))
    return status;
  compared_t_ = std::numeric_limits<double>::quiet_NaN();
  return PointStatus::not_converged;
}

// With redundant equations there is a choice of constraints and of differential equations. A linearization far off may
// choose wrongly: rows that nothing violates in place of constraints, or equations that hardly describe how x moves at
// the end of the step (docs/design/rank_decisions.md).
bool RankCheck::serves_at(const Jet& jet, const double* inverse_weights,
                          const ArrayLinearization& linearization) const {
  constexpr double least = 0.5;  // cosine
  const NullSpaceForm* const now = compared_form(jet.t);
  const NullSpaceForm& then = linearization.form();
  if (now == nullptr) return true;
  // At consistent points the choice is right: the remaining residuals are negligible contradictions.
  if (!linearization.origin().is_judged && !fulfils_algebraic_equations(jet, inverse_weights)) return false;
  if (now->d != then.d || data_.row_scale != linearization.data().row_scale) return true;
  return cosine_between(then.Z1(), now->Z1(), least, arena_) >= least;
}

// True if the equations without derivatives hold at the jet of data_ to within changes of x by a tolerance.
bool RankCheck::fulfils_algebraic_equations(const Jet& jet, const double* inverse_weights) const {
  constexpr double rounding = 1e-13;  // relative to the terms; chosen, not measured
  for (int i = 0; i < data_.m; ++i) {
    bool has_derivative = false;
    double allowed = 0.0;
    for (int j = 0; j < data_.n && !has_derivative; ++j) {
      const double change = 1.0 / inverse_weights[j] + rounding * std::fabs(jet.x[index(j)]);
      has_derivative = data_.E(0)(i, j) != 0.0;
      allowed += std::fabs(data_.A(0)(i, j)) * change / problem_.units()[j];
    }
    if (!has_derivative && std::fabs(data_.f(0)[i]) > allowed) return false;
  }
  return true;
}

}  // namespace sfdae::core
