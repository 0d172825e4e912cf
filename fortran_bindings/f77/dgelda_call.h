// One call of DGELDA: initial values, or a step or more of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "f77/dgelda_options.h"
#include "f77/dgelda_problem.h"
#include "f77/dgelda_state.h"
#include "integrate/integration.h"

namespace sfdae::f77 {

class DgeldaCall {
 public:
  DgeldaCall(const Arguments& arguments, DgeldaProblem& user);

  // Does all that the call asks for except writing INFO(1) and IERR; returns IERR.
  int run() noexcept;

 private:
  // Decides which code a failure has.
  enum class Stage { structure, values, slopes, integration };

  int dispatch();
  int first_call();
  int start_later();
  int go_on();
  int start_integration();
  int advance();
  bool has_passed_tout(double t) const;

  void find_initial_point(double direction);
  void prepare(double toward);
  void analyze(double toward);
  void move_system();
  void find_values();
  double hinted_direction() const;
  double default_toward(double direction) const;
  core::AnalysisSettings settings() const;
  void begin_interval(double toward);
  void limit_evaluations();
  core::IntegrationOptions options_of_integration();

  int code_of(int status) const;
  void enlarge_tolerances();
  int finish_step(const core::CallResult& result, double t);
  bool has_zero_weight(const double* x) const;
  static int watch_weights(const sfdae_progress* progress, void* user);
  void publish_values() const;
  void publish_characteristics(const core::CharacteristicValues& values) const;
  void publish_counts(long points) const;

  const Arguments& arguments_;
  DgeldaProblem& user_;
  DgeldaState state_;
  Options options_;
  Progress progress_;
  Stage stage_ = Stage::structure;
  double t_;
  std::vector<double> x_, xdot_;
  core::Arena arena_;
  std::optional<core::LinearProblem> problem_;
  std::unique_ptr<core::LinearSystem> system_;
  std::unique_ptr<core::Integration> integration_;
};

}  // namespace sfdae::f77
