// One call of DGELDA or SFNDAE.
// SPDX-License-Identifier: BSD-3-Clause
#include "f77/integration_call.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "f77/call_outputs.h"
#include "f77/routine.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::f77 {

namespace {

// IERR
constexpr int step_taken = 1, tout_reached = 3, initial_values_found = 4;
constexpr int many_steps = -1, tolerances_too_small = -2, weight_vanished = -3, step_too_small = -6, singular = -8;
constexpr int derivative_missing = -21;
constexpr int called_after_failure = -998, called_after_illegal_input = -999;

}  // namespace

IntegrationCall::IntegrationCall(const Arguments& arguments, UserProblem& user)
    : arguments_(arguments), state_(arguments), t_(*arguments.t), user_(user) {}

int IntegrationCall::run() noexcept {
  const int ierr = run_to_code();
  integration_.reset();  // before the model of the derived class, which it refers to
  return ierr;
}

int IntegrationCall::run_to_code() noexcept {
  try {
    return dispatch();
  } catch (const core::Failure& failure) {
    const int ierr = code_of(failure.status());
    if (ierr == no_characteristic_values && failure.status() == SFDAE_INDEX_TOO_HIGH) arguments_.cval.set(1, -1);
    return ierr;
  } catch (const core::DamagedArchive&) {
    return code::bad_info;
  } catch (...) {
    return not_reduced;
  }
}

int IntegrationCall::dispatch() {
  const int phase = arguments_.info[1];
  if (phase == -1) {
    // Where IWORK was too short to keep the last IERR, that was the failure.
    const bool is_illegal =
        arguments_.liw < shortest_iwork || code::is_illegal_input(arguments_.iwork.get(last_ierr));
    return is_illegal ? called_after_illegal_input : called_after_failure;
  }
  if (phase < -1) return code::bad_info;
  const bool is_first_call = phase == 0;
  int result = is_first_call ? code::ok : state_.load(progress_);
  if (result == code::ok) result = read_options(arguments_, is_first_call, options_);
  // First of all: options of INTEGERs of another width are garbage.
  if (is_first_call && has_other_width()) return code::wrong_width;
  if (result != code::ok) return result;
  x_.resize(core::index(arguments_.n));
  xdot_.resize(x_.size());
  if (is_first_call) return first_call();
  t_ = progress_.t_returned;
  create_model();
  return progress_.is_running ? go_on() : start_later();
}

bool IntegrationCall::has_other_width() {
  const auto is_legal = [](int size) { return size >= 1 && size <= largest_order; };
  return arguments_.may_be_wide && is_legal(arguments_.m) && is_legal(arguments_.n) && std::isfinite(t_) &&
         user_.has_other_width(t_, arguments_.x);
}

// ---- Initial values ------------------------------------------------------------------------------------------

int IntegrationCall::first_call() {
  if (!std::isfinite(t_) || !std::isfinite(arguments_.tout)) return code::tout_too_close;
  state_.invalidate();
  store_options(arguments_, options_);
  clear_outputs(arguments_, options_, t_);
  progress_.is_constant = arguments_.flag(5);
  create_model();
  if (arguments_.tout != t_) {
    find_initial_point(arguments_.tout < t_ ? -1.0 : 1.0);
    const int result = check_start(arguments_, options_, t_, x_.data());
    if (result != code::ok) return result;
    publish_point(arguments_, system().analysis(), t_, x_, xdot_);
    return start_integration();
  }
  const double hint = hinted_direction();
  try {
    find_initial_point(hint != 0.0 ? hint : 1.0);
  } catch (const core::Failure& failure) {
    // Nobody said that the functions are defined on this side of T.
    const bool is_callback_error = failure.status() == SFDAE_CALLBACK_FAILED || failure.status() == SFDAE_NOT_FINITE;
    if (hint != 0.0 || !is_callback_error || user_.last_t() == t_) throw;
    find_initial_point(-1.0);
  }
  publish_point(arguments_, system().analysis(), t_, x_, xdot_);
  system().accept();
  progress_.t_returned = t_;
  return state_.save(progress_, kept_matrices(), system(), nullptr) ? initial_values_found : not_reduced;
}

// +1 or -1 if H0 or TSTOP say, else 0.
double IntegrationCall::hinted_direction() const {
  const double to_stop = options_.stop_time.value_or(t_) - t_;
  const double h = options_.has_initial_step && options_.initial_step != 0.0 ? options_.initial_step : to_stop;
  return h > 0.0 ? 1.0 : h < 0.0 ? -1.0 : 0.0;
}

