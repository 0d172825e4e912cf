// Recorded equations with the system of their minimal extension.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "extension/extension_system.h"
#include "system/model.h"

namespace sfdae::core {

class ExtensionModel final : public ModelOf<ExtensionSystem, Model> {
 public:
  // base: its limits and requests to stop apply. Both have to outlive this object.
  ExtensionModel(RecordedProblem& problem, Problem& base) : problem_(problem), base_(base) {}

  Problem& problem() override { return base_; }
  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  bool is_constant() const override { return false; }
  bool needs_x() const override { return true; }
  EvaluationCounts evaluations() const override {
    return {.F = problem_.evaluations(), .linearizations = problem_.linearizations()};
  }
  TaylorEvaluator* evaluator() override { return &problem_.evaluator(); }
  void analyze(const PointOfInterest& point, const ModelOptions& options,
               std::vector<RankDecision>& decisions) override;
  // Distance of the blocks of the system Jacobian, which have been judged, from singular ones.
  double certify() override { return system_->structure().smallest_kept(); }

  // Null if equations are replaced.
  std::unique_ptr<SensitivitySystem> sensitivities(std::vector<int> parameters) override;
  bool has_sensitivities() const;

  std::optional<Extension> extension() override;
  std::unique_ptr<ChangeWatch> change_watch() override;

  Jet accepted_point() const override;
  const Jet& accepted_jet() const { return system_->accepted_jet(); }

 protected:
  std::unique_ptr<ExtensionSystem> copy_of_system() override;
  std::unique_ptr<ExtensionSystem> archived_system(const ModelOptions& options, Archive& archive) override;
  ConsistentPoint make_consistent(ExtensionSystem& system, const PointOfInterest& point,
                                  const ModelOptions& options) override;

 private:
  MinimalExtension extension_near(const PointOfInterest& point, const std::vector<double>& sizes);

  RecordedProblem& problem_;
  Problem& base_;
  // The x near which the analysis found its jet; empty if none was made.
  std::vector<double> guess_;
};

}  // namespace sfdae::core
