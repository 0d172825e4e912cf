// One call of SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "c_api/model.h"
#include "f77/integration_call.h"
#include "f77/sfndae_problem.h"

namespace sfdae::f77 {

class SfndaeCall final : public IntegrationCall {
 public:
  SfndaeCall(const Arguments& arguments, SfndaeProblem& user) : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_problem() override;
  core::Problem& problem() override { return model_->problem(); }
  core::CheckpointTarget target() override { return model_->checkpoint_target(solver_options_->analysis); }
  const std::vector<double>& matrices() const override { return no_matrices_; }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;
  core::CharacteristicValues local_values(double t) override;
  int code_of(int status) const override;

 private:
  SfndaeProblem& user_;
  std::vector<double> no_matrices_;
  std::unique_ptr<core::Model> model_;
  std::optional<core::SolverOptions> solver_options_;
};

}  // namespace sfdae::f77
