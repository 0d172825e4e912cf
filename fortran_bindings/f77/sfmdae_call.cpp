// One call of SFMDAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/sfmdae_call.h"

#include <algorithm>

#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"
#include "problem/supplied_line.h"

namespace sfdae::f77 {

namespace {

constexpr int wrong_derivatives = -27;
// INFO
constexpr int accept_flag = 11, fixed_flag = 12, unchecked_flag = 18;
// Positions in IWORK of the derivative that is wrong.
constexpr int wrong_row = 1, wrong_column = 2;

}  // namespace

void SfmdaeCall::create_model() {
  model_.emplace(user_.problem(), core::Coordinates::orthogonal);
  model_options_.analysis = settings();
  model_options_.tolerances = integration_options(arguments_, options_).tolerances;
  core::ConsistencyRequest& request = model_options_.consistency;
  request.kind = arguments_.flag(accept_flag)  ? core::InitialValues::accept
                 : arguments_.flag(fixed_flag) ? core::InitialValues::fixed
                                               : core::InitialValues::nearest;
  if (request.kind != core::InitialValues::fixed) return;
  request.fixed.assign(x_.size(), 0);
  std::fill_n(request.fixed.begin(), 2 * user_.positions(), char{1});
}

void SfmdaeCall::analyze(double toward) {
  if (!core::all_finite(arguments_.x, x_.size())) stop_for_values(Stage::values);
  const core::PointOfInterest point{t_, toward, arguments_.x};
  std::vector<core::RankDecision> decisions;
  const bool checks = !arguments_.flag(unchecked_flag);
  try {
    try {
      model_->analyze(point, model_options_, decisions);
    } catch (const core::Failure&) {
      if (checks && user_.callback_error() == SFDAE_OK) model_->demand_derivatives(point, model_options_);
      throw;
    }
    if (checks) model_->demand_derivatives(point, model_options_);
  } catch (const core::WrongDerivative& failure) {
    publish_wrong_derivative(failure.mismatch());
    throw;
  }
}

// Row and column from 1; column 0: of g_t.
void SfmdaeCall::publish_wrong_derivative(const core::DerivativeMismatch& wrong) const {
  arguments_.iwork.set(wrong_row, wrong.row + 1);
  arguments_.iwork.set(wrong_column, wrong.function == 'T' ? 0 : wrong.column + 1);
}

void SfmdaeCall::find_values() {
  stage_ = Stage::values;
  core::ConsistentPoint found = model_->consistent_point({t_, t_ + progress_.span, x_.data()}, model_options_);
  x_ = std::move(found.x);
  xdot_ = std::move(found.xdot);
}

// X may have been changed since it was returned, and the system may be that of another direction.
void SfmdaeCall::return_to_values() {
  const core::MultibodyPoint& point = model_->system()->accepted_point();
  const auto q = x_.begin(), v = q + user_.positions();
  const bool is_there =
      point.t == t_ && std::equal(point.q.begin(), point.q.end(), q) && std::equal(point.v.begin(), point.v.end(), v);
  if (!is_there) find_values();
}

int SfmdaeCall::code_of(int status) const {
  if (status == SFDAE_WRONG_DERIVATIVES) return wrong_derivatives;
  const bool is_failure = status == SFDAE_CALLBACK_FAILED || status == SFDAE_NOT_FINITE;
  if (!is_failure) return IntegrationCall::code_of(status);
  // Failures of the subroutines have their own code at the start, too.
  if (user_.callback_error() != SFDAE_OK) return functions_failed;
  // Iterations have diverged so far that they were not asked any more.
  return IntegrationCall::code_of(stage_ == Stage::integration ? SFDAE_STEP_TOO_SMALL : SFDAE_NO_CONSISTENT_VALUES);
}

}  // namespace sfdae::f77
