// Sensitivities of a nonlinear problem: linear equations along the jets of its system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/nonlinear_system.h"
#include "linalg/arena.h"
#include "problem/parameter_series.h"
#include "sensitivity/extended_sensitivity_step.h"
#include "sensitivity/extended_stage_lanes.h"
#include "sensitivity/sensitivity_point.h"
#include "sensitivity/sensitivity_stages.h"
#include "sensitivity/sparse_sensitivity_stages.h"
#include "sensitivity/sparse_sensitivity_step.h"
#include "system/sensitivity_system.h"

namespace sfdae::core {

class NonlinearSensitivities final : public SensitivitySystem {
 public:
  // parameters: as for ParameterSeries. The system and the problem must outlive this object. No components are free or
  // prescribed.
  NonlinearSensitivities(NonlinearSystem& system, RecordedProblem& problem, std::vector<int> parameters);

  int unknowns() const override { return system_.unknowns(); }
  const std::vector<int>& parameters() const override { return numbers_; }
  void parameters_changed() override { parameters_.take_parameters(); }
  PointStatus solve_step(double c, const double* rest, const double* xdot, double* S) override;
  PointStatus keep_stage_of_step(const StageMethod& method, int i, const double* xdot) override;
  PointStatus keep_stage(const StageMethod& method, int i, const double* xdot) override {
    return keep(method, i, system_.jet(), xdot);
  }
  PointStatus solve_kept_stages(const StageMethod& method, double h, const double* S_start, double* S) override;
  PointStatus restore(const double* guess, double* S) override;
  void error_in_S(const double* errors, double* mapped) override;
  PointStatus derivative(const double* S, double* Sdot) override;
  void start(const ConsistencyRequest& request, const double* directions, double* S) override;
  std::unique_ptr<AdjointSystem> adjoint() override;
  double inconsistency() const override { return point_.inconsistency(); }
  const CallbackError& callback_error() const override { return callback_error_; }
  SensitivityCounts counts() const override { return {linearizations_, factorizations_}; }
  void archive(Archive& archive) override;

 private:
  PointStatus linearize(const Jet& jet, const double* xdot);
  // Linearizes at the current point of the system, unless that is the last linearization.
  PointStatus linearize_here();
  // Uses the minimal extension if possible.
  PointStatus linearize_stage(const Jet& jet, const double* xdot);
  PointStatus keep(const StageMethod& method, int i, const Jet& jet, const double* xdot);
  PointStatus keep_one(const StageMethod& method, int i, const Jet& jet, const double* xdot);
  PointStatus linearize_side_by_side(const StageMethod& method);
  bool derivative_of_ordinary(const double* S, double* Sdot);
  bool derivative_from_array(const double* S, double* Sdot);
  void correct_slopes(const double* S, double* Sdot);
  void archive_factors(Archive& archive);
  // n x count, between the user's units and those of the equations.
  View scaled(const double* S);
  void to_user(ConstView S, double* to) const;

  NonlinearSystem& system_;
  RecordedProblem& problem_;
  std::vector<int> numbers_;  // of the parameters
  ParameterSeries parameters_;
  Arena arena_;
  SensitivityPoint point_;
  bool is_point_here_ = false;  // the equations of the point are those of the system's
  SparseSensitivityStep sparse_step_;
  ExtendedSensitivityStep extended_step_;
  SensitivityStages stages_;
  SparseSensitivityStages sparse_stages_;
  ExtendedStageLanes stage_lanes_;
  bool has_stages_ = false;  // stages_ are those solved for last
  enum class StagesKept { each, sparse, side_by_side } kept_ = StagesKept::each;
  // K z = r of an ordinary point, r in z before: with the stored factors if these converge, else with those of K.
  bool solve_ordinary(ConstView K, View z, ConstView guess);
  struct Factors {
    Matrix matrix;
    std::vector<int> pivots;
    bool are_kept = false;  // of an ordinary point
  } factors_;
  // The array of level mu + 1, for S'.
  struct NextLevel {
    TaylorData data;
    StoredElimination elimination;
    NullSpaceForm form;
    Matrix f;
  } next_;
  long linearizations_ = 0, factorizations_ = 0;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
