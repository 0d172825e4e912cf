// One call of DGELDA or SFNDAE: initial values, or a step or more of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "f77/call_options.h"
#include "f77/call_state.h"
#include "f77/user_problem.h"
#include "integrate/integration.h"
#include "system/model.h"

namespace sfdae::f77 {

inline constexpr int functions_failed = -10;

class IntegrationCall {
 public:
  IntegrationCall(const IntegrationCall&) = delete;
  IntegrationCall& operator=(const IntegrationCall&) = delete;
  virtual ~IntegrationCall() = default;

  // Does all that the call asks for except writing INFO(1) and IERR; returns IERR.
  int run() noexcept;

 protected:
  // Decides which code a failure has.
  enum class Stage { structure, values, slopes, integration };

  IntegrationCall(const Arguments& arguments, UserProblem& user);

  // Once the options and what is known from earlier calls have been read.
  virtual void create_model() = 0;
  virtual core::Model& model() = 0;
  // E and A where they are constant.
  virtual const double* kept_matrices() const { return nullptr; }
  // Characteristic values at t_, near x_. Throws core::Failure, as all that follow.
  virtual void analyze(double toward) = 0;
  // Makes x_ consistent as INFO says; x' into xdot_. The system stands there afterwards.
  virtual void find_values() = 0;
  // The system is moved to x_, which was consistent when it was returned.
  virtual void return_to_values() = 0;
  virtual int code_of(int status) const;

  [[noreturn]] void stop_for_values(Stage stage);
  core::AnalysisSettings settings() const;

  core::DaeSystem& system() { return *model().system(); }

  const Arguments& arguments_;
  CallState state_;
  Options options_;
  core::ModelOptions model_options_;
  Progress progress_;
  Stage stage_ = Stage::structure;
  double t_;
  std::vector<double> x_, xdot_;

 private:
  int run_to_code() noexcept;
  int dispatch();
  bool has_other_width();
  int first_call();
  int start_later();
  int go_on();
  int start_integration();
  int advance();
  bool has_passed_tout(double t) const;

  void find_initial_point(double direction);
  void analyze_toward(double toward);
  double hinted_direction() const;
  void begin_interval(double toward);
  void limit_evaluations();
  core::IntegrationOptions options_of_integration();

  core::CharacteristicValues new_values();
  bool is_failure_taken_for_change(int status);
  static int watch_weights(const sfdae_progress* progress, void* user);

  UserProblem& user_;
  std::unique_ptr<core::Integration> integration_;
};

}  // namespace sfdae::f77
