// One call of SFNDAE or SFNDAF.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfndae_call.h"

#include <algorithm>

#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::f77 {

void SfndaeCall::create_model() {
  model_.emplace(user_.problem());
  model_options_.analysis = settings();
  model_options_.tolerances = integration_options(arguments_, options_).tolerances;
  model_options_.consistency.kind = arguments_.flag(11)   ? core::InitialValues::accept
                                    : arguments_.flag(12) ? core::InitialValues::keep_differential
                                                          : core::InitialValues::nearest;
}

void SfndaeCall::analyze(double toward) {
  if (!core::all_finite(arguments_.x, x_.size())) stop_for_values(Stage::values);
  std::vector<core::RankDecision> decisions;
  model_->analyze({t_, toward, arguments_.x}, model_options_, decisions);
}

void SfndaeCall::find_values() {
  stage_ = Stage::values;
  core::ConsistentPoint found = model_->consistent_point({t_, t_ + progress_.span, x_.data()}, model_options_);
  x_ = std::move(found.x);
  xdot_ = std::move(found.xdot);
}

// X may have been changed since it was returned, and the system may be that of another direction.
void SfndaeCall::return_to_values() {
  const core::Jet& jet = model_->system()->jet();
  if (jet.t != t_ || !std::equal(x_.begin(), x_.end(), jet.column(0))) find_values();
}

int SfndaeCall::code_of(int status) const {
  if (status == SFDAE_WRONG_DERIVATIVES) return wrong_array;
  const bool is_failure = status == SFDAE_CALLBACK_FAILED || status == SFDAE_NOT_FINITE;
  if (!is_failure) return IntegrationCall::code_of(status);
  // Failures of the user's subroutine have their own code at the start, too.
  if (user_.callback_error() != SFDAE_OK) return functions_failed;
  // Iterations have diverged so far that it was not called any more.
  return IntegrationCall::code_of(stage_ == Stage::integration ? SFDAE_STEP_TOO_SMALL : SFDAE_NO_CONSISTENT_VALUES);
}

}  // namespace sfdae::f77
