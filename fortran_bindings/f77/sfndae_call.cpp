// One call of SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfndae_call.h"

#include <algorithm>

#include "linalg/matrix.h"
#include "problem/failure.h"
#include "system/nonlinear_changes.h"

namespace sfdae::f77 {

void SfndaeCall::create_problem() {
  model_ = core::nonlinear_model(user_.callbacks());
  sfdae_options defaults;
  sfdae_options_init(&defaults, sizeof defaults);
  solver_options_.emplace(defaults, arguments_.n);
  solver_options_->analysis = settings();
  solver_options_->integration = integration_options(arguments_, options_);
  solver_options_->consistency.kind = arguments_.flag(11)   ? core::InitialValues::accept
                                      : arguments_.flag(12) ? core::InitialValues::keep_differential
                                                            : core::InitialValues::nearest;
}

void SfndaeCall::analyze(double toward) {
  if (!core::all_finite(arguments_.x, x_.size())) stop_for_values(Stage::values);
  std::vector<core::RankDecision> decisions;
  system_ = model_->analyze({t_, toward, arguments_.x}, *solver_options_, decisions);
}

void SfndaeCall::find_values() {
  stage_ = Stage::values;
  core::Consistent found =
      model_->consistent_values(*system_, *solver_options_, {t_, t_ + progress_.span, x_.data()});
  x_ = std::move(found.x);
  xdot_ = std::move(found.xdot);
}

// X may have been changed since it was returned, and the system may be that of another direction.
void SfndaeCall::return_to_values() {
  const core::Jet& jet = static_cast<const core::NonlinearSystem&>(*system_).jet();
  if (jet.t != t_ || !std::equal(x_.begin(), x_.end(), jet.column(0))) find_values();
}

core::CharacteristicValues SfndaeCall::local_values(double t) { return model_->detector(*system_)->values_at(t); }

int SfndaeCall::code_of(int status) const {
  const bool is_failure = status == SFDAE_CALLBACK_FAILED || status == SFDAE_NOT_FINITE;
  if (!is_failure) return IntegrationCall::code_of(status);
  // NDIF is what everything depends on: its failures have their own code at the start, too.
  if (user_.callback_error() != SFDAE_OK) return functions_failed;
  // Iterations have diverged so far that NDIF was not asked any more.
  return IntegrationCall::code_of(stage_ == Stage::integration ? SFDAE_STEP_TOO_SMALL : SFDAE_NO_CONSISTENT_VALUES);
}

}  // namespace sfdae::f77
