// Inspection: the C API of reports, decisions, statistics, arrays, projectors.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include "c_api/codes.h"
#include "c_api/hybrid.h"
#include "c_api/solver.h"
#include "c_api/structs.h"
#include "linalg/index.h"
#include "linalg/matrix.h"
#include "multibody/multibody_derivative_check.h"
#include "problem/derivative_check.h"
#include "problem/total_derivative_check.h"
#include "solver/report.h"

namespace sfdae::core {

sfdae_characteristics characteristics_of(const Solver& solver) {
  const IndexAnalysis& analysis = solver.system()->analysis();
  const CharacteristicValues& values = analysis.values;
  return {sizeof(sfdae_characteristics),
          analysis.t,
          values.mu,
          values.d,
          values.a,
          values.u,
          values.v,
          analysis.rank_E,
          code_of(solver.system()->leading_term()),
          analysis.time_scale,
          smallest_gap(solver.decisions.different())};
}

sfdae_statistics statistics_of(const Solver& solver) {
  sfdae_statistics s{};
  s.size = sizeof s;
  const EvaluationCounts evaluations = solver.model.evaluations();
  s.evaluations_E = evaluations.E;
  s.evaluations_A = evaluations.A;
  s.evaluations_f = evaluations.f;
  s.evaluations_F = evaluations.F;
  s.linearizations = evaluations.linearizations;
  s.check_calls = solver.model.problem().check_evaluations();
  const Integration* const integration = solver.known_integration();
  if (integration == nullptr) return s;
  const IntegrationCounts& counts = integration->counts();
  const StepState state = integration->stepper().state();
  s.steps = counts.steps;
  s.error_failures = counts.error_failures;
  s.other_failures = counts.other_failures;
  s.reductions = counts.reductions;
  s.factorizations = counts.factorizations;
  s.last_order = state.last.order;
  s.next_order = state.next_order;
  s.last_step = state.last.h;
  s.next_step = state.next_step;
  s.t_internal = state.t;
  s.smallest_kept = counts.smallest_kept;
  s.consistency = counts.inconsistency;
  s.first_step = counts.first_step;
  s.rounding = counts.rounding;
  s.switches = static_cast<long>(integration->switches().all().size());
  s.jumps = integration->switches().jumps();
  return s;
}

namespace {

sfdae_decision public_decision(const RankDecision& decision) {
  return {sizeof(sfdae_decision),
          decision.t,
          decision.level,
          decision.stage,
          code_of(decision.subject),
          decision.rows,
          decision.cols,
          decision.rank,
          decision.kept,
          decision.dropped,
          decision.noise,
          decision.threshold,
          decision.gap,
          code_of(decision.verdict)};
}

sfdae_multibody_report public_report(const ConstraintsReport& report) {
  return {sizeof(sfdae_multibody_report),
          report.t,
          report.holonomic,
          report.nonholonomic,
          report.redundant,
          report.degrees_of_freedom,
          report.position_freedom,
          report.condition,
          report.partitions,
          report.position_residual,
          report.velocity_residual};
}

sfdae_initial_report public_report(const InitialReport& report) {
  return {sizeof(sfdae_initial_report),
          report.t,
          report.residual_before,
          report.residual_after,
          report.largest_change,
          report.component,
          report.is_derivative_exact ? 1 : 0};
}

[[noreturn]] void refuse_size() {
  refuse_argument(format(
      "derivatives of problems with more than %d unknowns are not checked: it takes matrices of all of them. Check "
      "a smaller problem with the same functions.",
      most_dense_unknowns));
}

[[noreturn]] void refuse_nonlinear() { refuse_argument("the problem is not linear."); }

[[noreturn]] void refuse_struct() {
  refuse_argument("the result is NULL or its size is not set: call its init function.");
}

// Returns a mismatch, with a message if it is suspicious.
CallResult report_mismatch(const DerivativeMismatch& worst, const EquationNames& names,
                           sfdae_derivative_check* result) {
  CallResult words;
  if (worst.suspicious())
    words.message =
        format("%s differs from differences in %s, column %d: %.10g supplied, %.10g by differences.",
               name_of(worst).c_str(), names.row(worst.row).c_str(), worst.column, worst.supplied, worst.difference);
  fill_struct(result, {sizeof *result, worst.function, worst.order, worst.row, worst.column, worst.supplied,
                       worst.difference, worst.error, worst.uncertainty, worst.suspicious() ? 1 : 0});
  return words;
}

template <class Struct>
bool is_usable(const Struct* result) {
  return result != nullptr && is_plausible_size(result->size);
}

const SwitchLog& switches_of(const sfdae_solver& solver) {
  const Integration* const integration = solver.known_integration();
  if (integration == nullptr) throw Failure(SFDAE_NOT_STARTED, "call sfdae_start first.");
  return integration->switches();
}

// Read-only calls are allowed from callbacks, too.
template <class Body>
int query(const sfdae_solver* solver, Body body) noexcept {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  return status_of(body, [solver](int status, const char* text) {
    if (status < 0 && !solver->message_explains_failure)
      std::snprintf(solver->message, sizeof solver->message, "%s", text);
    return status;
  });
}

}  // namespace

}  // namespace sfdae::core

