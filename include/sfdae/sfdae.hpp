// SPDX-License-Identifier: BSD-3-Clause

// sfdae for C++17 and later: a header-only wrapper of sfdae.h, which explains everything.
//
//  - Failures are thrown as sfdae::Error, warnings (> 0) and SFDAE_OK are returned.
//  - An exception thrown in a callback or in the monitor stops the call and leaves it unchanged.
//  - Results are the structs of sfdae.h, already initialised; matrices are column-major, indices count from 0.
//
//     sfdae::LinearProblem problem(2, 2);
//     problem.E = [](double t, int order, sfdae::MatrixRef E) { if (order == 0) E(1, 0) = 1, E(1, 1) = -t; ... };
//     problem.A = ...;
//     sfdae::Solver solver(problem);
//     sfdae::Point point{0.0, {1.0, 1.0}, {}};
//     solver.start(point, 10.0);
//     solver.advance(10.0, point);
//
// Nonlinear problems are written once, as formulas:
//
//     sfdae::NonlinearProblem problem(2, 2);
//     problem.equations = [](const auto&, auto x, auto xdot, auto F) {
//       F[0] = xdot[0] + x[1];
//       F[1] = x[0] * x[1] - 1;
//     };
//
// and mechanical systems with constraints as sfdae::MultibodyProblem.
#ifndef SFDAE_SFDAE_HPP
#define SFDAE_SFDAE_HPP

#include <sfdae/branches.h>
#include <sfdae/modes.h>
#include <sfdae/sfdae.h>
#include <sfdae/callbacks.hpp>
#include <sfdae/ensemble.hpp>
#include <sfdae/expression.hpp>
#include <sfdae/linearization.hpp>
#include <sfdae/problem.hpp>
#include <sfdae/results.hpp>
#include <sfdae/sensitivity.hpp>
#include <sfdae/solution.hpp>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sfdae {

