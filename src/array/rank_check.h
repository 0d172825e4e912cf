// When the ranks of a nonlinear system are judged at points that have converged, and linearizations renewed there.
//
// Between these points the known ranks are taken. Ranks hold on F_mu = 0 only: pivots that vanish there are as large
// as the residuals that an iteration has left (docs/design/rank_decisions.md), so that doubtful points are
// iterated to rounding first. In steps and at outputs alike the known ranks hold until the whole analysis says clearly
// that they do not (docs/design/rank_decisions.md).
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

  // The linearization is renewed at the jet, which has converged to the tolerance of the iteration, and its ranks are
  // judged.
  PointStatus renew(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // Whether the known ranks hold at the jet; the linearization stays.
  PointStatus compare(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // A further point has converged: the linearization is renewed there where it has become slow, and now and then.
  PointStatus review(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  // A further point has converged: the known ranks are compared with those there, the linearization stays.
  // not_converged: it does not serve there.
  PointStatus review_by_comparison(const Jet& jet, const double* inverse_weights, ArrayLinearization& linearization,
                                   NonlinearIteration& iteration);

  // For linearizations that are renewed elsewhere. A further point has converged; true where ranks are to be judged.
  bool count_point();
  // The ranks hold at the point that has converged.
  void confirm(ChordIteration& chord) {
    unjudged_ = 0;
    expect_fast(chord);
  }
  // A linearization has been renewed: its rate is not known, but will be small.
  static void expect_fast(ChordIteration& chord);

  // Data and form of the comparison at t, or null where there was none, or none that the form is left of.
  const NullSpaceForm* compared_form(double t) const { return compared_t_ == t && has_form_ ? &form_ : nullptr; }
  const TaylorData& compared_data() const { return data_; }

  // Points since ranks were judged.
  int unjudged() const { return unjudged_; }
  void set_unjudged(int points) { unjudged_ = points; }

 private:
  PointStatus judge(const Jet& jet, ArrayLinearization& linearization, NonlinearIteration& iteration);
  PointStatus match_known_ranks(const Jet& jet, const ArrayLinearization& linearization);
  // Whether constraints and differential equations of the linearization are those of the jet that was compared.
  bool serves_at(const Jet& jet, const double* inverse_weights, const ArrayLinearization& linearization) const;
  bool fulfils_algebraic_equations(const Jet& jet, const double* inverse_weights) const;
  // What the whole analysis says at a point.
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
