// Driver of the integration: advances the solution from point to point and handles all events and failures on the way.
//
// Folder integrate: BDF and Radau methods, step control, events, outputs, checkpoints and the driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "expression/time_breakpoints.h"
#include "integrate/condition_steps.h"
#include "integrate/discrete_adjoint.h"
#include "integrate/input_watch.h"
#include "integrate/integration_options.h"
#include "integrate/integrator.h"
#include "integrate/kinks.h"
#include "integrate/method_choice.h"
#include "integrate/passage.h"
#include "integrate/sensitivities.h"
#include "integrate/solution_pieces.h"
#include "integrate/step_output.h"
#include "integrate/switch_log.h"
#include "integrate/work_counts.h"
#include "system/change_watch.h"
#include "system/dae_system.h"
#include "system/model.h"

namespace sfdae::core {

// Consistent point with its derivative xdot, the start of an integration toward another time.
struct InitialPoint {
  double t, toward;
  const std::vector<double>& x;
  const std::vector<double>& xdot;
};

class Integration {
 public:
  // watch: may be null. The system is at the initial point.
  Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
              const InitialPoint& point);
  // Continues from an archived state. Throws DamagedArchive.
  Integration(DaeSystem& system, std::unique_ptr<ChangeWatch> watch, const IntegrationOptions& options,
              Archive& archive);
  void archive(Archive& archive);

  // Advances to tout, or one step toward it. xdot may be null. t, x, xdot: the point reached, whatever the status,
  // unless the call itself is illegal (SFDAE_ILLEGAL_ARGUMENT).
  CallResult advance(double tout, bool one_step, double& t, double* x, double* xdot);
  // Solution at any t within the last step, not made consistent if it may be interpolated; the point reached does not
  // change. xdot may be null.
  CallResult interpolate(double t, bool may_interpolate, double* x, double* xdot);

  // Sets a companion of all steps from the initial point on; before the first step. Throws Failure.
  void carry(std::unique_ptr<Companion> companion);
  // Restores archived sensitivities. Throws DamagedArchive.
  void carry_archived(std::unique_ptr<Sensitivities> sensitivities, Archive& archive);
  // Does nothing without sensitivities.
  void archive_sensitivities(Archive& archive);
  const Sensitivities* sensitivities() const { return dynamic_cast<const Sensitivities*>(companion_.get()); }
  // Restores the branches of the equations after another integration has changed them.
  void restore_branches() { conditions_.restore_branches(); }
  // Continues, with other equations, an integration that has ended at the initial point: takes its counts, interval of
  // interest and recording. The first step is at most `longest`.
  void continue_from(Integration& before, double longest);
  // Takes the same data if E x may have jumped.
  void take_past(Integration& before);
  // Time of the point returned last.
  double last_returned() const { return last_returned_; }
  // True if steps fail because branches of conditions should be held but these equations cannot hold them: advance()
  // ends with SFDAE_ZENO, unless go_on_without_branches() was called.
  bool lacks_branches() const { return conditions_.lacks_branches(); }
  void go_on_without_branches() { conditions_.go_on_without_branches(); }
  // True if many steps had no progress: advance() ends with SFDAE_STEP_TOO_SMALL, unless go_on_idle() was called.
  bool is_idle() const { return regularity_.is_idle && !regularity_.goes_on_idle; }
  void go_on_idle() { regularity_.goes_on_idle = true; }
  // True if layers fit at the last point (SlidingLayers::fit); otherwise advance() ends with SFDAE_ZENO.
  bool layers_fit() const { return layers() == nullptr || layers()->fit(); }
  LayerPoint layer_point();
  // ConditionSteps::sliding, at the last point.
  const std::vector<RegularizedCondition>& sliding() const { return conditions_.sliding(); }
  // The values of parameters have changed since the start.
  void parameters_changed() {
    if (auto* const carried = dynamic_cast<Sensitivities*>(companion_.get())) carried->parameters_changed();
  }
  bool has_companion() const { return companion_ != nullptr; }
  // With an adjoint, steps end at outputs.
  const DiscreteAdjoint* adjoint() const { return dynamic_cast<const DiscreteAdjoint*>(companion_.get()); }
  // Sensitivities at any t within the last step, or at the initial point: n x count. Sdot may be null. Throws Failure.
  CallResult evaluate_sensitivities(double t, double* S, double* Sdot);
  // Gradient of functionals with weights at these times, see DiscreteAdjoint. Throws Failure.
  struct WeightedTimes {
    const std::vector<double>& times;
    const double* weights;
    int functionals;
  };
  CallResult gradient(const WeightedTimes& weighted, double* gradient);
  // With the adjoint: ends the integration at t, within the last step. space: tangent space there. Throws Failure.
  CallResult end_at(double t, TangentSpace& space);
  // Afterwards releases the data needed only for further steps.
  void keep_steps_alone();
  // Restricts evaluations to the piece of a step from the last point.
  void keep_to_last_piece();

