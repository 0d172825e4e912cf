// The constraints of a nonlinear problem, linearized at a jet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "problem/nonlinear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "starts/consistent_values.h"
#include "system/jet.h"

namespace sfdae::core {

class LinearizedConstraints {
 public:
  struct Known {
    const IndexAnalysis& analysis;
    const Units& units;
    double rank_tol;
  };
  LinearizedConstraints(NonlinearProblem& problem, const Known& known)
      : problem_(problem), analysis_(known.analysis), units_(known.units), rank_tol_(known.rank_tol) {}

  // Throws Failure: errors of callbacks.
  void linearize(const Jet& jet);
  // The constraints for changes of the jet.
  ConstrainedPoint point() const {
    return {form_, data_, units_, rank_E_, kept_, follows_inputs_ ? &problem_.prescribed() : nullptr};
  }
  // Moves prescribed components to the values in the target.
  void follow_inputs() { follows_inputs_ = !problem_.prescribed().empty(); }
  bool has_known_ranks() const { return has_known_ranks_; }

  // Moves the jet by the change that brings x nearest to the target within the linearized constraints. Returns its
  // size relative to x.
  double move(const ConsistencyRequest& request, const std::vector<double>& target, Jet& jet);
  // Moves it by a change of x within them. Returns its size relative to x.
  double move_by(std::vector<double> dx, Jet& jet);

  // A change of x within the constraints with other right-hand sides, (mu + 1) m x count, all scaled; the last one is
  // that of the point afterwards. sizes: moves of x in each column, the reference of rounding errors. False if
  // redundant equations contradict each other.
  bool find_particular(ConstView f, const double* sizes, View dx);

  // The least change of x that fulfils the linearized constraints.
  std::vector<double> violation() const;
  // Sum of the terms in the constraints of x_i, in units of x_i.
  double size_beside(int i, const Jet& jet) const;
  // The largest component in the units of the equations.
  double size_of(const Jet& jet) const;

 private:
  NonlinearProblem& problem_;
  const IndexAnalysis& analysis_;
  const Units& units_;
  double rank_tol_;
  TaylorData data_;
  NullSpaceForm form_;
  StoredElimination elimination_;
  Arena arena_;
  int rank_E_ = 0;
  double kept_ = 1.0;
  bool has_known_ranks_ = true, follows_inputs_ = false;
};

// The given values, with prescribed components from the user's function at t.
std::vector<double> with_inputs(NonlinearProblem& problem, double t, const std::vector<double>& given);

}  // namespace sfdae::core