using namespace sfdae::core;

extern "C" {

int sfdae_get_characteristics(const sfdae_solver* solver, sfdae_characteristics* result) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_struct();
    if (!solver->system()) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze or sfdae_start first.");
    fill_struct(result, characteristics_of(*solver));
  });
}

int sfdae_get_multibody_report(const sfdae_solver* solver, sfdae_multibody_report* report) {
  return query(solver, [&] {
    if (!is_usable(report)) refuse_struct();
    if (solver->model.multibody() == nullptr) refuse_argument("the problem is not a multibody system.");
    if (!solver->system()) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze_at or sfdae_start first.");
    fill_struct(report, public_report(solver->model.constraints()));
  });
}

int sfdae_get_num_decisions(const sfdae_solver* solver, int* count) {
  return query(solver, [&] {
    if (count == nullptr) refuse_argument("count is NULL.");
    if (solver->decisions.empty()) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze or sfdae_start first.");
    *count = static_cast<int>(solver->decisions.size());
  });
}

int sfdae_get_decision(const sfdae_solver* solver, int index, sfdae_decision* result) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_struct();
    const int count = static_cast<int>(solver->decisions.size());
    if (count == 0) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze or sfdae_start first.");
    if (index < 0 || index >= count) refuse_argument(format("index %d; there are %d decisions.", index, count));
    fill_struct(result, public_decision(solver->decisions[static_cast<std::size_t>(index)]));
  });
}

int sfdae_get_change(const sfdae_solver* solver, sfdae_change* result) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_struct();
    if (!solver->integration || !solver->integration->change())
      throw Failure(SFDAE_NOT_STARTED, "no change of characteristic values has been met.");
    const LocatedChange& change = *solver->integration->change();
    const CharacteristicValues& was = solver->system()->analysis().values;
    const CharacteristicValues& is = change.new_values;
    fill_struct(result, sfdae_change{sizeof(sfdae_change), change.t, was.mu, was.d, was.a, was.u, was.v, is.mu, is.d,
                                     is.a, is.u, is.v});
  });
}

int sfdae_get_initial_report(const sfdae_solver* solver, sfdae_initial_report* result) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_struct();
    if (!solver->initial_report) throw Failure(SFDAE_NOT_STARTED, "call sfdae_start or sfdae_make_consistent first.");
    fill_struct(result, public_report(*solver->initial_report));
  });
}

int sfdae_get_statistics(const sfdae_solver* solver, sfdae_statistics* result) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_struct();
    fill_struct(result, statistics_of(*solver));
  });
}

int sfdae_switch_init(sfdae_switch* result, size_t size) { return initialize(result, size, sfdae_switch{}); }

int sfdae_get_num_switches(const sfdae_solver* solver, long* count) {
  return query(solver, [&] {
    if (count == nullptr) refuse_argument("count is NULL.");
    *count = static_cast<long>(switches_of(*solver).all().size());
  });
}

int sfdae_get_switch(const sfdae_solver* solver, long number, sfdae_switch* result, char* condition, size_t length,
                     size_t* needed) {
  return query(solver, [&] {
    if (!is_usable(result)) refuse_argument("result is NULL, or sfdae_switch_init was not called.");
    if (condition == nullptr && length > 0) refuse_argument("condition is NULL.");
    const std::vector<PassedSwitch>& all = switches_of(*solver).all();
    if (number < 0 || number >= static_cast<long>(all.size()))
      refuse_argument(format("index = %ld; there are %zu switches.", number, all.size()));
    const PassedSwitch& passed = all[static_cast<std::size_t>(number)];
    const std::string text = length > 0 || needed != nullptr ? text_of(passed) : std::string();
    const sfdae_switch found{sizeof(sfdae_switch), passed.t,        passed.before, passed.after,
                             passed.jumps ? 1 : 0, passed.condition};
    fill_struct(result, found);
    if (length > 0) std::snprintf(condition, length, "%s", text.c_str());
    if (needed != nullptr) *needed = text.size() + 1;
  });
}

