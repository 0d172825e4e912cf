// A solver of one problem: its model and options, the integration under way, breakpoints, events and recording.
//
// Folder solver: what stands behind the handle sfdae_solver, and everything else that uses solvers.
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
  bool has_smooth_conditions = false;  // their zeros are not looked for
};

// The adjustment of initial values.
struct InitialReport {
  double t, residual_before, residual_after, largest_change;
  int component;
  bool is_derivative_exact;
};

// Functions throw Failure, and return warnings.
struct Solver {
  Solver(std::unique_ptr<FormulatedModel> its_model, SolverOptions its_options);

  Problem& problem() { return model.problem(); }
  // The integration under way, or the one that goes on after a change of parameters; null: none.
  const Integration* known_integration() const { return changed ? changed->integration.get() : integration.get(); }
  // Null before an analysis.
  const DaeSystem* system() const { return model.system(); }
  void forget_analysis();
  void end_integration();
  // Advice for a call that has failed with this status; empty if there is none.
  const char* hint(int status) const;

  // An integration under way goes on, if the analysis stays.
  void set_options(SolverOptions fresh);
  // goes_on: an integration under way, without sensitivities, goes on from the point returned last.
  void set_parameter(const char* name, double value, bool goes_on);
  // Null: no events. They are searched from the point returned last.
  void set_events(std::unique_ptr<Events> wanted);
  // In order; with a flag for each, whether x may jump there.
  void set_breakpoints(std::vector<double> times, std::vector<char> jump_flags);
  // Puts conditions, and breakpoints of tables and those that are set, if there can be any, into the options.
  void use_breakpoints(SolverOptions& solver_options);
  // Singular points in an integration; 0: they end it.
  void pass_singular_points(long most);
  void use_continuation(IntegrationOptions& integration_options);
  // The solution that receives the steps from now on; expired: none.
  void record(std::weak_ptr<SolutionPieces> pieces);
  // Sensitivities from the next start on; none: no more. An integration under way ends, and the analysis stays if it is
  // still usable.
  void ask_for_sensitivities(std::optional<SensitivityRequest> request);

  // Index analysis; replaces the system and forgets the integration.
  CallResult analyze(const PointOfInterest& point);
  // x, and xdot unless it is null, become consistent.
  CallResult make_consistent(double t, double* x, double* xdot);
  CallResult start(double t, double toward, double* x, double* xdot);
  CallResult advance(double tout, bool one_step, double& t, double* x, double* xdot);
  // The values after a change of the equations from those before it; an integration ends.
  Jump jump(const PointOfInterest& before);
  // restitution: of each constraint, or empty.
  Jump impact(const PointOfInterest& before, const std::vector<double>& restitution);
  // At t, within the last step of an integration, or at the point of the analysis.
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

  // The side of the start that nothing is evaluated on, and the end of the first piece.
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
  // The first-order equations of a recorded mechanical system whose formulas contain conditions: to look at these.
  std::optional<TaylorEvaluator> first_order;
  std::optional<HeldConditions> conditions;  // on x, in recorded equations
  // Equations of the integration under way, if it has met conditions both branches of which lead back to their zero.
  std::unique_ptr<RegularizedEquations> regularized;
  JumpsOfModel jumps{*this};
  ContinuationOfModel continuation{*this};
  long max_passed = 0;                     // singular points in an integration
  std::weak_ptr<SolutionPieces> solution;  // where steps are recorded
  std::optional<SensitivityRequest> sensitivities;
  // After a start:
  std::unique_ptr<Integration> integration;
  // Parameters have changed since: the integration, its system and the point returned last. The next advance() goes on.
  struct Changed {
    double t;
    std::vector<double> x;
    std::shared_ptr<const DaeSystem> system;
    std::unique_ptr<Integration> integration;
  };
  std::optional<Changed> changed;
  std::optional<InitialReport> initial_report;
  std::atomic<bool> busy{false};  // with a call

 private:
  void find_conditions();
  std::optional<Changed> point_returned();
  void go_on_with_parameters(double tout);
  // Makes the analysis and sets the limits that consistent values at the point need, and ends an integration. Returns
  // what analyze_near does.
  std::vector<double> prepare_start(const PointOfInterest& point);
  void make_analysis(PointOfInterest point);
  // Makes an analysis, and returns the x from which consistent values are searched: the one given, or one that differs
  // from it in algebraic unknowns.
  std::vector<double> analyze_near(const PointOfInterest& point);
  std::optional<std::vector<double>> analyze_beside(const PointOfInterest& point, double move,
                                                    const std::optional<CharacteristicValues>& known,
                                                    std::vector<char>& stays);
  bool moves_differentiated(const PointOfInterest& point) const;
  // The sensitivities that were asked for go with the integration from its start, at the values found, where the system
  // stands; keeps_differentiated: their directions agree with the differentiated part of x already, and stay.
  void carry_sensitivities(const SensitivityRequest& wanted, const ConsistentPoint& found, bool keeps_differentiated);
  TaylorEvaluator* equations_with_conditions() { return first_order ? &*first_order : model.evaluator(); }
  std::unique_ptr<RegularizedEquations> regularize(Regularization parts);
  // Equations take the place of those in use, which are returned; null: the problem's own ones.
  std::unique_ptr<RegularizedEquations> use(std::unique_ptr<RegularizedEquations> equations);
  // The integration has ended where branches of conditions may be the reason, and goes on: with equations that are
  // continuous where both branches of a condition lead back to its zero, or, where equations cannot hold branches, with
  // others that can. If it cannot, the result may say why.
  bool goes_on_with_branches(double tout, CallResult& result);
  bool goes_on_with_layers(double tout, CallResult& result);
  // sliding: the conditions in use until now that become continuous.
  void start_regularized(double tout, Regularization parts, const std::vector<RegularizedCondition>& sliding);
  bool goes_on_with_terms(double tout, const CallResult& result);
  void demand_checkpoints() const;
  PointOfInterest initial_point(double t, double toward, const double* x, const double* xdot) const;
};

}  // namespace sfdae::core