  // Changes nothing if memory is missing.
  void set_options(const IntegrationOptions& options);
  // Tells whether xdot is used; otherwise it is zero at outputs.
  void want_slopes(bool wanted) { slopes_ = wanted || options_.events != nullptr ? Slopes::wanted : Slopes::none; }
  // Null: no events. The search starts at the point returned last.
  void set_events(Events* events) { options_.events = events; }
  // Takes the breakpoints of the options from the next step on.
  void set_breakpoints(const IntegrationOptions& options) {
    options_.breakpoints = options.breakpoints;
    options_.jumps = options.jumps;
    options_.inputs = options.inputs;
  }
  // Records the following steps there; null: not recorded.
  void record(std::weak_ptr<SolutionPieces> solution) { recording_ = {std::move(solution), false}; }
  IntegrationCounts counts() const;
  const Stepper& stepper() const { return *integrator_.stepper; }
  Method method() const { return integrator_.method; }     // in use: bdf or radau
  Method chosen_method() const { return choice_.chosen; }  // by the user
  double direction() const { return integrator_.direction; }
  double span() const { return span_; }  // interval of interest
  double size_of_times() const { return std::max(std::fabs(start_), std::fabs(integrator_.stepper->state().t)); }
  double start() const { return start_; }  // 0 after a short checkpoint
  const std::optional<LocatedChange>& change() const { return change_; }
  // The last singular point found, and the number of those passed.
  const std::optional<SingularPoint>& singular_point() const { return branches_.point; }
  long passed_points() const { return branches_.passed; }
  const SwitchLog& switches() const { return switches_; }
  // Sets how many singular points may be passed, from the next step on.
  void set_continuation(const IntegrationOptions& options) {
    options_.continuation = options.continuation;
    options_.max_passed = options.max_passed;
  }

