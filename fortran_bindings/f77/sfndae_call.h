// One call of SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "array/nonlinear_model.h"
#include "f77/integration_call.h"
#include "f77/sfndae_problem.h"

namespace sfdae::f77 {

class SfndaeCall final : public IntegrationCall {
 public:
  SfndaeCall(const Arguments& arguments, SfndaeProblem& user) : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_model() override;
  core::NonlinearModel& model() override { return *model_; }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;
  int code_of(int status) const override;

 private:
  SfndaeProblem& user_;
  std::optional<core::NonlinearModel> model_;
};

}  // namespace sfdae::f77
