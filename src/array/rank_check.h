// Schedule of the rank decisions of a nonlinear system at converged points, where linearizations are renewed.
//
// Between these points the known ranks are taken. Ranks hold on F_mu = 0 only: pivots that vanish there are as large as
// the residuals left by an iteration (docs/design/rank_decisions.md), so that doubtful points are first iterated to
// machine precision. In steps and at outputs alike the known ranks hold until the full analysis clearly contradicts
// them (docs/design/rank_decisions.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/nonlinear_iteration.h"
#include "linalg/arena.h"
#include "reduction/null_space_form.h"
#include "system/jet.h"

namespace sfdae::core {

class RankCheck {
 public:
  RankCheck(AnalyzedEquations& problem, Arena& arena) : problem_(problem), arena_(arena) {}

  // Renews the linearization at the jet, which has converged to the tolerance of the iteration, and judges its ranks.
  PointStatus renew(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // Checks that the known ranks hold at the jet; the linearization is not changed.
  PointStatus compare(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // A further point has converged: renews the linearization there if it has become slow, and periodically.
  PointStatus review(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // A further point has converged: compares the known ranks with those there; the linearization is not changed.
  // not_converged: it is unsuitable there.
  PointStatus review_by_comparison(const Jet& jet, const double* inverse_weights, ArrayLinearization& linearization,
                                   NonlinearIteration& iteration);

  // For linearizations that are renewed elsewhere. A further point has converged; true if ranks are to be judged.
  bool count_point();
  // Confirms the ranks at the converged point.
  void confirm(ChordIteration& chord) {
    unjudged_ = 0;
    expect_fast(chord);
  }
  // A linearization has been renewed: its rate is unknown, but will be small.
  static void expect_fast(ChordIteration& chord);

  // Form and data of the comparison at t; the form is null if there was none, or if it has not been kept.
  const NullSpaceForm* compared_form(double t) const { return compared_t_ == t && has_form_ ? &form_ : nullptr; }
  const TaylorData& compared_data() const { return data_; }

  // Number of points since ranks were judged.
  int unjudged() const { return unjudged_; }
  void set_unjudged(int points) { unjudged_ = points; }

 private:
  PointStatus judge(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  PointStatus match_known_ranks(const Jet& jet, const ArrayLinearization& linearization);
  // True if the constraints and differential equations of the linearization suit the jet that was compared.
  bool serves_at(const Jet& jet, const double* inverse_weights, const ArrayLinearization& linearization) const;
  bool fulfils_algebraic_equations(const Jet& jet, const double* inverse_weights) const;
  // Result of a full analysis at a point.
  enum class Finding { known_values, other_values, unclear };
  Finding analyze(const Jet& jet) const;

  AnalyzedEquations& problem_;
  Arena& arena_;
  int unjudged_ = 0;
  double compared_t_ = std::numeric_limits<double>::quiet_NaN();  // the ranks hold there
  bool has_form_ = false;                                         // form_ has the known ranks
  Jet refined_;
  TaylorData data_, data_before_;  // of the last comparison that evaluated them, and of the one before
  long constant_matrices_ = -1;    // those of data_, as the problem numbers them
  NullSpaceForm form_;
};

}  // namespace sfdae::core
