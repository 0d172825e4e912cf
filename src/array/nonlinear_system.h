// The strangeness-free system of a nonlinear problem: F_mu(t, x, y) = 0 and Z1^T F(t, x, x') = 0.
//
// All equations are solved by chord iterations. The derivative array is linearized at some jet nearby and eliminated
// once (array_linearization.h); iterations transform residuals only (nonlinear_iteration.h, nonlinear_stages.h).
// Linearizations serve many points; they are renewed where the iteration is slow, with the ranks judged at a point
// that has converged (rank_check.h).
//
// [KM06] P. Kunkel, V. Mehrmann: Differential-Algebraic Equations: Analysis and Numerical Solution. EMS, 2006,
//        ch. 4, 6.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "array/analyzed_equations.h"
#include "array/array_linearization.h"
#include "array/index_zero_step.h"
#include "array/jet_history.h"
#include "array/next_level_jet.h"
#include "array/nonlinear_iteration.h"
#include "array/nonlinear_stages.h"
#include "array/rank_check.h"
#include "linalg/archive.h"
#include "linalg/arena.h"
#include "problem/failure.h"
#include "system/dae_system.h"
#include "system/jet.h"

namespace sfdae::core {

class NonlinearSystem final : public DaeSystem {
 public:
  // jet: consistent up to level mu at analysis.t. Throws Failure.
  NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis, Units units,
                  const Jet& jet);
  // As it was when it was archived. Throws DamagedArchive.
  NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& archive);

  double t() const override { return linearization_.is_complete() ? jet_.t : std::nan(""); }
  // A point consistent up to level mu becomes the current and accepted one; the ranks are judged there.
  PointStatus set_point(const Jet& jet);
  // The same for the last one of two accepted points.
  PointStatus set_points(const Jet& before, const Jet& last);
  // The derivatives of a jet consistent up to level mu become those that level mu + 1 determines, where that is
  // available.
  void complete(Jet& jet);
  // Prescribed components at the current point get their values, others change as little as they must.
  void apply_inputs();
  // The current jet, x = column 0.
  const Jet& jet() const { return jet_; }
  // That of the point accepted last.
  const Jet& accepted_jet() const { return history_.accepted(); }
  const Jet* point_of_equations() const override { return &history_.accepted(); }
  const Units& units() const { return problem_.units(); }
  const AnalysisSettings& settings() const { return problem_.settings(); }
  // What a watch looks at (nonlinear_change_watch.h): the equations and linearizations of the last step, and the jets
  // of its stages, null if it had none but its end.
  AnalyzedEquations& analyzed_equations() { return problem_; }
  const ArrayLinearization& linearization() const { return linearization_; }
  const RankCheck& rank_check() const { return rank_check_; }
  const NonlinearStages* stages() const {
    return stages_.count() > 1 && stages_.last().t == jet_.t ? &stages_ : nullptr;
  }

  // That of level mu + 1 through the current jet, which lives until the system is asked for something else; null where
  // there is none. It does not depend on whether somebody has asked for x' there, which no checkpoint knows.
  const Jet* next_level_jet() {
    next_level_.forget_solution();
    if (!problem_.prescribed().empty() || !next_level_.solve(jet_, jet_.column(0))) return nullptr;
    return &next_level_.jet();
  }

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override { std::copy_n(x, unknowns(), w); }
  PointStatus solve(const StepEquations& equations, double* x) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  // Throws Failure where no consistent x is found near x_free.
  using StrangenessFreeSystem::restore;
  void restore(const double* w, const double* x_free, const Guess& guess, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;
  bool estimate_derivative(const double* x, double* xdot) override {
    return linearization_.is_usable() ? correct_by_linearization(x, xdot) : exact_derivative(x, xdot);
  }

  std::string inconsistency_message() const override;
  PointQuality quality() const override;
  // At the current jet, whatever t is: x is known at points of the integration only, so that a change is located by
  // its steps becoming short.
  CharacteristicValues values_at(double t) override;
  PointStatus check_ranks() override;
  double change_of_differentiated(const double* dx, const double* tolerances) const override {
    if (!linearization_.is_usable()) return std::numeric_limits<double>::infinity();
    return differentiated_change(linearization_.data(), units(), dx, tolerances);
  }
  bool find_differentiated(char* flags) override;
  const double* rounding_errors() const override { return rounding_errors_.data(); }
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double*, const double* xdot, double* wdot) override {
    std::copy_n(xdot, unknowns(), wdot);
  }
  void archive(Archive& archive) override;

 private:
  PointStatus complete_linearization();
  PointStatus renew_at_accepted();
  PointStatus linearize_at_accepted();
  void take_rounding_errors();
  bool is_drowned(const double* inverse_weights) const;
  PointStatus leave_drowned_point(const double* inverse_weights);
  PointStatus judge_rounding_errors(const double* inverse_weights);
  void update_traits();
  void resize();
  void restore_linearization(const RankSequence& ranks, bool has_matrix);
  void restore_anew(const double* inverse_weights);
  bool search_anew(const double* inverse_weights, Jet& begin, Failure& failure);
  PointStatus restore_step_by_step(const Jet& begin);
  bool moves_differentiated(const Jet& jet, const double* inverse_weights) const;
  double distance_from_start(const Jet& jet) const;
  PointStatus restore_with_linearization_at(const Jet& place);
  bool correct_by_linearization(const double* x, double* xdot);
  bool may_hold_derivatives(PointStatus status) const;
  PointStatus iterate_from_guess(const IterationTask& task);
  PointStatus solve_index_zero(const IterationTask& task);
  PointStatus renew_jacobian_at_accepted();
  PointStatus review_index_zero();
  template <class Iterate>
  PointStatus iterate_with_renewal(const double* inverse_weights, const Jet& start, Iterate iterate);
  PointStatus solve_several_stages(const StageEquations& equations);

  AnalyzedEquations problem_;
  Arena arena_;
  Jet jet_;                              // the current one
  Jet start_;                            // of the iteration
  std::vector<double> rounding_errors_;  // of x, at solutions: no step can reduce them
  JetHistory history_;
  ArrayLinearization linearization_{problem_, counts_, arena_};
  NonlinearIteration iteration_{problem_, arena_};
  ResidualMap map_;  // of linearization_, for points within steps
  IndexZeroStep index_zero_{problem_, arena_};
  RankCheck rank_check_{problem_, arena_};
  NonlinearStages stages_{problem_, arena_};
  NextLevelJet next_level_{problem_, arena_};
};

}  // namespace sfdae::core