/// Owns an sfdae_solver and the callbacks. Movable; a solver moved from can only be assigned to or destroyed. It
/// must not be moved, assigned to or destroyed from within its own callbacks.
class Solver {
 public:
  /// Copies a linear problem and its options. Throws Error if something is wrong with them.
  explicit Solver(LinearProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_linear, std::get<LinearProblem>(state_->problem), options);
  }

  /// Copies a nonlinear problem and its options, and records the equations, if it has some. Throws Error if
  /// something is wrong with them; exceptions of the function that writes equations are passed on.
  explicit Solver(NonlinearProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_nonlinear, std::get<NonlinearProblem>(state_->problem), options);
  }

  /// Copies a mechanical system and its options, and records the equations, if it has some; the unknowns are (q, v,
  /// lambda, kappa). Throws Error if something is wrong with them; exceptions of the function that writes equations
  /// are passed on.
  explicit Solver(MultibodyProblem problem, const Options& options = {})
      : state_(std::make_unique<State>(std::move(problem), options.monitor)) {
    create(sfdae_create_multibody, std::get<MultibodyProblem>(state_->problem), options);
  }

  /// Checks a linear problem and its options: returns a description of the error, "" if there is none.
  static std::string check(const LinearProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_linear, detail::in_c(problem, &state),
                     detail::in_c(options, problem.num_unknowns, &state), state);
  }

  /// Checks a nonlinear problem and its options: returns a description of the error, "" if there is none. Records the
  /// equations.
  static std::string check(const NonlinearProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_nonlinear, detail::in_c(problem, &state),
                     detail::in_c(options, problem.num_unknowns, &state), state);
  }

  /// Checks a mechanical system and its options: returns a description of the error, "" if there is none. Records the
  /// equations.
  static std::string check(const MultibodyProblem& problem, const Options& options = {}) {
    State state(problem, options.monitor);
    return complaint(sfdae_check_multibody, detail::in_c(problem, &state),
                     detail::in_c(options, problem.num_unknowns(), &state), state);
  }

  /// Replaces the options, the monitor included; the point reached stays. See sfdae_set_options for those that make
  /// a new start necessary.
  int set_options(const Options& options) {
    Monitor monitor = options.monitor;
    const sfdae_options c_options = detail::in_c(options, num_unknowns(), state_.get());
    const int status = checked(sfdae_set_options(get(), &c_options));
    state_->monitor.swap(monitor);
    return status;
  }

  /// The message of the last call; "" after SFDAE_OK.
  std::string message() const { return sfdae_message(get()); }

  /// Stops the call that is running, or else the next one, with SFDAE_STOPPED. From any thread or signal handler.
  void request_stop() noexcept { sfdae_request_stop(get()); }

  /// Determines the strangeness index of a linear problem at t, forward or backward toward the given time.
  int analyze(double t, double toward) { return checked(sfdae_analyze(get(), t, toward, nullptr)); }

  /// Determines the strangeness index of any problem along the solution through a point near point.x, forward or
  /// backward toward the given time.
  int analyze_at(const Point& point, double toward) {
    detail::require_size(point.x.size(), num_unknowns(), "x");
    return checked(sfdae_analyze_at(get(), point.t, toward, point.x.data(), nullptr));
  }

  /// Changes a parameter of recorded equations. An integration continues with the next advance() from the point
  /// returned last, as at a jump of data (sfdae_set_parameter).
  int set_parameter(const std::string& name, double value) {
    return checked(sfdae_set_parameter(get(), name.c_str(), value));
  }

  /// The value of a parameter of recorded equations.
  double parameter(const std::string& name) const {
    double value = 0;
    checked(sfdae_get_parameter(get(), name.c_str(), &value));
    return value;
  }

  /// The characteristic values in use.
  Characteristics characteristics() const { return filled(sfdae_characteristics_init, sfdae_get_characteristics); }

  /// The rank decisions of the last analysis.
  std::vector<Decision> decisions() const {
    int count = 0;
    checked(sfdae_get_num_decisions(get(), &count));
    std::vector<Decision> result(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      Decision& decision = result[static_cast<std::size_t>(i)];
      sfdae_decision_init(&decision, sizeof(Decision));
      checked(sfdae_get_decision(get(), i, &decision));
    }
    return result;
  }

  /// The change of the characteristic values, after SFDAE_CHARACTERISTICS_CHANGED.
  Change change() const { return filled(sfdae_change_init, sfdae_get_change); }

  /// Switches of conditions that the integration has passed. See sfdae_get_switch.
  std::vector<Switch> switches() const {
    long count = 0;
    checked(sfdae_get_num_switches(get(), &count));
    std::vector<Switch> all;
    std::map<int, std::string> conditions;
    for (long k = 0; k < count; ++k) {
      sfdae_switch found;
      sfdae_switch_init(&found, sizeof found);
      checked(sfdae_get_switch(get(), k, &found, nullptr, 0, nullptr));
      const auto [condition, is_new] = conditions.try_emplace(found.condition);
      if (is_new) {
        std::size_t needed = 0;
        checked(sfdae_get_switch(get(), k, &found, nullptr, 0, &needed));
        condition->second.resize(needed);
        checked(sfdae_get_switch(get(), k, &found, condition->second.data(), needed, nullptr));
        condition->second.pop_back();
      }
      all.push_back({found.t, found.before, found.after, found.jumps != 0, condition->second});
    }
    return all;
  }

  /// The singular point met last, whether it ended a call or was passed.
  SingularPoint singular_point() const { return filled(sfdae_singular_point_init, sfdae_get_singular_point); }

  /// Lets integrations continue after at most max_points singular points, if a smooth continuation is confirmed. See
  /// sfdae_pass_singular_points.
  int pass_singular_points(long max_points) { return checked(sfdae_pass_singular_points(get(), max_points)); }

  /// Makes point.x consistent at point.t and computes point.xdot, also an initial guess if options.xdot_is_guess is 1.
  /// The point reached is unaffected.
  int make_consistent(Point& point) {
    double* const xdot = prepared(point);
    return checked(sfdae_make_consistent(get(), point.t, point.x.data(), xdot));
  }

  /// Report on the consistent initial values of the last start or make_consistent.
  InitialReport initial_report() const { return filled(sfdae_initial_report_init, sfdae_get_initial_report); }

  /// Starts or restarts at point.t toward the given time: makes point.x consistent, computes point.xdot, also an
  /// initial guess if options.xdot_is_guess is 1.
  int start(Point& point, double toward) {
    double* const xdot = prepared(point);
    return checked(sfdae_start(get(), point.t, toward, point.x.data(), xdot));
  }

  /// Integrates to tout. If it is not reached, after warnings and failures, `point` is the last accepted one.
  int advance(double tout, Point& point) {
    point.x.resize(detail::size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_advance(get(), tout, &point.t, point.x.data(), xdot));
  }

  /// Takes one step toward tout: SFDAE_STEP_TAKEN, or SFDAE_OK at tout. After failures `point` is the last accepted
  /// one.
  int step(double tout, Point& point) {
    point.x.resize(detail::size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_step(get(), tout, &point.t, point.x.data(), xdot));
  }

  /// The state of the integration, to be stored, written to a file or passed to another process; see
  /// sfdae_save_checkpoint. It contains neither problem nor options.
  std::vector<double> save_checkpoint() {
    std::size_t length = 0;
    checked(sfdae_get_checkpoint_length(get(), &length));
    std::vector<double> checkpoint(length);
    checked(sfdae_save_checkpoint(get(), checkpoint.data(), length));
    return checkpoint;
  }

  /// Continues from a checkpoint instead of start(): advance() is next. The problem and the options have to be
  /// those that the checkpoint was made with. After a failure nothing is started.
  int restore_checkpoint(const std::vector<double>& checkpoint) {
    const double nothing = 0;  // an empty vector may have no address
    const double* const values = checkpoint.empty() ? &nothing : checkpoint.data();
    return checked(sfdae_restore_checkpoint(get(), values, checkpoint.size()));
  }

  /// Events are zeros of `count` functions: advance() and step() return SFDAE_EVENT there. directions: empty, or
  /// count numbers, +1 where only rising zeros count, -1 where only falling ones do, else 0. count = 0: no events
  /// any more.
  int set_events(int count, EventFunction function, const std::vector<int>& directions = {}) {
    if (!directions.empty() && directions.size() != detail::size(count))
      throw Error(SFDAE_ILLEGAL_ARGUMENT, "directions has " + std::to_string(directions.size()) + " entries, not " +
                                              std::to_string(count) + " as there are events");
    const int status = checked(sfdae_set_events(get(), count, function ? detail::call_events : nullptr,
                                                directions.empty() ? nullptr : directions.data(), state_.get()));
    state_->event_function = std::move(function);
    state_->num_events = count;
    return status;
  }

  /// Times at which data have kinks or jumps, increasing; kinds: empty (all are kinks), or SFDAE_BREAKPOINT_KINK or
  /// SFDAE_BREAKPOINT_JUMP for each. None: no breakpoints any more. See sfdae_set_breakpoints.
  int set_breakpoints(const std::vector<double>& t, const std::vector<int>& kinds = {}) {
    if (!kinds.empty()) detail::require_size(kinds.size(), static_cast<int>(t.size()), "kinds", "times");
    return checked(
        sfdae_set_breakpoints(get(), static_cast<int>(t.size()), t.data(), kinds.empty() ? nullptr : kinds.data()));
  }

  /// The jump crossed last at a breakpoint, with the impulse of order 0 alone.
  Jump last_jump() const {
    const std::size_t n = detail::size(num_unknowns());
    Jump jump{0.0, std::vector<double>(n), std::vector<double>(n), Matrix(num_unknowns(), 1)};
    checked(sfdae_get_jump(get(), &jump.t, jump.before.data(), jump.after.data(), jump.impulses.data()));
    return jump;
  }

  /// Consistent initial values of these equations at t after other equations have led to `before`, by impulses of these
  /// equations; orders: number of impulses requested, of delta, delta', ... See sfdae_jump; continue with start() from
  /// the values after it.
  Jump jump(double t, double toward, const std::vector<double>& before, int orders = 1) {
    detail::require_size(before.size(), num_unknowns(), "before");
    Jump jump{t, before, before, Matrix(num_unknowns(), orders < 0 ? 0 : orders)};
    checked(sfdae_jump(get(), t, toward, before.data(), jump.after.data(), orders, jump.impulses.data()));
    return jump;
  }

  /// The velocities of a mechanical system after an impact with coefficients of restitution, empty (all 0) or one for
  /// each constraint, and the impulses of the constraints in the rows of lambda and kappa. See sfdae_impact.
  Jump impact(double t, const std::vector<double>& before, const std::vector<double>& restitution = {}) {
    const auto* problem = std::get_if<MultibodyProblem>(state_ ? &state_->problem : nullptr);
    const int count = problem != nullptr ? problem->num_constraints + problem->num_nonholonomic : 0;
    detail::require_size(before.size(), num_unknowns(), "before");
    if (problem != nullptr && !restitution.empty())
      detail::require_size(restitution.size(), count, "restitution", "constraints");
    Jump jump{t, before, before, Matrix(num_unknowns(), 1)};
    double* const impulses = jump.impulses.data() + (num_unknowns() - count);
    checked(sfdae_impact(get(), t, restitution.empty() ? nullptr : restitution.data(), before.data(),
                         jump.after.data(), impulses));
    return jump;
  }

  /// Which events happened at the point returned with SFDAE_EVENT: +1 rising, -1 falling, else 0.
  std::vector<int> events() const {
    std::vector<int> which(detail::size(state_ ? state_->num_events : 0));
    int nothing = 0;
    checked(sfdae_get_events(get(), which.empty() ? &nothing : which.data()));
    return which;
  }

  /// The solution at any point.t within the last step taken; the point reached stays.
  int interpolate(Point& point) {
    point.x.resize(detail::size(num_unknowns()));
    double* const xdot = prepared(point);
    return checked(sfdae_interpolate(get(), point.t, point.x.data(), xdot));
  }

  /// Solves many instances of recorded equations on several threads, see sfdae_solve_ensemble. The solver itself is
  /// unchanged. Failures of instances are in the result. Exceptions of functions for prescribed values end their
  /// instance with SFDAE_CALLBACK_STOPPED and are not passed on.
  EnsembleSolution solve_ensemble(const Ensemble& ensemble) {
    const int n = num_unknowns(), N = ensemble.x0.columns();
    EnsembleSolution solution(n, static_cast<int>(ensemble.times.size()), N, ensemble.wants_xdot);
    detail::EnsembleMonitorState monitor{ensemble.monitor, nullptr};
    std::vector<const char*> names;
    for (const std::string& name : ensemble.parameter_names) names.push_back(name.c_str());
    const sfdae_ensemble c_ensemble = in_c(ensemble, names, monitor);
    std::vector<char> texts(detail::size(N) * message_length);
    sfdae_ensemble_results results;
    sfdae_ensemble_results_init(&results, sizeof results);
    results.x = solution.x().data();
    results.xdot = ensemble.wants_xdot ? solution.xdot().data() : nullptr;
    results.statuses = solution.statuses.data();
    results.num_outputs = solution.num_outputs.data();
    results.messages = N > 0 ? texts.data() : nullptr;
    results.message_length = message_length;
    solution.status = sfdae_solve_ensemble(get(), &c_ensemble, &results);
    if (state_) state_->exception = nullptr;
    if (monitor.exception) std::rethrow_exception(monitor.exception);
    checked(solution.status);
    for (std::size_t i = 0; i < detail::size(N); ++i) solution.messages[i] = texts.data() + i * message_length;
    solution.num_failed = results.num_failed;
    solution.num_analyses = results.num_analyses;
    solution.num_threads = results.num_threads;
    return solution;
  }

  /// Requests sensitivities from the next start on, see sfdae_set_sensitivities; none: ends them.
  int set_sensitivities(const Sensitivities& wanted) {
    const int n = num_unknowns(), count = static_cast<int>(wanted.parameters.size());
    if (wanted.directions.columns() > 0) require_matrix(wanted.directions, n, count, "directions");
    if (!wanted.scales.empty()) detail::require_size(wanted.scales.size(), count, "scales", "parameters");
    std::vector<const char*> names;
    for (const std::string& name : wanted.parameters) names.push_back(name.empty() ? nullptr : name.c_str());
    sfdae_sensitivity_options options;
    sfdae_sensitivity_options_init(&options, sizeof options);
    options.error_test = wanted.error_test ? 1 : 0;
    options.adjoint = wanted.adjoint ? 1 : 0;
    options.max_kept_steps = wanted.max_kept_steps;
    options.scales = wanted.scales.empty() ? nullptr : wanted.scales.data();
    const int status = checked(sfdae_set_sensitivities(
        get(), count, names.data(), wanted.directions.columns() > 0 ? wanted.directions.data() : nullptr, &options));
    state_->num_sensitivities = count;
    return status;
  }

  /// S and S' at t, the point returned last or one within the last step. slopes: true to compute S', which costs more
  /// than S; else Sdot is empty.
  SensitivityValues sensitivities(double t, bool slopes = true) {
    const int count = state_ ? state_->num_sensitivities : 0;
    SensitivityValues values{Matrix(num_unknowns(), count), slopes ? Matrix(num_unknowns(), count) : Matrix()};
    double nothing = 0;
    checked(sfdae_get_sensitivities(get(), t, count > 0 ? values.S.data() : &nothing,
                                    count > 0 && slopes ? values.Sdot.data() : nullptr));
    return values;
  }

  /// Gradients of functionals with weights at these times, see sfdae_get_gradient: one column for each. weights: n
  /// rows, a column for each time, for one functional after the other.
  Matrix gradient(const std::vector<double>& times, const Matrix& weights) {
    const int count = state_ ? state_->num_sensitivities : 0, points = static_cast<int>(times.size());
    const int functionals = points > 0 ? weights.columns() / points : 0;
    require_matrix(weights, num_unknowns(), points * functionals, "weights");
    Matrix gradient(count, functionals);
    double nothing = 0;
    checked(sfdae_get_gradient(get(), points, times.empty() ? &nothing : times.data(), functionals,
                               weights.columns() > 0 ? weights.data() : &nothing,
                               count > 0 ? gradient.data() : &nothing));
    return gradient;
  }

  /// dt_e/dp of an event at t, see sfdae_get_event_sensitivities. g_p: empty, or one number for each parameter.
  std::vector<double> event_sensitivities(double t, double g_t, const std::vector<double>& g_x,
                                          const std::vector<double>& g_p = {}) {
    const int count = state_ ? state_->num_sensitivities : 0;
    detail::require_size(g_x.size(), num_unknowns(), "g_x");
    if (!g_p.empty()) detail::require_size(g_p.size(), count, "g_p", "parameters");
    std::vector<double> dt(detail::size(count) + 1);
    checked(sfdae_get_event_sensitivities(get(), t, g_t, g_x.data(), g_p.empty() ? nullptr : g_p.data(), dt.data()));
    dt.resize(detail::size(count));
    return dt;
  }

  /// Work for the sensitivities.
  SensitivityStatistics sensitivity_statistics() const {
    return filled(sfdae_sensitivity_statistics_init, sfdae_get_sensitivity_statistics);
  }

  /// Records all accepted steps from now on, see sfdae_record_solution.
  int record(Solution& solution) { return checked(sfdae_record_solution(get(), solution.get())); }

  /// Stops recording.
  int stop_recording() { return checked(sfdae_record_solution(get(), nullptr)); }

  /// Counts and step sizes of the integration.
  Statistics statistics() const { return filled(sfdae_statistics_init, sfdae_get_statistics); }

  /// The diagnostics report.
  std::string report() const {
    std::size_t needed = 0;
    checked(sfdae_report(get(), nullptr, 0, &needed));
    std::string text(needed, '\0');
    checked(sfdae_report(get(), text.data(), needed, &needed));
    text.resize(needed - 1);
    return text;
  }

  /// The jet of a level through (t, x), n x (level + 2): x, x', ..., x^(level + 1). x: consistent, or empty for the
  /// solution at t.
  Matrix jet(double t, int level, const std::vector<double>& x = {}) {
    if (!x.empty()) detail::require_size(x.size(), num_unknowns(), "x");
    Matrix result(num_unknowns(), (level < 0 ? 0 : level) + 2);
    checked(sfdae_get_jet(get(), t, x.empty() ? nullptr : x.data(), level, result.data()));
    return result;
  }

  /// Derivative array of the given level at t, of nonlinear problems along the solution.
  DerivativeArray derivative_array(double t, int level) {
    checked(sfdae_get_derivative_array(get(), t, level, nullptr, nullptr, nullptr));  // refuses impossible levels
    DerivativeArray array = array_of_level(level);
    checked(sfdae_get_derivative_array(get(), t, level, array.M.data(), array.N.data(), array.g.data()));
    return array;
  }

  /// Derivative array of the given level at a jet, n x (level + 2).
  DerivativeArray derivative_array(double t, int level, const Matrix& jet) {
    require_jet(jet, level);
    checked(sfdae_get_derivative_array_at(get(), t, jet.data(), level, nullptr, nullptr, nullptr));
    DerivativeArray array = array_of_level(level);
    checked(
        sfdae_get_derivative_array_at(get(), t, jet.data(), level, array.M.data(), array.N.data(), array.g.data()));
    return array;
  }

  /// Projectors at t for the array of level mu, of nonlinear problems along the solution.
  Projectors projectors(double t) {
    return projectors([&](double* Z1, double* Z2, double* Z3, double* T2, int* vhat) {
      return sfdae_get_projectors(get(), t, Z1, Z2, Z3, T2, vhat);
    });
  }

  /// Projectors at a jet, n x (mu + 2).
  Projectors projectors(double t, const Matrix& jet) {
    require_jet(jet, characteristics().strangeness_index);
    return projectors([&](double* Z1, double* Z2, double* Z3, double* T2, int* vhat) {
      return sfdae_get_projectors_at(get(), t, jet.data(), Z1, Z2, Z3, T2, vhat);
    });
  }

  /// Strangeness-free system at t, of nonlinear problems along the solution.
  StrangenessFreeSystem strangeness_free(double t) {
    StrangenessFreeSystem s = strangeness_free();
    checked(sfdae_get_strangeness_free(get(), t, s.E1.data(), s.A1.data(), s.f1.data(), s.A2.data(), s.f2.data(),
                                       &s.residual));
    return s;
  }

  /// Strangeness-free system for changes of a jet, n x (mu + 2), of multibody systems n x 2.
  StrangenessFreeSystem strangeness_free(double t, const Matrix& jet) {
    const bool is_multibody = std::holds_alternative<MultibodyProblem>(state_->problem);
    require_jet(jet, is_multibody ? 0 : characteristics().strangeness_index);
    StrangenessFreeSystem s = strangeness_free();
    checked(sfdae_get_strangeness_free_at(get(), t, jet.data(), s.E1.data(), s.A1.data(), s.f1.data(), s.A2.data(),
                                          s.f2.data(), &s.residual));
    return s;
  }

  /// The extended system of a multibody system at (t, x); x: n values, or empty for the solution at t.
  ExtendedSystem extended_system(double t, const std::vector<double>& x = {}) {
    if (!x.empty()) detail::require_size(x.size(), num_unknowns(), "x");
    const MultibodyReport report = multibody_report();
    const int given = report.holonomic + report.nonholonomic, rv = given - report.redundant,
              nv = report.degrees_of_freedom + rv, nq = num_unknowns() - nv - given,
              rq = nq - report.position_freedom, order = num_unknowns() + rq + rv;
    ExtendedSystem s{{nq, nq},
                     {nv, nv},
                     {order, order},
                     {order, order},
                     std::vector<double>(detail::size(order)),
                     std::vector<double>(detail::size(rq + rv))};
    checked(sfdae_get_extended_system(get(), t, x.empty() ? nullptr : x.data(), s.Qq.data(), s.Qv.data(), s.E.data(),
                                      s.A.data(), s.f.data(), s.w.data()));
    return s;
  }

  /// Certifies the ranks of the analysis by perturbed copies of the data; returns the smallest relative change of the
  /// data that gives other characteristic values, about (sfdae_certify).
  double certify() {
    double distance = 0.0;
    checked(sfdae_certify(get(), &distance));
    return distance;
  }

  /// Structural analysis and its numerical confirmation (sfdae_get_structure).
  Structure structure() {
    const std::size_t n = detail::size(num_equations());
    Structure result{{}, std::vector<int>(n), std::vector<int>(n), std::vector<int>(n), std::vector<int>(n), ""};
    sfdae_structure_init(&result.summary, sizeof result.summary);
    checked(sfdae_get_structure(get(), &result.summary, result.differentiations.data(), result.orders.data(),
                                result.assigned.data(), result.block.data()));
    const bool agrees = result.summary.has_assignment == 1 && result.summary.verdict <= SFDAE_STRUCTURE_CERTIFIED;
    if (!agrees) result.words = message();
    return result;
  }

  /// Source text of a strangeness-free system with the solutions of recorded equations (sfdae_export_source). language:
  /// SFDAE_SOURCE_C, SFDAE_SOURCE_FORTRAN; name: prefix of its functions.
  std::string export_source(int language, const std::string& name) {
    std::size_t needed = 0;
    checked(sfdae_export_source(get(), language, name.c_str(), nullptr, 0, &needed));
    std::string text(needed, '\0');
    checked(sfdae_export_source(get(), language, name.c_str(), text.data(), needed, &needed));
    text.resize(needed - 1);
    return text;
  }

  /// The descriptor system of the problem, linearized at a point (sfdae_linearize).
  Descriptor linearize(const Linearization& choice) {
    const int n = num_unknowns();
    if (!choice.x.empty()) detail::require_size(choice.x.size(), n, "x");
    if (!choice.xdot.empty()) detail::require_size(choice.xdot.size(), n, "xdot");
    if (choice.input_columns.columns() > 0)
      detail::require_size(detail::size(choice.input_columns.rows()), num_equations(), "a column of inputs");
    if (choice.output_rows.rows() > 0)
      detail::require_size(detail::size(choice.output_rows.columns()), n, "a row of outputs");
    std::vector<const char*> names;
    for (const std::string& name : choice.input_parameters) names.push_back(name.c_str());
    sfdae_linearization in_c;
    sfdae_linearization_init(&in_c, sizeof in_c);
    in_c.t = choice.t;
    in_c.x = choice.x.empty() ? nullptr : choice.x.data();
    in_c.xdot = choice.xdot.empty() ? nullptr : choice.xdot.data();
    in_c.num_input_parameters = static_cast<int>(names.size());
    in_c.input_parameters = names.data();
    in_c.num_input_unknowns = static_cast<int>(choice.input_unknowns.size());
    in_c.input_unknowns = choice.input_unknowns.data();
    in_c.num_input_columns = choice.input_columns.columns();
    in_c.input_columns = choice.input_columns.data();
    in_c.num_output_unknowns = static_cast<int>(choice.output_unknowns.size());
    in_c.output_unknowns = choice.output_unknowns.data();
    in_c.num_output_rows = choice.output_rows.rows();
    in_c.output_rows = choice.output_rows.data();
    sfdae_descriptor* descriptor = nullptr;
    checked(sfdae_linearize(get(), &in_c, &descriptor));
    return Descriptor(descriptor);
  }

  /// Compares the derivatives of order 1 ... max_order that the callbacks of a linear problem supply near t with finite
  /// differences; returns the worst mismatch.
  DerivativeCheck check_derivatives(double t, int max_order) {
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_derivatives(get(), t, max_order, &result));
    return result;
  }

  /// Compares the total derivatives that the callback of a nonlinear problem supplies at t along a jet with finite
  /// differences; returns the worst mismatch. derivatives: the jet, n x (highest order compared + 2).
  DerivativeCheck check_total_derivatives(double t, const Matrix& derivatives) {
    detail::require_size(detail::size(derivatives.rows()), num_unknowns(), "a column of derivatives");
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_total_derivatives(get(), t, derivatives.data(), derivatives.columns() - 2, &result));
    return result;
  }

  /// Compares the derivatives that the callbacks of a mechanical system supply near (t, q, v) with finite differences;
  /// returns the worst mismatch.
  DerivativeCheck check_multibody_derivatives(double t, const std::vector<double>& q, const std::vector<double>& v) {
    const auto* problem = std::get_if<MultibodyProblem>(&state_->problem);
    if (problem != nullptr) {
      detail::require_size(q.size(), problem->num_positions, "q", "positions");
      detail::require_size(v.size(), problem->num_velocities, "v", "velocities");
    }
    DerivativeCheck result;
    sfdae_derivative_check_init(&result, sizeof result);
    checked(sfdae_check_multibody_derivatives(get(), t, q.data(), v.data(), &result));
    return result;
  }

  /// Constraints, freedom and partition of a mechanical system at the point reached.
  MultibodyReport multibody_report() const { return filled(sfdae_multibody_report_init, sfdae_get_multibody_report); }

  /// m, 0 for a solver moved from.
  int num_equations() const noexcept { return state_ ? state_->num_equations : 0; }

  /// n, 0 for a solver moved from.
  int num_unknowns() const noexcept { return state_ ? state_->num_unknowns : 0; }

  /// The C handle; it stays with this object.
  sfdae_solver* get() const noexcept { return state_ ? state_->solver : nullptr; }

 private:
  friend class Hybrid;
  using State = detail::CallbackState;

  /// Refuses a jet that is smaller than its level demands.
  void require_jet(const Matrix& jet, int level) const {
    detail::require_size(detail::size(jet.rows()), num_unknowns(), "a column of the jet");
    if (jet.columns() < level + 2)
      throw Error(SFDAE_ILLEGAL_ARGUMENT, "jet has " + std::to_string(jet.columns()) + " columns, not " +
                                              std::to_string(level + 2) + " as level " + std::to_string(level) +
                                              " demands");
  }

  DerivativeArray array_of_level(int level) const {
    const int blocks = level + 1, rows = blocks * num_equations();
    return {{rows, blocks * num_unknowns()}, {rows, num_unknowns()}, std::vector<double>(detail::size(rows))};
  }

  /// get: sfdae_get_projectors without its arguments solver and t.
  template <class Get>
  Projectors projectors(Get get_projectors) {
    const Characteristics c = characteristics();
    const int rows = (c.strangeness_index + 1) * num_equations();
    int vhat = 0;
    const int status = get_projectors(nullptr, nullptr, nullptr, nullptr, &vhat);
    const bool has_array =
        status != SFDAE_ORDER_MISSING || !std::holds_alternative<MultibodyProblem>(state_->problem);
    if (has_array) checked(status);
    Projectors p{{num_equations(), c.differential}, {}, {}, {num_unknowns(), num_unknowns() - c.algebraic}};
    if (has_array) p.Z2 = Matrix(rows, c.algebraic);
    if (has_array) p.Z3 = Matrix(rows, vhat);
    checked(get_projectors(p.Z1.data(), has_array ? p.Z2.data() : nullptr, has_array ? p.Z3.data() : nullptr,
                           p.T2.data(), has_array ? &vhat : nullptr));
    return p;
  }

  StrangenessFreeSystem strangeness_free() const {
    const Characteristics c = characteristics();
    const int n = num_unknowns();
    return {{c.differential, n},
            {c.differential, n},
            std::vector<double>(detail::size(c.differential)),
            {c.algebraic, n},
            std::vector<double>(detail::size(c.algebraic))};
  }

  /// Length that holds any message.
  static constexpr std::size_t message_length = 1536;

  /// An ensemble in C, which points to the one given, to the names and to the monitor.
  sfdae_ensemble in_c(const Ensemble& ensemble, const std::vector<const char*>& names,
                      detail::EnsembleMonitorState& monitor) const {
    const int n = num_unknowns(), N = ensemble.x0.columns(), num_parameters = static_cast<int>(names.size());
    require_matrix(ensemble.x0, n, N, "x0");
    if (ensemble.xdot0.columns() > 0) require_matrix(ensemble.xdot0, n, N, "xdot0");
    if (num_parameters > 0) require_matrix(ensemble.parameters, num_parameters, N, "parameters");
    sfdae_ensemble c;
    sfdae_ensemble_init(&c, sizeof c);
    c.num_instances = N;
    c.num_parameters = num_parameters;
    c.parameter_names = names.data();
    c.parameters = ensemble.parameters.data();
    c.t0 = ensemble.t0;
    c.x0 = ensemble.x0.data();
    c.xdot0 = ensemble.xdot0.columns() > 0 ? ensemble.xdot0.data() : nullptr;
    c.num_times = static_cast<int>(ensemble.times.size());
    c.times = ensemble.times.data();
    c.num_threads = ensemble.threads;
    c.monitor = ensemble.monitor ? detail::call_ensemble_monitor : nullptr;
    c.monitor_user = &monitor;
    return c;
  }

  static void require_matrix(const Matrix& matrix, int rows, int columns, const char* name) {
    if (matrix.columns() == columns && (columns == 0 || matrix.rows() == rows)) return;
    throw Error(SFDAE_ILLEGAL_ARGUMENT, std::string(name) + " is " + std::to_string(matrix.rows()) + " x " +
                                            std::to_string(matrix.columns()) + ", not " + std::to_string(rows) +
                                            " x " + std::to_string(columns));
  }

  template <class CProblem>
  using Create = int (*)(sfdae_solver**, const CProblem*, const sfdae_options*);
  template <class CProblem>
  using Check = int (*)(const CProblem*, const sfdae_options*, char*, std::size_t);

  template <class CProblem, class AnyProblem>
  void create(Create<CProblem> create_in_c, const AnyProblem& problem, const Options& options) {
    const CProblem c_problem = detail::in_c(problem, state_.get());
    const sfdae_options c_options = detail::in_c(options, num_unknowns(), state_.get());
    const int status = create_in_c(&state_->solver, &c_problem, &c_options);
    state_->rethrow();
    if (status < 0) throw Error(status, sfdae_message(nullptr));  // of this creation
  }

  template <class CProblem>
  static std::string complaint(Check<CProblem> check_in_c, const CProblem& problem, const sfdae_options& options,
                               State& state) {
    char text[1024] = "";
    const int status = check_in_c(&problem, &options, text, sizeof text);
    try {
      state.rethrow();
    } catch (const Error& error) {  // of views: an entry that does not exist
      return error.what();
    }
    return status < 0 && text[0] == '\0' ? sfdae_status_name(status) : text;
  }

  /// Resizes point.xdot to n and returns its data; throws Error unless point.x has n entries.
  double* prepared(Point& point) const {
    detail::require_size(point.x.size(), num_unknowns(), "x");
    point.xdot.resize(detail::size(num_unknowns()));
    return point.xdot.data();
  }

  template <class Result>
  Result filled(int (*init)(Result*, std::size_t), int (*get_result)(const sfdae_solver*, Result*)) const {
    Result result;
    init(&result, sizeof result);
    checked(get_result(get(), &result));
    return result;
  }

  /// Passes on the status, unless the call failed or an exception waits.
  int checked(int status) const {
    if (state_) state_->rethrow();
    if (status < 0) throw Error(status, sfdae_message(get()));
    return status;
  }

  std::unique_ptr<State> state_;
};

}  // namespace sfdae

#endif
