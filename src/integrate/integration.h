// The driver: carries a solution from point to point, deals with everything that may happen in between.
//
// Folder integrate: BDF and Radau methods, step control, events, outputs, checkpoints and the driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "integrate/bdf.h"
#include "integrate/error_weights.h"
#include "integrate/radau.h"
#include "integrate/stepper.h"
#include "system/change_watch.h"
#include "system/dae_system.h"

namespace sfdae::core {

// automatic: Radau, until frequent output or failing steps show that BDF is better off.
enum class Method { bdf, radau, automatic };

struct Events;

struct IntegrationOptions {
  Tolerances tolerances;
  Method method = Method::bdf;
  StepOptions stepping;
  bool never_pass_output = false;  // steps end at tout instead of being interpolated
  bool short_checkpoints = false;  // without what only statistics need
  double initial_step = 0.0;       // 0: chosen
  double max_step = 0.0;           // 0: none
  std::optional<double> stop_time;
  long max_steps = 100000;
  bool ignore_inconsistency = false;
  double consistency_tol = 1e-8;
  sfdae_monitor_function monitor = nullptr;
  void* monitor_user = nullptr;
  Events* events = nullptr;  // not owned; none
};

struct IntegrationCounts {
  long steps = 0, error_failures = 0, other_failures = 0;
  long reductions = 0, factorizations = 0;
  double first_step = 0.0;
  double smallest_kept = 1.0;
  double inconsistency = 0.0;
  double rounding = 0.0;  // largest rounding error of a component against its tightened tolerance
};

// Status of a call and what sfdae_message says about it.
struct CallResult {
  int status = SFDAE_OK;
  std::string message;
};

class Integration {
 public:
  // watch: may be null. Starts at the consistent point (t, x) with derivative xdot, toward the given time; the system stands at t.
  Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options, double t,
              double toward, const std::vector<double>& x, const std::vector<double>& xdot);
  // Goes on from where it was when it was archived. Throws DamagedArchive.
  Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
              Archive& archive);
  void archive(Archive& archive);

  // To tout, or one step toward it. t, x, xdot: the point reached, whatever the status, unless the call itself is
  // illegal (SFDAE_ILLEGAL_ARGUMENT).
  CallResult advance(double tout, bool one_step, double& t, double* x, double* xdot);
  // The solution at any t within the last step; the point reached stays.
  CallResult interpolate(double t, double* x, double* xdot);

  void set_options(const IntegrationOptions& options);
  // Whether anybody will look at xdot; else it need not be accurate.
  void want_slopes(bool wanted) { wants_slopes_ = wanted || options_.events != nullptr; }
  // None: nullptr. They are searched from the point returned last.
  void set_events(Events* events) { options_.events = events; }
  IntegrationCounts counts() const;
  const Stepper& stepper() const { return *stepper_; }
  Method method() const { return method_; }  // at present: bdf or radau
  double direction() const { return direction_; }
  const std::optional<LocatedChange>& change() const { return change_; }

 private:
  void create_stepper(Method method);
  bool is_better_off_with_bdf() const;
  CallResult run(double tout, bool one_step);
  std::optional<CallResult> attempt_step(double tout);
  std::optional<CallResult> accept_step(double h);
  CallResult output(double tout, double& t, double* x, double* xdot);
  // x and x' at t within the last step. may_refine: where the integrator's polynomial is not accurate it is made so.
  void evaluate(double t, bool may_refine, double* x, double* xdot);
  // Up to tout or the last point: the event found, if any.
  std::optional<CallResult> search_events(double tout);
  void start_events();
  void refine_for_events();
  void want_exact_slopes(bool wanted) { wants_slopes_ = wanted; }
  int halvings_for_events(double from, double to) const;
  void archive_events(Archive& archive);
  bool has_searched_to(double t) const;
  // The point searched last, in front of which no event has been left out.
  void return_searched_point(double& t, double* x, double* xdot) const;
  void return_last_point(double& t, double* x, double* xdot);
  void return_consistent_point(double& t, double* x, double* xdot);
  double choose_step(double tout) const;
  double smallest_step(double tout) const;
  std::optional<double> limit() const;
  void begin(double t, const std::vector<double>& x, const std::vector<double>& xdot);
  // With the method at present or another one.
  void restart_at_last_point(Method method);
  std::optional<CallResult> handle_failure(StepOutcome outcome, double h, double tout);
  CallResult step_too_small(StepOutcome outcome);
  CallResult changed_result() const;
  bool has_passed(double t) const { return (stepper_->t() - t) * direction_ >= 0.0; }

  class StepValues;

  DaeSystem& system_;
  IntegrationOptions options_;
  ErrorWeights weights_;
  Method chosen_ = Method::bdf;  // at the start
  Method method_ = Method::bdf;  // at present
  std::unique_ptr<Stepper> stepper_;
  // Running means, for the automatic choice: failures per attempt, outputs per step.
  double failure_rate_ = 0.0, output_rate_ = 0.0;
  int outputs_ = 0;                     // since the last step
  std::unique_ptr<ChangeWatch> watch_;  // none where points can be looked at in steps only
  double direction_ = 1.0;
  double last_returned_ = 0.0;
  double first_step_ = 0.0;
  bool must_restart_ = false;
  IntegrationCounts counts_;
  long reductions_before_ = 0, factorizations_before_ = 0;  // of the system, before the start
  std::optional<LocatedChange> change_;
  bool wants_slopes_ = true;
  bool inconsistent_ = false;  // seen in this call and ignored
  std::vector<double> scratch_w_, scratch_x_;
  double span_ = 0.0;  // the interval of interest
};

}  // namespace sfdae::core
