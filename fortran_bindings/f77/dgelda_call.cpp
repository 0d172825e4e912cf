// One call of DGELDA.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/dgelda_call.h"

#include <cmath>

#include "linalg/matrix.h"
#include "problem/failure.h"
#include "system/consistent_values.h"

namespace sfdae::f77 {

void DgeldaCall::create_problem() {
  settings_ = settings();
  if (progress_.is_constant) user_.declare_constant();
  const bool is_first_call = arguments_.info[1] == 0;
  if (progress_.is_constant && !is_first_call) user_.set_matrices(state_.matrices());
  problem_.emplace(user_.callbacks());
  set_differences();
}

void DgeldaCall::set_differences() { problem_->set_differences({false, 0.0, std::fabs(progress_.span)}); }

core::CheckpointTarget DgeldaCall::target() { return core::linear_target(*problem_, settings_); }

void DgeldaCall::analyze(double toward) {
  set_differences();
  std::vector<core::RankDecision> decisions;
  core::IndexAnalysis analysis = core::analyze_index(*problem_, t_, toward, settings_, arena_, decisions);
  system_ =
      std::make_unique<core::LinearSystem>(*problem_, settings_, std::move(analysis), core::LeadingTerm::automatic);
}

void DgeldaCall::return_to_values() {
  set_differences();
  core::PointStatus status = system_->move_to(t_);
  if (status == core::PointStatus::leading_changed) {
    system_->give_up_projector();
    status = system_->move_to(t_);
  }
  if (status == core::PointStatus::callback_error) throw core::Failure(system_->callback_error().status, "");
  if (status == core::PointStatus::changed) throw core::Failure(SFDAE_CHARACTERISTICS_CHANGED, "");
  if (system_->inconsistency() > core::IntegrationOptions().consistency_tol)
    throw core::Failure(SFDAE_INCONSISTENT_EQUATIONS, "");
}

void DgeldaCall::find_values() {
  return_to_values();
  stage_ = Stage::values;
  if (!arguments_.flag(11)) {
    core::ConsistencyRequest request;
    if (arguments_.flag(12)) request.kind = core::InitialValues::keep_differential;
    core::make_consistent(system(), request, x_);
  }
  stage_ = Stage::slopes;
  system_->consistent_derivative(x_.data(), progress_.direction(), xdot_.data());
  if (user_.lacks_derivative()) throw core::Failure(SFDAE_CALLBACK_STOPPED, "");
  if (!core::all_finite(xdot_.data(), xdot_.size())) stop_for_values(Stage::slopes);
}

core::CharacteristicValues DgeldaCall::local_values(double t) {
  return core::find_local_values(*problem_, t, settings_, arena_);
}

}  // namespace sfdae::f77