 private:
  double start_of_last_step() const;
  bool is_outside_last_step(double t) const;
  void return_to_last_point();
  CallResult run(double tout, bool one_step);
  // Tells the companion the outcome of an attempt.
  void note(AttemptEnd end) {
    if (companion_) companion_->note(end);
  }
  void withdraw() {
    integrator_.stepper->withdraw();
    note(AttemptEnd::withdrawn);
  }
  void restart_at_kink();
  bool move(std::vector<double>& x, double h, const std::vector<double>& xdot);
  // is_large: E x has to move.
  void cross_gap(double tout, bool is_large);
  void cross_jump(const TimeBreakpoints::Gap& gap, double tout);
  void change_branches(double tout);
  ConsistentPoint values_with_branches(const PointOfInterest& before, double none);
  struct MovingSwitch;
  void go_on_after_jump(double t, const ConsistentPoint& after, const MovingSwitch* moving);
  bool moves_with_parameters(double h);
  std::vector<double> shifts_of_time(double to, const ConsistentPoint& before);
  std::vector<double> sensitivities_after(const MovingSwitch& moving, const ConsistentPoint& after);
  void record_gap(double from, double to, const std::vector<double>& after);
  bool is_jump(const std::vector<double>& before, const std::vector<double>& after);
  // Reasons not to try the next step.
  std::optional<CallResult> obstacle(long attempts, double tout);
  std::optional<CallResult> attempt_step(double tout);
  std::optional<double> limit_of_step(double t, double tout, double size) const;
  double noticing_step(double t);
  // True if the next step is short in order to locate something, not because others have failed.
  bool ends_as_located() const { return conditions_.end() || hidden_.end; }
  void notice_idle_steps();
  void limit_errors_in_layers();
  SlidingLayers* layers() const;  // may be null
  bool turns_in_step();
  bool ends_before_turn(double h);
  void try_with_branches(StepOutcome outcome, double h);
  void resize_workspace();
  std::optional<CallResult> accept_step(double h, double wanted, double tout, std::optional<JumpTest>& jumps);
  std::optional<CallResult> take_step(double h, std::vector<PassedSwitch> passed, bool is_across_kink);
  bool is_tried_again(double h);
  bool may_hide_jump(double h);
  bool has_found_change(const StepSearch& search, double h);
  void look_closer(const LocatedChange& suspect, double h);
  void record_step(double from);
  void add_piece(SolutionPieces& solution, SolutionPieces::Step step);
  std::optional<CallResult> call_monitor(double h) const;
  std::optional<CallResult> handle_failure(StepOutcome outcome, double h, double tout);
  bool has_located_change(double h, double tout);
  std::optional<CallResult> give_up(StepOutcome outcome);
  void start_trail();
  void extend_trail(double from);
  bool passes_singular_points() const;
  void refine_steps(double h);
  double fine_step(double size);
  CourseData course_data();
  std::optional<CallResult> meet_change();
  bool has_passed_obstacle();
  bool pass(const CourseData& data, const SmoothCourse& course, SingularPoint& point);
  void go_on_from(const ConsistentPoint& after, const SmoothCourse& course, SingularPoint& point);
  void record_passage(double t_after);
  LocatedChange change_at_failure() const;
  std::optional<LocatedChange> change_nearby() const;
  void restart(Method method);

  // Searches up to tout or the last point; returns the event found, if any.
  std::optional<CallResult> search_events(double tout);
  void output(double place, double t, double* x, double* xdot);
  void return_last_point(double& t, double* x, double* xdot);
  void return_consistent_point(double& t, double* x, double* xdot);
  void archive_change(Archive& archive);

  IntegrationOptions options_;
  Integrator integrator_;
  MethodChoice choice_;
  StepOutput output_;
  InputWatch inputs_;
  ConditionSteps conditions_;
  struct HiddenJump {
    MovementTest test;
    std::optional<TimeBreakpoints::Gap> at;  // x jumps there, from the last point on
    std::optional<double> end;               // of the next step
  };
  HiddenJump hidden_;
  WorkCounts counts_;
  std::unique_ptr<ChangeWatch> watch_;  // null if points can only be examined in steps
  std::optional<LocatedChange> change_;
  std::unique_ptr<Companion> companion_;  // usually null
  // A suspected change to be confirmed: a step ends at t, before it, and the next ones are at most `step` long until
  // one is accepted.
  struct Approach {
    double t, step;
    bool is_reached;
  };
  std::optional<Approach> approach_;
  struct Regularity {
    std::vector<double> limits, tolerances;  // of errors in layers; of x
    std::vector<double> slopes;              // at a point within a step
    // Number of attempts since idle_t and idle_x, to test whether x and t have moved since.
    int attempts = 0;
    double idle_t = 0.0;
    std::vector<double> idle_x;
    bool is_idle = false, goes_on_idle = false;
  };
  Regularity regularity_;
  Branches branches_;
  double start_ = 0.0, last_returned_ = 0.0;
  double span_ = 0.0;  // the interval of interest
  Slopes slopes_ = Slopes::wanted;
  struct Recording {
    std::weak_ptr<SolutionPieces> solution;
    bool is_on = false;  // the last step is recorded
  };
  Recording recording_;
  SwitchLog switches_;
};

}  // namespace sfdae::core
