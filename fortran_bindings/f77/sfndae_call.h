// One call of SFNDAE or SFNDAF.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "array/nonlinear_model.h"
#include "f77/integration_call.h"
#include "f77/nonlinear_user_problem.h"

namespace sfdae::f77 {

// IERR: the derivative array of SFNDAF contradicts itself.
inline constexpr int wrong_array = -28;

class SfndaeCall final : public IntegrationCall {
 public:
  SfndaeCall(const Arguments& arguments, NonlinearUserProblem& user)
      : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_model() override;
  core::NonlinearModel& model() override { return *model_; }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;
  int code_of(int status) const override;

 private:
  NonlinearUserProblem& user_;
  std::optional<core::NonlinearModel> model_;
};

}  // namespace sfdae::f77
