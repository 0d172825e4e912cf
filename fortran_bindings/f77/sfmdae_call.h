// One call of SFMDAE.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "f77/integration_call.h"
#include "f77/sfmdae_problem.h"
#include "multibody/multibody_model.h"

namespace sfdae::f77 {

class SfmdaeCall final : public IntegrationCall {
 public:
  SfmdaeCall(const Arguments& arguments, SfmdaeProblem& user) : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_model() override;
  core::MultibodyModel& model() override { return *model_; }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;
  int code_of(int status) const override;

 private:
  void publish_wrong_derivative(const core::DerivativeMismatch& wrong) const;

  SfmdaeProblem& user_;
  std::optional<core::MultibodyModel> model_;
};

}  // namespace sfdae::f77
