// Recorded equations that are solved by their minimal extension where structure and size suggest it and numbers confirm
// the structure, and by the derivative array elsewhere.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "extension/formulated_model.h"

namespace sfdae::core {

class StructuredModel final : public FormulatedModel {
 public:
  // classical: the same equations, by the whole array, recorded ones or functions with patterns. problem: these as
  // nonlinear equations; `owned` if that is another object than the one of the classical model, else null.
  StructuredModel(std::unique_ptr<Model> classical, RecordedProblem& problem, std::unique_ptr<RecordedProblem> owned)
      : FormulatedModel(std::move(classical)), problem_(problem) {
    set_equations(problem, std::move(owned));
  }

  bool has_structure() const override { return true; }
  TaylorEvaluator* structure_evaluator() override { return &problem_.evaluator(); }
  void demand_derivatives(const PointOfInterest& point, const ModelOptions& options) override;
  void restore(const ModelOptions& options, Archive& archive) override;
  bool differentiate_jump(const MovingJump& moving, const ModelOptions& options, View after) override;
  Jet accepted_point() const override;

 private:
  bool requires_extension(const ModelOptions& options) override;
  bool may_extend(const ModelOptions& options) override;
  bool is_extended_first(const PointOfInterest& point, const ModelOptions& options) override;
  bool is_in_doubt(const Failure& failure, const PointOfInterest& point, const ModelOptions& options) override;
  bool are_others_possible() const override;
  // Linear equations as nonlinear ones.
  bool has_array_for_sensitivities() const override { return owns_equations(); }
  bool has_archived_extension(bool) override { return problem_.structure() != nullptr; }
  std::unique_ptr<RecordedProblem> equations_of_array() override;
  void analyze_as(Formulation formulation, const PointOfInterest& point, const ModelOptions& options,
                  std::vector<RankDecision>& decisions) override;
  // The whole array is analyzed where that has not been done. Throws Failure where it is too large, and the second
  // where it has other characteristic values than those in use.
  Model& whole() override;
  Model& same_whole() override;

  bool units_are_apart(const PointOfInterest& point, const ModelOptions& options, double distance);
  bool orders_are_possible() const;
  // Jacobians by differences have nothing else to be solved by.
  bool has_differences() const { return problem_.source() != nullptr && problem_.source()->has_differences(); }
  void demand_structure(const ModelOptions& options) const;
  // By an upper bound of its columns.
  bool is_array_large() const;

  RecordedProblem& problem_;
};

}  // namespace sfdae::core
