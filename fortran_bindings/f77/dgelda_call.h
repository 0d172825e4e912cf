// One call of DGELDA.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "f77/dgelda_problem.h"
#include "f77/integration_call.h"
#include "linear/linear_model.h"

namespace sfdae::f77 {

class DgeldaCall final : public IntegrationCall {
 public:
  DgeldaCall(const Arguments& arguments, DgeldaProblem& user) : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_model() override;
  core::LinearModel& model() override { return *model_; }
  const double* kept_matrices() const override { return user_.matrices().data(); }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;

 private:
  void set_differences();

  DgeldaProblem& user_;
  std::optional<core::LinearModel> model_;
};

}  // namespace sfdae::f77
