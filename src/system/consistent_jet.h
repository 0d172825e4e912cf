// Jets of a nonlinear problem that fulfil its derivative array F_l = 0, found from a guess of x.
//
// At such a jet (t, x, y) the Taylor coefficients of F_x' and -F_x play the roles of E_k and A_k of a linear problem:
// the Jacobian of F_l is the array [M | -N] of elimination.h, so that index analysis works on it unchanged.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, ch. 4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include "linalg/arena.h"
#include "problem/coefficient_source.h"
#include "problem/nonlinear_problem.h"
#include "reduction/judge.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"

namespace sfdae::core {

// x_k, k = 0..order, at t.
struct Jet {
  double t = 0.0;
  int n = 0, order = 0;
  std::vector<double> x;  // n x (order + 1)
  double* column(int k) { return x.data() + static_cast<std::ptrdiff_t>(k) * n; }
  const double* column(int k) const { return x.data() + static_cast<std::ptrdiff_t>(k) * n; }
  // Coefficients above the order become 0.
  void set_order(int new_order);
  // The same polynomial around t + h.
  void shift(double h);
};

// Gauss-Newton for F_l = 0 in (x, y), damped where it has to be [Levenberg and Marquardt], with a small change of x.
class JetSolver {
 public:
  JetSolver(NonlinearProblem& problem, const Units& units) : problem_(problem), units_(units) {}

  // Components of x that must not change (n flags, or empty).
  void set_fixed(std::vector<char> fixed) { fixed_ = std::move(fixed); }
  // Makes the jet, of order level + 1 at least, fulfil F_level = 0 as well as rounding permits. Throws Failure:
  // errors of callbacks, SFDAE_NO_CONSISTENT_VALUES.
  void solve(Jet& jet, int level);

 private:
  struct Trial {
    Jet jet;
    double norm = 0.0;
    bool valid = false;
  };

  void linearize(const Jet& jet, int level, double time_scale);
  // 2-norm of the residuals as scaled by the present data; infinite where F cannot be evaluated.
  double residual_norm(const Jet& jet, int level);
  Trial try_change(const Jet& jet, int level, const std::vector<double>& change);
  double residual_noise(int level) const;
  Trial undamped_trial(const Jet& jet, int level);
  void find(Jet& jet, int level);
  bool solve_for_derivatives(Jet& jet, int level);
  bool solve_for_algebraic(Jet& jet, int level);
  void recover_derivatives(int level, std::vector<double>& change);
  void search(Jet& jet, int level, bool may_run_freely);
  bool run_freely(Jet& jet, int level, Trial trial);
  bool staged_change(const Jet& jet, int level, NoiseModel model, double noise, std::vector<double>& change);
  bool damped_change(const Jet& jet, int level, double damping, std::vector<double>& change);
  bool dense_change(const Jet& jet, int level, double most_dropped, std::vector<double>& change);
  std::vector<double> unit_changes(const Jet& jet, int level) const;
  // Residuals relative to what was added up in them.
  bool is_converged(const Jet& jet, int level, double tolerance) const;
  [[noreturn]] void give_up(const Jet& jet, int level);

  NonlinearProblem& problem_;
  const Units& units_;
  std::vector<char> fixed_;
  TaylorData data_;
  double norm_ = 0.0;  // of the residuals in data_
  std::vector<double> residuals_;
  StoredElimination stored_;
  NullSpaceForm form_;
  Arena arena_;
};

// Taylor coefficients along one jet as it is.
class JetCoefficients final : public CoefficientSource {
 public:
  JetCoefficients(NonlinearProblem& problem, const Jet& jet, const Units& units)
      : problem_(problem), jet_(jet), units_(units) {}
  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  std::vector<int> differentiations() const override { return problem_.differentiations(); }
  bool is_constant() const override { return false; }
  CallbackError evaluate(double, Orders orders, double time_scale, TaylorData& data,
                         RowScaling rows = RowScaling::each,
                         const std::vector<double>* preferred_rows = nullptr) override {
    return problem_.linearize(jet_.t, jet_.x.data(), orders, {time_scale, rows, preferred_rows, &units_}, data);
  }
  void set_units(Units units) override { units_ = std::move(units); }

 private:
  NonlinearProblem& problem_;
  const Jet& jet_;
  Units units_;
};

// Taylor coefficients along consistent jets through a guess: what the index analysis reads.
class ConsistentJets final : public CoefficientSource {
 public:
  ConsistentJets(NonlinearProblem& problem, double t, const double* x, std::vector<char> fixed);

  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  std::vector<int> differentiations() const override { return problem_.differentiations(); }
  bool is_constant() const override { return false; }
  bool checks_next_level() const override { return true; }
  // The jet at t becomes consistent up to the highest order asked for. Throws Failure as JetSolver::solve does.
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
  };
  Point& point_at(double t);

  NonlinearProblem& problem_;
  Units units_;
  std::vector<char> fixed_;
  std::deque<Point> points_;  // the first one is that of the guess
};

}  // namespace sfdae::core
