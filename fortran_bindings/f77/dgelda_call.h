// One call of DGELDA.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "f77/dgelda_problem.h"
#include "f77/integration_call.h"
#include "system/linear_system.h"

namespace sfdae::f77 {

class DgeldaCall final : public IntegrationCall {
 public:
  DgeldaCall(const Arguments& arguments, DgeldaProblem& user) : IntegrationCall(arguments, user), user_(user) {}

 protected:
  void create_problem() override;
  core::Problem& problem() override { return *problem_; }
  core::CheckpointTarget target() override;
  const std::vector<double>& matrices() const override { return user_.matrices(); }
  void analyze(double toward) override;
  void find_values() override;
  void return_to_values() override;
  core::CharacteristicValues local_values(double t) override;

 private:
  core::LinearSystem& system() { return static_cast<core::LinearSystem&>(*system_); }
  void set_differences();

  DgeldaProblem& user_;
  core::AnalysisSettings settings_;
  core::Arena arena_;
  std::optional<core::LinearProblem> problem_;
};

}  // namespace sfdae::f77
