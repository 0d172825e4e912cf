// The strangeness-free system of a linear problem, recomputed at every point.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "linalg/archive.h"
#include "linear/change_trace.h"
#include "linear/linear_point.h"
#include "linear/linear_reduction.h"
#include "linear/linear_stages.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"
#include "system/dae_system.h"
#include "system/step_matrix.h"

namespace sfdae::core {

class LinearSystem final : public DaeSystem {
 public:
  // The analysis holds from here on. Chooses the leading term; throws Failure if the prescribed components do not fit
  // or E'(t) is needed and missing.
  LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, IndexAnalysis analysis, LeadingTerm leading);
  // Restores the archived state, except that it has no current point until moved to one. Throws DamagedArchive.
  LinearSystem(LinearProblem& problem, const AnalysisSettings& settings, Archive& archive);

  PointStatus move_to(double t) override;
  void accept() override;
  void leading(const double* x, double* w) override;
  PointStatus solve(const StepEquations& equations, double* x) override;
  PointStatus solve_stages(const StageEquations& equations, double* x, double* w, double& t_reached) override;
  using StrangenessFreeSystem::error_in_x;
  void error_in_x(const double* dw, int count, double* dx) override;
  using StrangenessFreeSystem::restore;
  void restore(const double* w, const double* x_free, const Guess& guess, double* x) override;
  void correct_derivative(double c, const double* x, double* xdot) override;

  // W = E (or I if E' is missing) from now on: rank E is not constant.
  void give_up_projector() override;
  LinearProblem& problem() { return problem_; }
  std::string inconsistency_message() const override;
  // " It is equations 0 and 2 that cannot hold together.", at the current point, with the flagged components of x fixed
  // (n flags, or none). Empty if there is no contradiction, or it is not known.
  std::string named_contradiction(const std::vector<char>& fixed, const double* x) const;
  const AnalysisSettings& settings() const { return settings_; }
  Arena& arena() { return arena_; }
  LinearReduction& reduction() { return reduction_; }

  // The point moved to last.
  const LinearPoint& point() const { return points_.current(); }
  double t() const override { return point().t; }
  PointQuality quality() const override;
  CharacteristicValues values_at(double t) override;
  // False if the sign of det[E1; A2] changed from the point accepted last to the current one; true if it is not defined
  // (u > 0).
  bool orientation_kept();
  // Traces of the stages of the last step, if it had any.
  const StageTraces& stage_traces() const { return traces_; }
  // After moves elsewhere: t, the point accepted last, becomes the current one again. Throws Failure.
  void return_to_accepted(double t);
  void archive(Archive& archive) override;

  // Without an available derivative, the constraints are differentiated by finite differences.
  bool consistent_derivative(const double* x, double direction, double* xdot) override;
  bool exact_derivative(const double* x, double* xdot) override;
  void leading_derivative(const double* x, const double* xdot, double* wdot) override;
  double change_of_differentiated(const double* dx, const double* tolerances) const override {
    return differentiated_change(point().data, problem_.units(), dx, tolerances);
  }
  bool find_differentiated(char* flags) override {
    mark_differentiated(point().data, flags);
    return true;
  }
  bool has_difference_errors() const override { return point().data.has_errors(); }
  void difference_errors(const double* x, double* errors) override;

 private:
  void resize();
  bool has_derivative_of_E();
  // Strong exception guarantee.
  void choose_leading_term(LeadingTerm wanted);
  KnownForm known() const { return {analysis_, leading_, needs_E1_}; }
  bool factor_step_matrix(double c);
  // Scaled x and x'.
  void correct_scaled_derivative(double c, const double* x, double* xdot);

  LinearProblem& problem_;
  AnalysisSettings settings_;
  Arena arena_;
  bool needs_E1_ = false;  // W varies with E
  LinearPoints points_;
  LinearReduction reduction_;
  StepMatrix matrix_;  // for constant problems it is reused as long as c stays
  LinearStages stages_;
  StageTraces traces_;
  TaylorData next_level_;  // of level mu + 1, for x'
};

}  // namespace sfdae::core
