// Gauss-Newton method for F_l = 0 in (x, y), damped if necessary [Levenberg and Marquardt], with a small change of x.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "starts/jet_equations.h"
#include "system/jet.h"

namespace sfdae::core {

class JetSolver {
 public:
  // units: have to outlive this object.
  JetSolver(NonlinearProblem& problem, const Units& units) : equations_(problem, units) {}
  JetSolver(NonlinearProblem& problem, Units&& units) = delete;

  // Components of x that must not change (n flags, or empty).
  void set_fixed(std::vector<char> fixed) { equations_.set_fixed(std::move(fixed)); }
  // Keeps differential variables if possible. sizes: n changes of x that count as one.
  void keep_differentiated(std::vector<double> sizes) { equations_.keep_differentiated(std::move(sizes)); }
  // Makes the jet, of order level + 1 at least, satisfy F_level = 0 to machine precision. Throws Failure: errors of
  // callbacks, SFDAE_NO_CONSISTENT_VALUES.
  void solve(Jet& jet, int level);

 private:
  using Trial = JetEquations::Trial;

  void find(Jet& jet, int level);
  bool solve_for_derivatives(Jet& jet, int level);
  bool solve_for_algebraic(Jet& jet, int level);
  bool has_moved_far(const Jet& from, const Jet& to) const;
  bool stays_near(Jet& jet, int level);
  // may_grow: residuals may grow during a few undamped steps.
  void search(Jet& jet, int level, bool may_grow);
  bool accept(Jet& jet, Trial&& trial, int level);
  bool search_undamped(Jet& jet, int level, Trial trial, double too_far);
  Trial undamped_trial(const Jet& jet, Trial* of_most_ranks = nullptr);
  Trial shortened_trial(const Jet& jet);
  Trial damped_trial(const Jet& jet, double& damping);

  JetEquations equations_;
};

}  // namespace sfdae::core
