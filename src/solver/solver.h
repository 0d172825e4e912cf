// Solver of one problem: its model and options, current integration, breakpoints, events and recording.
//
// Folder solver: the implementation of the handle sfdae_solver, and all other code that uses solvers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "expression/held_conditions.h"
#include "expression/time_breakpoints.h"
#include "expression/time_inputs.h"
#include "integrate/checkpoint.h"
#include "integrate/integration.h"
#include "linalg/kept_decisions.h"
#include "problem/failure.h"
#include "solver/formulated_model.h"
#include "solver/model_rules.h"
#include "solver/regularized_equations.h"
#include "solver/sensitivity_request.h"
#include "solver/status_of.h"
#include "watch/events.h"

namespace sfdae::core {

struct SolverOptions {
  ModelOptions model;
  IntegrationOptions integration;
  bool xdot_is_guess = false;
  bool checks_derivatives = false;
  bool has_smooth_conditions = false;  // zeros of conditions are not located
  double max_seconds = 0.0;            // of a call; 0: no limit
};

// Adjustment of the initial values.
struct InitialReport {
  double t, residual_before, residual_after, largest_change;
  int component;
  bool is_derivative_exact;
};

// Functions throw Failure, and return warnings.
struct Solver {
  Solver(std::unique_ptr<FormulatedModel> its_model, SolverOptions its_options);

  Problem& problem() { return model.problem(); }
  // The current integration, or the one that continues after a change of parameters; may be null.
  Integration* known_integration() const { return changed ? changed->integration.get() : integration.get(); }
  // Throws Failure if there is no integration under way: it has not started, or parameters have changed since.
  void demand_integration() const;
  // Null before an analysis.
  const DaeSystem* system() const { return model.system(); }
  void forget_analysis();
  void end_integration();
  // Advice after a call that has failed with this status; may be empty.
  const char* hint(int status) const;

  // The current integration continues if the analysis is still valid.
  void set_options(SolverOptions fresh);
  // goes_on: the current integration, if it has no sensitivities, continues from the point returned last.
  void set_parameter(const char* name, double value, bool goes_on);
  // Null: no events. The search starts at the point returned last.
  void set_events(std::unique_ptr<Events> wanted);
  // times: in order; jump_flags: for each, whether x may jump there.
  void set_breakpoints(std::vector<double> times, std::vector<char> jump_flags);
  // Adds conditions and breakpoints, if there can be any, to the options.
  void use_breakpoints(SolverOptions& solver_options);
  // Sets how many singular points an integration may pass; 0: it ends there.
  void pass_singular_points(long most);
  void use_continuation(IntegrationOptions& integration_options);
  // Destination of the following steps; expired: none.
  void record(std::weak_ptr<SolutionPieces> pieces);
  // Sets sensitivities from the next start on; empty: none. The current integration ends; the analysis is retained if
  // it is still usable.
  void ask_for_sensitivities(std::optional<SensitivityRequest> request);

  // Index analysis; replaces the system and ends the integration.
  CallResult analyze(const PointOfInterest& point);
  // Makes x consistent, and xdot unless it is null.
  CallResult make_consistent(double t, double* x, double* xdot);
  CallResult start(double t, double toward, double* x, double* xdot);
  CallResult advance(double tout, bool one_step, double& t, double* x, double* xdot);
  // The values after a change of the equations from those before it; ends an integration.
  Jump jump(const PointOfInterest& before);
  // restitution: of each constraint, or empty.
  Jump impact(const PointOfInterest& before, const std::vector<double>& restitution);
  // Solution at t, within the last step of an integration, or at the point of the analysis.
  std::vector<double> solution_at(double t);
  // dt/dp of the time at which a function g(t, x, p) with these derivatives is 0; g_p may be null.
  struct EventSlopes {
    double t, g_t;
    const double *g_x, *g_p;
  };
  CallResult differentiate_event(const EventSlopes& slopes, double* dt);