void IntegrationCall::find_initial_point(double direction) {
  double toward = arguments_.tout;
  if (toward == t_) toward = core::time_beside(t_, direction);
  if (options_.stop_time) {
    const double stop = *options_.stop_time;
    if ((stop - t_) * direction > 0.0 && (stop - toward) * direction < 0.0) toward = stop;
  }
  const core::KeptValues kept(model().problem(), t_);
  analyze_toward(toward);
  std::copy_n(arguments_.x, x_.size(), x_.data());
  if (!core::all_finite(x_.data(), x_.size())) stop_for_values(Stage::values);
  find_values();
}

void IntegrationCall::stop_for_values(Stage stage) {
  stage_ = stage;
  throw core::Failure(SFDAE_INCONSISTENT_VALUES, "");
}

core::AnalysisSettings IntegrationCall::settings() const {
  core::AnalysisSettings settings;
  settings.max_index = std::min(options_.max_index, core::max_strangeness_index);
  settings.orders_up_to_mu_only = true;
  std::vector<double> rtol;
  for (int i = 0; i < arguments_.n; ++i) rtol.push_back(arguments_.rtol_of(i));
  settings.least_useful_pivot = core::least_useful_pivot(rtol);
  return settings;
}

// From the start on in the direction of integration, and not beyond TSTOP nor, with Radau, TOUT. Limits that do not
// lie ahead are reported later.
void IntegrationCall::limit_evaluations() {
  const double direction = progress_.direction();
  double end = direction * std::numeric_limits<double>::infinity();
  const auto limit_to = [&](double limit) {
    if ((limit - t_) * direction > 0.0 && (limit - end) * direction < 0.0) end = limit;
  };
  if (options_.stop_time) limit_to(*options_.stop_time);
  if (arguments_.method == radau_method) limit_to(arguments_.tout);
  model().problem().set_limits(std::min(progress_.t_start, end), std::max(progress_.t_start, end));
}

void IntegrationCall::begin_interval(double toward) {
  progress_.t_start = t_;
  progress_.span = toward - t_;
  limit_evaluations();
}

void IntegrationCall::analyze_toward(double toward) {
  stage_ = Stage::structure;
  begin_interval(toward);
  analyze(toward);
}

// The integration after a first call with TOUT = T, from X and XPRIME as they are now.
int IntegrationCall::start_later() {
  std::copy_n(arguments_.x, x_.size(), x_.data());
  std::copy_n(arguments_.xprime, xdot_.size(), xdot_.data());
  const int result = check_start(arguments_, options_, t_, x_.data());
  if (result != code::ok) return result;
  if (!core::all_finite(x_.data(), x_.size())) stop_for_values(Stage::values);
  if (!core::all_finite(xdot_.data(), xdot_.size())) stop_for_values(Stage::slopes);
  const bool has_turned = (arguments_.tout < t_) != (progress_.span < 0.0) && !progress_.is_constant;
  if (has_turned) {
    analyze_toward(arguments_.tout);
  } else {
    begin_interval(arguments_.tout);
    state_.restore_system(model(), model_options_, progress_);
  }
  return_to_values();
  return start_integration();
}

// ---- Integration ---------------------------------------------------------------------------------------------

int IntegrationCall::start_integration() {
  progress_.is_running = true;
  core::IntegrationOptions options = options_of_integration();
  if (options_.has_initial_step) options.initial_step = std::fabs(options_.initial_step);
  integration_ = std::make_unique<core::Integration>(system(), model().change_watch(), options,
                                                     core::InitialPoint{t_, arguments_.tout, x_, xdot_});
  return advance();
}

int IntegrationCall::go_on() {
  stage_ = Stage::integration;
  limit_evaluations();
  try {
    integration_ = state_.restore(model(), model_options_, options_of_integration(), progress_);
  } catch (const core::Failure&) {
    return user_.callback_error() != SFDAE_OK ? code_of(user_.callback_error()) : code::bad_info;
  }
  const double t_reached = integration_->stepper().state().t;
  const int result = check_continuation(arguments_, options_, t_, t_reached, integration_->direction());
  return result == code::ok ? advance() : result;
}

core::IntegrationOptions IntegrationCall::options_of_integration() {
  core::IntegrationOptions options = integration_options(arguments_, options_);
  const std::vector<double> atol = options.tolerances.atol.different();
  if (std::any_of(atol.begin(), atol.end(), [](double a) { return a == 0.0; })) {
    options.monitor = watch_weights;
    options.monitor_user = this;
  }
  return options;
}

