// The strangeness-free system of a nonlinear problem: F_mu(t, x, y) = 0 and Z1^T F(t, x, x') = 0.
//
// All equations are solved by chord iterations. The derivative array is linearized at some jet nearby and eliminated
// once (array_linearization.h); iterations transform residuals only (nonlinear_iteration.h, nonlinear_stages.h). A
// linearization is reused for many points; it is renewed when the iteration is slow, with the ranks judged at a
// converged point (rank_check.h).
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
  // Restores an archived system. Throws DamagedArchive.
  NonlinearSystem(NonlinearProblem& problem, const AnalysisSettings& settings, Archive& archive);

  double t() const override { return linearization_.is_complete() ? jet_.t : std::nan(""); }
  // Makes a point consistent up to level mu the current and accepted one; judges the ranks there.
  PointStatus set_point(const Jet& jet);
  // Likewise for the last one of two accepted points.
  PointStatus set_points(const Jet& before, const Jet& last);
  // Sets the derivatives of a jet consistent up to level mu to those that level mu + 1 determines, if available.
  void complete(Jet& jet);
  // Sets prescribed components at the current point to their values; others change as little as possible.
  void apply_inputs();
  // The current jet, x = column 0.
  const Jet& jet() const { return jet_; }
  // The jet of the last accepted point.
  const Jet& accepted_jet() const { return history_.accepted(); }
  const Jet* point_of_equations() const override { return &history_.accepted(); }
  const Units& units() const { return problem_.units(); }
  const AnalysisSettings& settings() const { return problem_.settings(); }
  // For a watch (nonlinear_change_watch.h): the equations and linearizations of the last step, and the jets of its
  // stages, null unless it had several.
  AnalyzedEquations& analyzed_equations() { return problem_; }
  const ArrayLinearization& linearization() const { return linearization_; }
  const RankCheck& rank_check() const { return rank_check_; }
  const NonlinearStages* stages() const {
    return stages_.count() > 1 && stages_.last().t == jet_.t ? &stages_ : nullptr;
  }

  // The jet of level mu + 1 through the current jet, valid until the next call to the system; null if there is none. It
  // does not depend on earlier requests for x' there, which checkpoints do not contain.
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
  // Throws Failure if no consistent x is found near x_free.
  using StrangenessFreeSystem::restore;
  void restore(const double* w, const double* x_free, const Guess& guess, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;
  bool estimate_derivative(const double* x, double* xdot) override {
    return linearization_.is_usable() ? correct_by_linearization(x, xdot) : exact_derivative(x, xdot);
  }

  std::string inconsistency_message() const override;
  PointQuality quality() const override;
  // At the current jet, whatever t is: x is known at points of the integration only; shortened steps locate a change.
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
