// Life cycle, index analysis, initial values, integration: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/solver.h"

#include <cmath>
#include <utility>

#include "c_api/codes.h"
#include "c_api/creation.h"
#include "c_api/options.h"
#include "c_api/problems.h"
#include "c_api/structs.h"

namespace sfdae::core {

CreationMessage& creation_message() {
  thread_local CreationMessage message = "";
  return message;
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

template <class Problem>
struct Arguments {
  Problem problem;
  sfdae_options options;
};

template <class Problem>
int unknowns_of(const Problem& problem) {
  return problem.num_unknowns;
}

int unknowns_of(const sfdae_multibody_problem& problem) {
  return problem.num_positions + (problem.num_velocities > 0 ? problem.num_velocities : problem.num_positions) +
         problem.num_constraints + problem.num_nonholonomic;
}

template <class Problem>
void read_arguments(const Problem* problem, const sfdae_options* options, const Problem& defaults,
                    Arguments<Problem>& result) {
  if (problem == nullptr) refuse_argument("problem is NULL.");
  if (!is_plausible_size(problem->size))
    refuse_argument("problem->size is not set: call the init function of problems.");
  if (options != nullptr && !is_plausible_size(options->size))
    refuse_argument("options->size is not set: call sfdae_options_init.");
  result.problem = read_struct(*problem, defaults);
  result.options = options != nullptr ? read_struct(*options, default_options()) : default_options();
  check_problem(result.problem);
  check_options(result.options, unknowns_of(result.problem));
}

template <class Problem>
int create(sfdae_solver** solver, const Problem* problem, const sfdae_options* options, const Problem& defaults) {
  if (solver != nullptr) *solver = nullptr;
  return creating([&] {
    if (solver == nullptr) refuse_argument("solver, where the new one goes, is NULL.");
    Arguments<Problem> arguments;
    read_arguments(problem, options, defaults, arguments);
    std::unique_ptr<FormulatedModel> model = make_model(arguments.problem);
    const int n = model->n();
    model->demand_structure(structure_use_of(arguments.options.structure));
    *solver = new sfdae_solver(std::move(model), solver_options(arguments.options, n));
  });
}

template <class Problem>
int check(const Problem* problem, const sfdae_options* options, const Problem& defaults, char* text, size_t length) {
  if (text == nullptr && length > 0) return SFDAE_ILLEGAL_ARGUMENT;
  const auto body = [&] {
    Arguments<Problem> arguments;
    read_arguments(problem, options, defaults, arguments);
    make_model(arguments.problem)->demand_structure(structure_use_of(arguments.options.structure));
  };
  return status_of(body, [=](int status, const char* message) {
    if (length > 0) std::snprintf(text, length, "%s", message);
    return status;
  });
}

CallResult advance(sfdae_solver* solver, double tout, bool one_step, double* t, double* x, double* xdot) {
  if (t == nullptr || x == nullptr) refuse_argument("t and x must not be NULL.");
  if (!std::isfinite(tout)) refuse_argument(format("tout is %g.", tout));
  return solver->advance(tout, one_step, *t, x, xdot);
}

int analyze(sfdae_solver* solver, const PointOfInterest& point, sfdae_characteristics* result) {
  return guarded(solver, [&]() -> CallResult {
    if (result != nullptr && !is_plausible_size(result->size))
      refuse_argument("result->size is not set: call sfdae_characteristics_init.");
    if (point.x == nullptr && solver->model.needs_x())
      refuse_argument("the characteristic values of a nonlinear problem depend on x: call sfdae_analyze_at.");
    CallResult warning = solver->analyze(point);
    if (result != nullptr) fill_struct(result, characteristics_of(*solver));
    return warning;
  });
}

[[noreturn]] void refuse_null() { refuse_argument("x is NULL."); }

}  // namespace

extern "C" {

int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text, size_t length) {
  return check(problem, options, default_problem(), text, length);
}

int sfdae_check_nonlinear(const sfdae_nonlinear_problem* problem, const sfdae_options* options, char* text,
                          size_t length) {
  return check(problem, options, default_nonlinear_problem(), text, length);
}

int sfdae_check_multibody(const sfdae_multibody_problem* problem, const sfdae_options* options, char* text,
                          size_t length) {
  return check(problem, options, default_multibody_problem(), text, length);
}

int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem, const sfdae_options* options) {
  return create(solver, problem, options, default_problem());
}

int sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                           const sfdae_options* options) {
  return create(solver, problem, options, default_nonlinear_problem());
}

int sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                           const sfdae_options* options) {
  return create(solver, problem, options, default_multibody_problem());
}

int sfdae_destroy(sfdae_solver** solver) {
  if (solver == nullptr || *solver == nullptr) return SFDAE_OK;
  if ((*solver)->busy.load() || (*solver)->hybrid != nullptr) return SFDAE_BUSY;
  delete *solver;
  *solver = nullptr;
  return SFDAE_OK;
}

int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options) {
  return guarded(solver, [&] {
    if (options == nullptr || !is_plausible_size(options->size))
      refuse_argument("options is NULL or its size is not set: call sfdae_options_init.");
    const sfdae_options copy = read_struct(*options, default_options());
    check_options(copy, solver->model.n());
    solver->set_options(solver_options(copy, solver->model.n()));
  });
}

const char* sfdae_message(const sfdae_solver* solver) {
  return solver == nullptr ? creation_message() : solver->message;
}

int sfdae_request_stop(sfdae_solver* solver) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  solver->problem().request_stop();
  return SFDAE_OK;
}

int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result) {
  return analyze(solver, {t, toward, nullptr}, result);
}

int sfdae_analyze_at(sfdae_solver* solver, double t, double toward, const double* x, sfdae_characteristics* result) {
  if (x != nullptr) return analyze(solver, {t, toward, x}, result);
  return guarded(solver, refuse_null);
}

int sfdae_set_parameter(sfdae_solver* solver, const char* name, double value) {
  return guarded(solver, [&] {
    if (name == nullptr) refuse_argument("name is NULL.");
    solver->set_parameter(name, value, solver->hybrid == nullptr);
  });
}

int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot) {
  return guarded(solver, [&] {
    if (x == nullptr) refuse_null();
    return solver->make_consistent(t, x, xdot);
  });
}

int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot) {
  return guarded(solver, [&] {
    if (x == nullptr) refuse_null();
    return solver->start(t, toward, x, xdot);
  });
}

int sfdae_advance(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, false, t, x, xdot); });
}

int sfdae_step(sfdae_solver* solver, double tout, double* t, double* x, double* xdot) {
  return guarded(solver, [&] { return advance(solver, tout, true, t, x, xdot); });
}

int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length) {
  return guarded<Text::of_failure>(solver, [&] {
    if (length == nullptr) refuse_argument("length is NULL.");
    *length = solver->checkpoint_length();
  });
}

int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length) {
  return guarded(solver, [&] {
    if (checkpoint == nullptr) refuse_argument("checkpoint is NULL.");
    solver->save_checkpoint(checkpoint, length);
  });
}

int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length) {
  return guarded(solver, [&] {
    if (checkpoint == nullptr) refuse_argument("checkpoint is NULL.");
    solver->restore_checkpoint({checkpoint, length});
  });
}

}  // extern "C"