// Stops where the next step would have a weight that is zero.
int IntegrationCall::watch_weights(const sfdae_progress* progress, void* user) {
  const IntegrationCall& call = *static_cast<const IntegrationCall*>(user);
  return !call.has_passed_tout(progress->t) && has_zero_weight(call.arguments_, progress->x) ? 1 : 0;
}

bool IntegrationCall::has_passed_tout(double t) const { return (t - arguments_.tout) * progress_.direction() >= 0.0; }

int IntegrationCall::advance() {
  stage_ = Stage::integration;
  const long points_before = user_.points();
  publish_steps_before(arguments_, integration_->counts().steps);
  const core::Stepper& stepper = integration_->stepper();
  const double t_reached = stepper.state().t;
  core::CallResult result;
  if (!has_passed_tout(t_reached) && has_zero_weight(arguments_, stepper.x().data())) {
    result.status = SFDAE_STOPPED;
    t_ = t_reached;
    x_ = stepper.x();
    std::copy_n(arguments_.xprime, xdot_.size(), xdot_.data());
  } else {
    result = integration_->advance(arguments_.tout, arguments_.flag(3), t_, x_.data(), xdot_.data());
  }
  // Between the last point returned and a TOUT that was already asked for, but failed.
  if (result.status == SFDAE_ILLEGAL_ARGUMENT) return code::wrong_direction;
  if (user_.lacks_derivative()) result.status = SFDAE_CALLBACK_STOPPED;
  const bool is_no_change = !has_passed_tout(t_) && is_failure_taken_for_change(result.status);
  const int ierr = code_of(is_no_change ? user_.callback_error() : result.status);
  publish_point(arguments_, system().analysis(), t_, x_, xdot_);
  publish_counts(arguments_, *integration_, user_.points() - points_before);
  if (ierr == tolerances_too_small) enlarge_tolerances(arguments_, integration_->stepper().x().data());
  if (ierr == values_changed) publish_characteristics(arguments_, new_values());
  // Where the call was interrupted after TOUT, that TOUT may be asked for again.
  if (!has_passed_tout(t_) || t_ == arguments_.tout) progress_.t_returned = t_;
  // An integration that has seen a change does not go on: from here another one will.
  progress_.is_running = !is_no_change;
  return state_.save(progress_, kept_matrices(), system(), is_no_change ? nullptr : integration_.get()) ? ierr
                                                                                                        : not_reduced;
}

core::CharacteristicValues IntegrationCall::new_values() {
  const auto& change = integration_->change();
  return change ? change->new_values : system().values_at(arguments_.tout);
}

// Steps that become ever shorter before a point where a function fails look like a change at last, to the same values
// or to none.
bool IntegrationCall::is_failure_taken_for_change(int status) {
  if (status != SFDAE_CHARACTERISTICS_CHANGED || user_.callback_error() == SFDAE_OK) return false;
  const core::CharacteristicValues found = new_values();
  return found.mu < 0 || found == system().analysis().values;
}

// ---- Results -------------------------------------------------------------------------------------------------

int IntegrationCall::code_of(int status) const {
  const bool is_start = stage_ != Stage::integration;
  switch (status) {
    case SFDAE_OK: return tout_reached;
    case SFDAE_STEP_TAKEN: return step_taken;
    case SFDAE_STOPPED: return weight_vanished;
    case SFDAE_MAX_STEPS: return many_steps;
    case SFDAE_TOLERANCE_TOO_SMALL: return tolerances_too_small;
    case SFDAE_STEP_TOO_SMALL: return step_too_small;
    case SFDAE_SINGULAR: return singular;
    case SFDAE_CALLBACK_STOPPED: return user_.has_wrong_width() ? code::wrong_width : derivative_missing;
    case SFDAE_CALLBACK_FAILED: return is_start ? no_characteristic_values : functions_failed;
    case SFDAE_NOT_FINITE:
      // No subroutine is called for the values themselves.
      return !is_start ? functions_failed : stage_ == Stage::values ? no_consistent_value : no_characteristic_values;
    case SFDAE_INDEX_TOO_HIGH:
    case SFDAE_RANK_UNCLEAR: return no_characteristic_values;
    case SFDAE_CHARACTERISTICS_CHANGED: return is_start ? no_characteristic_values : values_changed;
    case SFDAE_INCONSISTENT_VALUES: return stage_ == Stage::slopes ? no_initial_derivative : no_consistent_value;
    case SFDAE_ORDER_MISSING: return derivative_missing;
    case SFDAE_INCONSISTENT_EQUATIONS:
    case SFDAE_NO_CONSISTENT_VALUES:
    case SFDAE_FIXED_VALUES: return no_consistent_value;
    default: return not_reduced;
  }
}

}  // namespace sfdae::f77
