// Jets of a nonlinear problem that satisfy its derivative array F_l = 0, at any t, found from one initial guess of x.
//
// At such a jet (t, x, y) the Taylor coefficients of F_x' and -F_x play the roles of E_k and A_k of a linear problem:
// the Jacobian of F_l is the array [M | -N] of elimination.h, so that index analysis works on it unchanged.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, ch. 4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "problem/coefficient_source.h"
#include "problem/nonlinear_problem.h"
#include "system/jet.h"

namespace sfdae::core {

// Taylor coefficients along consistent jets through a guess, evaluated by the index analysis.
class ConsistentJets final : public CoefficientSource {
 public:
  // fixed: components of x at t that must not change (n flags, or empty).
  ConsistentJets(NonlinearProblem& problem, double t, const double* x, std::vector<char> fixed);

  // Keeps differential variables if possible; sizes: n changes of x that count as one.
  void keep_differentiated(std::vector<double> sizes) { sizes_ = std::move(sizes); }
  // x' at t: the jet there is searched for near it.
  void guess_derivative(const double* xdot);

  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  std::vector<int> differentiations() const override { return problem_.differentiations(); }
  bool is_constant() const override { return false; }
  bool checks_next_level() const override { return true; }
  bool is_along_jet() const override { return true; }
  // Makes the jet at t consistent up to the highest order requested. Throws Failure as JetSolver::solve does.
  CallbackError evaluate(double t, Orders orders, double time_scale, TaylorData& data,
                         RowScaling rows = RowScaling::each,
                         const std::vector<double>* preferred_rows = nullptr) override;
  void set_units(Units units) override { units_ = std::move(units); }
  const Units& units() const { return units_; }

  // The jet at t, consistent up to the level.
  const Jet& jet_at(double t, int level);

 private:
  struct Point {
    Jet jet;
    int level = -1;
    bool is_unshifted = false;  // it started from x at the first point
  };
  Point& point_at(double t);
  // Solves up to the level.
  void solve(Point& point, int level);

  NonlinearProblem& problem_;
  Units units_;
  std::vector<char> fixed_;
  std::vector<double> sizes_;
  std::deque<Point> points_;  // the first one is that of the guess
};

}  // namespace sfdae::core