int sfdae_report(const sfdae_solver* solver, char* text, size_t length, size_t* needed) {
  return query(solver, [&] {
    if (text == nullptr && length > 0) refuse_argument("text is NULL.");
    std::string report = report_of(*solver, modes_report(*solver));
    const bool is_analyzed = solver->system() != nullptr || !solver->decisions.empty();
    if (is_analyzed && solver->message[0] != '\0') report += std::string("Last message: ") + solver->message + "\n";
    if (length > 0) std::snprintf(text, length, "%s", report.c_str());
    if (needed != nullptr) *needed = report.size() + 1;
  });
}

int sfdae_certify(sfdae_solver* solver, double* distance) {
  return guarded<Text::of_failure>(solver, [&] {
    if (!solver->system()) throw Failure(SFDAE_NOT_STARTED, "call sfdae_analyze first.");
    const double found = solver->model.certify();
    solver->model.system()->set_distance(found);
    if (distance != nullptr) *distance = found;
  });
}

int sfdae_check_derivatives(sfdae_solver* solver, double t, int max_order, sfdae_derivative_check* result) {
  return guarded(solver, [&]() -> CallResult {
    if (!std::isfinite(t) || max_order < 1 || max_order > max_derivative_order)
      refuse_argument(format("t = %g, max_order = %d: it must be 1 ... %d.", t, max_order, max_derivative_order));
    if (result == nullptr || !is_plausible_size(result->size)) refuse_struct();
    LinearModel* linear = solver->model.linear();
    if (linear == nullptr) refuse_nonlinear();
    if (solver->model.n() > most_dense_unknowns) refuse_size();
    return report_mismatch(check_derivatives(linear->problem(), t, max_order), solver->problem().equation_names(),
                           result);
  });
}

int sfdae_check_total_derivatives(sfdae_solver* solver, double t, const double* derivatives, int max_order,
                                  sfdae_derivative_check* result) {
  return guarded(solver, [&]() -> CallResult {
    if (!std::isfinite(t) || max_order < 0 || max_order > max_derivative_order)
      refuse_argument(format("t = %g, max_order = %d: it must be 0 ... %d.", t, max_order, max_derivative_order));
    if (result == nullptr || !is_plausible_size(result->size)) refuse_struct();
    const std::size_t count = index(solver->model.n()) * index(max_order + 2);
    if (derivatives == nullptr) refuse_argument("derivatives is NULL.");
    if (!all_finite(derivatives, count)) refuse_argument("derivatives contains NaN or Inf.");
    CallbackProblem* callback =
        solver->model.nonlinear() != nullptr ? solver->model.nonlinear()->callback() : nullptr;
    if (callback == nullptr) refuse_argument("there is no callback for total derivatives.");
    if (solver->model.n() > most_dense_unknowns) refuse_size();
    return report_mismatch(check_total_derivatives(*callback, t, derivatives, max_order), callback->equation_names(),
                           result);
  });
}

int sfdae_check_multibody_derivatives(sfdae_solver* solver, double t, const double* q, const double* v,
                                      sfdae_derivative_check* result) {
  return guarded(solver, [&]() -> CallResult {
    if (!std::isfinite(t)) refuse_argument(format("t is %g.", t));
    if (!is_usable(result)) refuse_struct();
    if (solver->model.multibody() == nullptr) refuse_argument("the problem is not a multibody system.");
    CallbackMultibody* callbacks = solver->model.multibody()->callbacks();
    if (callbacks == nullptr) refuse_argument("recorded equations are differentiated by the library.");
    if (q == nullptr || v == nullptr) refuse_argument("q or v is NULL.");
    const MultibodySizes& sizes = callbacks->sizes();
    if (!all_finite(q, index(sizes.positions)) || !all_finite(v, index(sizes.velocities)))
      refuse_argument("q or v contains NaN or Inf.");
    return report_mismatch(check_multibody_derivatives(*callbacks, t, q, v), {}, result);
  });
}

int sfdae_get_parameter(const sfdae_solver* solver, const char* name, double* value) {
  return query(solver, [&] {
    if (name == nullptr || value == nullptr) refuse_argument("name or value is NULL.");
    TaylorEvaluator* evaluator = solver->model.evaluator();
    const auto index = evaluator != nullptr ? evaluator->find_parameter(name) : std::nullopt;
    if (!index) refuse_argument(format("there is no parameter \"%.60s\" in the equations.", name));
    *value = evaluator->parameter(*index);
  });
}

}  // extern "C"
