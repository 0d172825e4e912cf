// A mechanical system with constraints, with its strangeness-free system.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "multibody/multibody_callbacks.h"
#include "multibody/multibody_recorded.h"
#include "multibody/multibody_system.h"
#include "multibody/multibody_theory.h"
#include "system/model.h"

namespace sfdae::core {

// The initial positions, velocities and forces of constraints to be made consistent.
struct GivenMotion {
  const ConsistencyRequest& request;
  double t;
  const std::vector<double>& x;
};
// Reports the changes of given values. Changes beyond tolerances are refused for InitialValues::accept, which otherwise
// keeps the given values. found: consistent. Throws Failure.
void report_change_of_motion(const MultibodySizes& sizes, const GivenMotion& given, ConsistentPoint& found);

// Properties of the constraints at the point reached.
struct ConstraintsReport {
  double t = 0.0;
  int holonomic = 0, nonholonomic = 0, redundant = 0;
  int degrees_of_freedom = 0, position_freedom = 0;
  double condition = 1.0;
  long partitions = 0;  // 0 with sparse matrices, which need none
  double position_residual = 0.0, velocity_residual = 0.0;
};

class MultibodyModel final : public ModelOf<MultibodySystem> {
 public:
  MultibodyModel(std::unique_ptr<RecordedMultibody> problem, Coordinates coordinates)
      : recorded_(problem.get()), problem_(std::move(problem)), coordinates_(coordinates) {}
  MultibodyModel(std::unique_ptr<CallbackMultibody> problem, Coordinates coordinates)
      : callbacks_(problem.get()), problem_(std::move(problem)), coordinates_(coordinates) {}

  // A copy of recorded formulas; null for functions.
  std::unique_ptr<MultibodyModel> clone() const {
    if (recorded_ == nullptr) return nullptr;
    return std::make_unique<MultibodyModel>(std::make_unique<RecordedMultibody>(*recorded_), coordinates_);
  }

  MultibodyProblem& problem() override { return *problem_; }
  int m() const override { return n(); }
  int n() const override { return problem_->sizes().unknowns(); }
  bool is_constant() const override { return false; }
  bool needs_x() const override { return true; }
  EvaluationCounts evaluations() const override {
    return {.F = problem_->evaluations(), .linearizations = problem_->linearizations()};
  }
  TaylorEvaluator* evaluator() override { return problem_->evaluator(); }
  std::vector<const TaylorEvaluator*> evaluators_of_inputs() override { return problem_->evaluators_of_inputs(); }
  void add_equations(WordHash& hash) override;
  void parameters_changed() override {
    problem_->parameters_changed();
    first_order_.reset();
  }
  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  Jump jump(const PointOfInterest& point, const ModelOptions& options) override { return impact(point, options, {}); }
  // With coefficients of restitution, empty or one for each constraint: if one is not 0, forces of constraints are 0
  // afterwards, as it is not known which constraints hold. Throws Failure.
  Jump impact(const PointOfInterest& point, const ModelOptions& options, const std::vector<double>& restitution);
  bool is_recorded() const { return recorded_ != nullptr; }
  // Parameters of the user's, for recorded formulas.
  int num_parameters() const { return recorded_->num_parameters(); }
  // The user's functions; null for recorded formulas.
  CallbackMultibody* callbacks() { return callbacks_; }
  // Certifies the point accepted last, after an analysis.
  double certify() override;
  ConstraintsReport constraints() const;

  // Objects of the first-order equations of multibody_theory.h. Arrays and jets of level 1 and above, Z2 and Z3 require
  // recorded formulas.
  Jet jet_through(double t, const double* x, int level) override;
  DerivativeArray derivative_array(const Jet& jet, int level) override;
  Projectors projectors(const Jet& jet, bool of_array) override;
  StrangenessFreeEquations strangeness_free(const Jet& jet) override;
  int level_of_jets(bool of_array) override { return of_array ? system_->analysis().values.mu : 0; }
  Jet accepted_point() const override;
  // A copy of the recorded first-order equations, with the values that parameters have now; null for functions.
  std::unique_ptr<RecordedProblem> recorded_first_order_problem() {
    return recorded_ != nullptr ? recorded_->first_order_problem() : nullptr;
  }
  std::shared_ptr<const Record> first_order_record() const {
    return recorded_ != nullptr ? recorded_->first_order_record() : nullptr;
  }
  // Throws Failure.
  ExtendedSystem extended_system(double t, const double* x);

 protected:
  std::unique_ptr<MultibodySystem> copy_of_system() override;
  std::unique_ptr<MultibodySystem> archived_system(const ModelOptions& options, Archive& archive) override;
  ConsistentPoint make_consistent(MultibodySystem& system, const PointOfInterest& point,
                                  const ModelOptions& options) override;

 private:
  MultibodySettings settings(const MultibodyRanks& ranks, const AnalysisSettings& analysis) const {
    return {ranks, coordinates_, analysis.rank_tol};
  }
  void keep_fixed(const ConsistencyRequest& request, const PointOfInterest& given, std::vector<double>& x) const;

  MultibodyTheory theory_at(double t, const double* x) { return {*problem_, system_->settings(), t, x}; }
  RecordedProblem& first_order_problem();

  CallbackMultibody* callbacks_ = nullptr;
  RecordedMultibody* recorded_ = nullptr;
  std::unique_ptr<MultibodyProblem> problem_;
  Coordinates coordinates_;
  std::unique_ptr<RecordedProblem> first_order_;  // once it has been asked for
  std::optional<WordHash> equations_;             // once they have been hashed
};

}  // namespace sfdae::core
