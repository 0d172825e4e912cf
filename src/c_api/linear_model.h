// A linear problem as the API sees it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "c_api/model.h"

namespace sfdae::core {

class LinearModel : public Model {
 public:
  explicit LinearModel(const sfdae_linear_problem& problem) : problem_(problem) {}
  Problem& problem() override { return problem_; }
  int m() const override { return problem_.m(); }
  int n() const override { return problem_.n(); }
  bool is_constant() const override { return problem_.is_constant(); }
  LinearProblem* linear() override { return &problem_; }
  void set_differences(const DifferenceOptions& options) override { problem_.set_differences(options); }
  std::unique_ptr<DaeSystem> analyze(const PointOfInterest& point, const SolverOptions& options,
                                     std::vector<RankDecision>& decisions) override;
  std::unique_ptr<DaeSystem> copy_of(const DaeSystem& system, const SolverOptions& options) override;
  Consistent consistent_values(DaeSystem& system, const SolverOptions& options,
                               const PointOfInterest& point) override;
  std::unique_ptr<ChangeDetector> detector(DaeSystem& system) override;
  CheckpointTarget checkpoint_target(const AnalysisSettings& settings) override {
    return linear_target(problem_, settings);
  }
  void count_evaluations(sfdae_statistics& statistics) const override;

 private:
  LinearProblem problem_;
};

}  // namespace sfdae::core