  std::size_t checkpoint_length();
  void save_checkpoint(double* to, std::size_t length);
  void restore_checkpoint(const SavedCheckpoint& saved);

  // Restricts evaluations to one side of the start and to the first piece.
  void set_limits(double t, double toward_direction);

  std::unique_ptr<FormulatedModel> owned_model;
  FormulatedModel& model;
  SolverOptions options;
  KeptDecisions decisions;  // of the last analysis, failed or not
  // After an analysis:
  double direction = 1.0;          // of the nearby point of the analysis
  std::unique_ptr<Events> events;  // options.integration points to them
  std::optional<TimeBreakpoints> breakpoints;
  std::optional<TimeInputs> inputs;
  // First-order equations of a recorded mechanical system with conditions in its formulas, for their evaluation.
  std::optional<TaylorEvaluator> first_order;
  std::optional<HeldConditions> conditions;  // on x, in recorded equations
  // Equations of the current integration if both branches of some conditions lead back to zero.
  std::unique_ptr<RegularizedEquations> regularized;
  JumpsOfModel jumps{*this};
  ContinuationOfModel continuation{*this};
  long max_passed = 0;                     // singular points in an integration
  std::weak_ptr<SolutionPieces> solution;  // where steps are recorded
  std::optional<SensitivityRequest> sensitivities;
  // After a start:
  std::unique_ptr<Integration> integration;
  // Set if parameters have changed since: the integration, its system and the last point. advance() continues from it.
  struct Changed {
    double t;
    std::vector<double> x;
    std::shared_ptr<const DaeSystem> system;
    std::unique_ptr<Integration> integration;
  };
  std::optional<Changed> changed;
  std::optional<InitialReport> initial_report;
  std::atomic<bool> busy{false};  // in a call

 private:
  void find_conditions();
  std::optional<Changed> point_returned();
  void go_on_with_parameters(double tout);
  // Makes the analysis and sets the limits needed for consistent values at the point, and ends an integration. Returns
  // the result of analyze_near.
  std::vector<double> prepare_start(const PointOfInterest& point);
  void make_analysis(PointOfInterest point);
  // Makes an analysis, and returns the initial guess for consistent values: the given x, or one with other algebraic
  // unknowns.
  std::vector<double> analyze_near(const PointOfInterest& point);
  std::optional<std::vector<double>> analyze_beside(const PointOfInterest& point, double move,
                                                    const std::optional<CharacteristicValues>& known,
                                                    std::vector<char>& stays);
  bool moves_differentiated(const PointOfInterest& point) const;
  // Starts the sensitivities requested, at the values found, the current point of the system; keeps_differentiated:
  // their directions already agree with the differential part of x, and are not changed.
  void carry_sensitivities(const SensitivityRequest& wanted, const ConsistentPoint& found, bool keeps_differentiated);
  TaylorEvaluator* equations_with_conditions() { return first_order ? &*first_order : model.evaluator(); }
  std::unique_ptr<RegularizedEquations> regularize(Regularization parts);
  // Replaces the equations in use, and returns them; null: the problem's own ones.
  std::unique_ptr<RegularizedEquations> use(std::unique_ptr<RegularizedEquations> equations);
  // Tries to continue an integration that branches of conditions may have ended: with continuous equations if both
  // branches of a condition lead back to its zero, or with other equations if the present ones cannot hold branches. On
  // failure the result may contain the reason.
  bool goes_on_with_branches(double tout, CallResult& result);
  bool goes_on_with_layers(double tout, CallResult& result);
  // sliding: the conditions in use so far that become continuous.
  void start_regularized(double tout, Regularization parts, const std::vector<RegularizedCondition>& sliding);
  bool goes_on_with_terms(double tout, const CallResult& result);
  void demand_checkpoints() const;
  PointOfInterest initial_point(double t, double toward, const double* x, const double* xdot) const;
};

}  // namespace sfdae::core
