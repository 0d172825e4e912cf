// One call of DGELDA.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/dgelda_call.h"

#include <cmath>

#include "linalg/matrix.h"
#include "linear/linear_values.h"
#include "problem/failure.h"

namespace sfdae::f77 {

void DgeldaCall::create_model() {
  model_options_.analysis = settings();
  if (progress_.is_constant) user_.declare_constant();
  const bool is_first_call = arguments_.info[1] == 0;
  if (progress_.is_constant && !is_first_call) user_.set_matrices(state_.matrices());
  model_.emplace(user_.functions());
  set_differences();
}

void DgeldaCall::set_differences() {
  model_options_.differences = {false, 0.0, std::fabs(progress_.span)};
  model_->problem().set_differences(model_options_.differences);
}

void DgeldaCall::analyze(double toward) {
  std::vector<core::RankDecision> decisions;
  model_->analyze({t_, toward, nullptr}, model_options_, decisions);
}

void DgeldaCall::return_to_values() {
  set_differences();
  model_->set_point(t_, model_options_);
}

void DgeldaCall::find_values() {
  return_to_values();
  stage_ = Stage::values;
  if (!arguments_.flag(11)) {
    core::ConsistencyRequest request;
    if (arguments_.flag(12)) request.kind = core::InitialValues::keep_differential;
    core::make_consistent(*model_->system(), request, x_);
  }
  stage_ = Stage::slopes;
  // Where there are no differential equations no step begins with x', which takes four points more.
  if (arguments_.tout == t_ || system().differential() > 0)
    system().consistent_derivative(x_.data(), progress_.direction(), xdot_.data());
  if (user_.lacks_derivative()) throw core::Failure(SFDAE_CALLBACK_STOPPED, "");
  if (!core::all_finite(xdot_.data(), xdot_.size())) stop_for_values(Stage::slopes);
}

}  // namespace sfdae::f77
