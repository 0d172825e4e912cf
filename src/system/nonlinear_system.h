// The strangeness-free system of a nonlinear problem: F_mu(t, x, y) = 0 and Z1^T F(t, x, x') = 0.
//
// All equations are solved by a chord iteration. The derivative array is linearized at some jet nearby and eliminated
// once; after that every iteration transforms residuals only (stored_elimination.h), solves for the change
// dx = xp + T2 z as for a linear problem (null_space_form.h, W = I), and recovers the change of y. Z1 is that of the
// linearization. Linearizations serve many points; they are renewed where the iteration is slow, with the ranks
// judged at a point that has converged.
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006, ch. 4,
// 6. SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "linalg/archive.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "system/chord_iteration.h"
#include "system/consistent_jets.h"
#include "system/dae_system.h"
#include "system/jet.h"
#include "system/jet_coefficients.h"
#include "system/jet_solver.h"
#include "system/step_matrix.h"

namespace sfdae::core {

class NonlinearSystem final : public DaeSystem {
 public:
  // jet: consistent up to level mu at analysis.t. Throws Failure.
  NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis, Units units,
                  const Jet& jet);
  // As it was when it was archived. Throws DamagedArchive.
  NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& archive);

  NonlinearProblem& problem() { return problem_; }
  double t() const override { return jet_.t; }

  // A point consistent up to level mu becomes the current and accepted one; the ranks are judged there.
  PointStatus set_point(const Jet& jet);
  // Prescribed components at the current point get their values, others change as little as they must.
  void apply_inputs();
  // The current jet, x = column 0.
  const Jet& jet() const { return jet_; }
  const Units& units() const { return units_; }
  const AnalysisSettings& settings() const { return settings_; }

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override { std::copy_n(x, unknowns(), w); }
  PointStatus solve(const StepEquations& equations, double* x) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  // Throws Failure where no consistent x is found near x_free.
  void restore(const double* w, const double* x_free, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;

  PointQuality quality() const override { return {inconsistency_, kept_constraints_, kept_differential_, pivot_}; }
  // At the current jet, whatever t is: x is known at points of the integration only, so that a change is located by
  // its steps becoming short.
  CharacteristicValues values_at(double t) override;
  PointStatus check_ranks() override;
  const double* rounding_errors() const override { return rounding_errors_.data(); }
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double*, const double* xdot, double* wdot) override {
    std::copy_n(xdot, unknowns(), wdot);
  }
  void archive(Archive& archive) override;

 private:
  // Errors of the iteration in units of the tolerance.
  static constexpr double newton_tolerance = 0.01;
  // Relative residuals of redundant equations that call for a second look.
  static constexpr double contradiction = 1e-8;

  // What one iteration does besides the constraints.
  struct Task {
    bool has_step = false;  // Z1^T F(t, x, c x + w_rest) = 0, else dx keeps Z1^T E x
    double c = 0.0;
    const double* w_rest = nullptr;
    const double* x_rest = nullptr;
    const double* inverse_weights = nullptr;
    double tolerance = 0.0;  // of the weighted changes of x
  };
  void update_traits();
  void resize();
  // Linearizes and eliminates at the jet. Known ranks are taken where they are not judged.
  PointStatus renew(const Jet& jet, bool judged);
  // What rounding errors of F do to a change of x and of y, into noise_.
  void measure_noise(const Jet& jet);
  void keep_differential_part();
  // At a jet that has converged to the tolerance of the iteration.
  PointStatus renew_judged(const Jet& jet);
  bool factor_step_matrix(double c);
  // f := the scaled -F_0, ..., -F_mu at the jet.
  PointStatus array_residuals(const Jet& jet, double* f);
  // f(0) of the data := -tau F(t, x, xdot), scaled.
  PointStatus differential_residuals(double t, const double* x, const double* xdot);
  void read_constraints(const Jet& jet, const double* f, double* transformed);
  void apply_change(const double* dx, const double* f, const double* transformed, Jet& jet);
  double change_norm(const Task& task, const double* dx, const Jet& jet) const;
  void step_rhs(const Task& task, const Jet& jet, double* z);
  PointStatus iterate(const Task& task, Jet& jet);
  void read_inconsistency(const Task& task, const Jet& jet);
  PointStatus check_redundant(const Task& task, const Jet& jet);
  bool has_converged(const Task& task, int iteration, double norm, double before);
  bool derivatives_follow(const Jet& jet, int iteration, double residual, double largest) const;
  template <class Iteration>
  PointStatus iterate_with_renewal(const Jet& start, Iteration iteration);
  PointStatus iterate_from_guess(const Task& task);
  PointStatus review(bool renews);
  PointStatus match_known_ranks(const Jet& jet);
  void guess_jet(double t, const Guess& guess, int block, Jet& jet) const;
  void guess_between(const Guess& guess, const double* taylor, Jet& jet) const;
  void interpolate_jet(double t);
  PointStatus iterate_stages(const StageEquations& equations);
  PointStatus read_stages(const StageEquations& equations, View r);
  PointStatus read_stage_inputs(double t);
  void resize_stages(int s);
  PointStatus check_last_stage(int s);
  void correct_differential_part(const double* x, double* xdot);
  bool solve_next_level(const double* x);
  void hold_free_directions(double* xdot);
  void archive_highest_derivative(Archive& archive);

  NonlinearProblem& problem_;
  AnalysisSettings settings_;
  Units units_;
  Arena arena_;

  // The last linearization.
  TaylorData data_;
  StoredElimination elimination_;
  std::vector<char> determined_;  // components of y
  NullSpaceForm form_;
  RankSequence ranks_;
  std::vector<double> preferred_rows_;
  std::vector<double> noise_;  // scaled x, y_1, ..., of the last linearization
  std::vector<double> rounding_errors_;
  int age_ = 0;       // points solved with it
  int unjudged_ = 0;  // points since ranks were judged
  double checked_t_ = std::numeric_limits<double>::quiet_NaN();
  double kept_constraints_ = 1.0, kept_differential_ = 1.0, pivot_ = 1.0;
  StepMatrix matrix_;

  Jet jet_, accepted_, before_;  // the current one, the one accepted last, and the one before that
  Jet polished_;
  Jet linearized_;              // where the linearization is from
  bool is_linearized_ = false;  // successfully
  bool linearized_judged_ = false;
  std::vector<double> linearized_rows_;  // row factors preferred for it
  ChordIteration chord_;
  double inconsistency_ = 0.0;
  std::vector<double> prescribed_values_;
  std::vector<double> F_, array_f_, transformed_f_, change_, y_change_, xdot_, z_;
  Jet start_;
  std::vector<Jet> stages_, stage_starts_;
  std::vector<double> stage_f_, stage_transformed_, stage_xp_, stage_g0_, stage_r_, stage_z_;
  // Of level mu + 1; the highest order may not be available.
  enum class Availability { unknown, no };
  Availability has_next_level_ = Availability::unknown;
  Jet next_jet_;
  TaylorData next_data_;
  StoredElimination next_elimination_;
  NullSpaceForm rank_form_;
  Jet next_trial_;
  std::vector<double> next_transformed_, next_change_;
};

// Linearizes anew at the point accepted last, where ranks can be judged, and if need be at the start of the
// iteration.
template <class Iteration>
PointStatus NonlinearSystem::iterate_with_renewal(const Jet& start, Iteration iteration) {
  PointStatus status = iteration();
  if (status == PointStatus::ok || is_hopeless(status)) return status;
  if (linearized_.t != accepted_.t) {
    chord_.forget_rate();
    status = renew_judged(accepted_);
    if (status == PointStatus::ok) status = iteration();
    if (status == PointStatus::ok || is_hopeless(status)) return status;
  }
  chord_.forget_rate();
  status = renew(start, false);
  return status == PointStatus::ok ? iteration() : status;
}

}  // namespace sfdae::core
