// Gauss-Newton for F_l = 0 in (x, y), damped where it has to be [Levenberg and Marquardt], with a small change of x.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "starts/jet_equations.h"
#include "system/jet.h"

namespace sfdae::core {

class JetSolver {
 public:
  // units: have to live as long as this does.
  JetSolver(NonlinearProblem& problem, const Units& units) : equations_(problem, units) {}
  JetSolver(NonlinearProblem& problem, Units&& units) = delete;

  // Components of x that must not change (n flags, or empty).
  void set_fixed(std::vector<char> fixed) { equations_.set_fixed(std::move(fixed)); }
  // What is differentiated stays if it can. sizes: of changes of x that count as one, n of them.
  void keep_differentiated(std::vector<double> sizes) { equations_.keep_differentiated(std::move(sizes)); }
  // Makes the jet, of order level + 1 at least, fulfil F_level = 0 as well as rounding permits. Throws Failure:
  // errors of callbacks, SFDAE_NO_CONSISTENT_VALUES.
  void solve(Jet& jet, int level);

 private:
  using Trial = JetEquations::Trial;

  void find(Jet& jet, int level);
  bool solve_for_derivatives(Jet& jet, int level);
  bool solve_for_algebraic(Jet& jet, int level);
  bool has_moved_far(const Jet& from, const Jet& to) const;
  bool stays_near(Jet& jet, int level);
  // may_grow: residuals may do so during a few undamped steps.
  void search(Jet& jet, int level, bool may_grow);
  bool accept(Jet& jet, Trial&& trial, int level);
  bool search_undamped(Jet& jet, int level, Trial trial, double too_far);
  Trial undamped_trial(const Jet& jet, Trial* of_most_ranks = nullptr);
  Trial shortened_trial(const Jet& jet);
  Trial damped_trial(const Jet& jet, double& damping);

  JetEquations equations_;
};

}  // namespace sfdae::core
