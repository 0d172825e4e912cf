// Hybrid systems: modes, transitions, switches, life cycle: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "c_api/hybrid.h"

#include <algorithm>
#include <cmath>

#include "c_api/creation.h"
#include "c_api/expressions.h"
#include "c_api/structs.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

using namespace sfdae::core;

sfdae_hybrid::~sfdae_hybrid() {
  for (sfdae_solver* solver : solvers) solver->hybrid = nullptr;
}

namespace {

void check_mode(const sfdae_hybrid& hybrid, const char* name, int mode) {
  const int count = static_cast<int>(hybrid.modes.size());
  if (count == 0) refuse_argument(format("%s = %d, but there are no modes: call sfdae_add_mode.", name, mode));
  if (mode < 0 || mode >= count)
    refuse_argument(format("%s = %d; there are the modes 0 ... %d.", name, mode, count - 1));
}

void check_name(const sfdae_hybrid& hybrid, const char* name) {
  for (std::size_t k = 0; k < hybrid.modes.size() && name != nullptr && *name != '\0'; ++k)
    if (hybrid.modes[k].name == name) refuse_argument(format("mode %zu has the name \"%.60s\" already.", k, name));
}

sfdae_transition default_transition() {
  sfdae_transition transition{};
  transition.size = sizeof transition;
  transition.kind = SFDAE_TRANSITION_CONDITION;
  return transition;
}

void check_new_mode(const sfdae_hybrid& hybrid, const sfdae_solver* solver, const char* name) {
  if (solver == nullptr) refuse_argument("solver is NULL.");
  if (solver->hybrid != nullptr) refuse_argument("the solver is a mode of a hybrid system already.");
  if (solver->events) refuse_argument("the solver has events; events of a mode are its transitions.");
  if (solver->sensitivities)
    refuse_argument(
        "the solver has sensitivities of its own; those of a hybrid system are set by "
        "sfdae_set_hybrid_sensitivities.");
  if (!hybrid.modes.empty() && solver->model.n() != hybrid.n())
    refuse_argument(
        format("the solver has %d unknowns, but those of the other modes have %d.", solver->model.n(), hybrid.n()));
  return check_name(hybrid, name);
}

void check_transition(const sfdae_hybrid& hybrid, const sfdae_transition& transition) {
  check_mode(hybrid, "from", transition.from);
  check_mode(hybrid, "to", transition.to);
  if (transition.kind < SFDAE_TRANSITION_CONDITION || transition.kind > SFDAE_TRANSITION_TIME)
    refuse_argument(format("kind = %d; it must be one of SFDAE_TRANSITION_...", transition.kind));
  if (transition.kind == SFDAE_TRANSITION_TIME) {
    if (!std::isfinite(transition.time)) refuse_argument(format("time is %g.", transition.time));
    if (transition.function != nullptr) refuse_argument("a transition at a time has no function.");
    return;
  }
  if (transition.function == nullptr) refuse_argument("function is NULL.");
  if (transition.direction < -1 || transition.direction > 1)
    refuse_argument(format("direction = %d; it must be -1, 0 or 1.", transition.direction));
}

void check_switch(const sfdae_hybrid& hybrid, int below, int above, const char* name) {
  check_mode(hybrid, "below", below);
  check_mode(hybrid, "above", above);
  check_name(hybrid, name);
  if (below == above) refuse_argument(format("below = above = %d: they must be two modes.", below));
  for (const int mode : {below, above})
    if (hybrid.modes[index(mode)].surface != nullptr)
      refuse_argument(hybrid.name_of(mode) + " is a sliding mode; switches are between modes of solvers.");
}

void check_start(const sfdae_hybrid& hybrid, int mode, const PointOfInterest& point) {
  check_mode(hybrid, "mode", mode);
  if (!std::isfinite(point.t) || !std::isfinite(point.toward) || point.t == point.toward)
    refuse_argument(format("t = %g, toward = %g: must be finite and different.", point.t, point.toward));
  if (point.x == nullptr) refuse_argument("x is NULL.");
  if (!all_finite(point.x, index(hybrid.n()))) refuse_argument("x contains NaN or Inf.");
}

int advance(sfdae_hybrid* hybrid, double tout, bool stops, double* t, double* x, double* xdot) {
  return guarded(hybrid, [&]() -> CallResult {
    if (t == nullptr || x == nullptr) refuse_argument("t and x must not be NULL.");
    if (!std::isfinite(tout)) refuse_argument(format("tout is %g.", tout));
    if (hybrid->run.accumulation && hybrid->run.mode >= 0)
      throw Failure(SFDAE_ZENO, format("transitions accumulate at t = %.10g: call sfdae_start_hybrid.",
                                       *hybrid->run.accumulation));
    if (!hybrid->is_running()) refuse_without_run();
    HybridRun& run = hybrid->run;
    if ((tout - run.t) * run.direction() < 0.0)
      refuse_argument(format("tout = %.15g lies before t = %.15g, the last point returned.", tout, run.t));
    const CallResult result = hybrid->advance(tout, stops, xdot != nullptr);
    if (result.status == SFDAE_ILLEGAL_ARGUMENT) return result;
    *t = run.t;
    std::copy_n(run.x.begin(), hybrid->n(), x);
    if (xdot != nullptr) std::copy_n(run.xdot.begin(), hybrid->n(), xdot);
    return result;
  });
}

}  // namespace

extern "C" {

int sfdae_transition_init(sfdae_transition* transition, size_t size) {
  return initialize(transition, size, default_transition());
}

int sfdae_create_hybrid(sfdae_hybrid** hybrid) {
  if (hybrid != nullptr) *hybrid = nullptr;
  return creating([&] {
    if (hybrid == nullptr) refuse_argument("hybrid, where the new one goes, is NULL.");
    *hybrid = new sfdae_hybrid;
  });
}

int sfdae_destroy_hybrid(sfdae_hybrid** hybrid) {
  if (hybrid == nullptr || *hybrid == nullptr) return SFDAE_OK;
  if ((*hybrid)->busy.load()) return SFDAE_BUSY;
  for (const HybridMode& mode : (*hybrid)->modes)
    if (mode.solver->busy.load()) return SFDAE_BUSY;
  delete *hybrid;
  *hybrid = nullptr;
  return SFDAE_OK;
}

const char* sfdae_get_hybrid_message(const sfdae_hybrid* hybrid) { return hybrid == nullptr ? "" : hybrid->message; }

int sfdae_add_mode(sfdae_hybrid* hybrid, sfdae_solver* solver, const char* name, int* mode) {
  return guarded(hybrid, [&] {
    check_new_mode(*hybrid, solver, name);
    hybrid->solvers.reserve(hybrid->solvers.size() + 1);
    const int added = hybrid->add_mode(*solver, name != nullptr ? name : "");
    hybrid->solvers.push_back(solver);
    solver->hybrid = hybrid;
    if (mode != nullptr) *mode = added;
  });
}

int sfdae_add_transition(sfdae_hybrid* hybrid, const sfdae_transition* transition, int* number) {
  return guarded(hybrid, [&] {
    if (transition == nullptr || !is_plausible_size(transition->size))
      refuse_argument("transition is NULL or its size is not set: call sfdae_transition_init.");
    const sfdae_transition given = read_struct(*transition, default_transition());
    check_transition(*hybrid, given);
    const int added = hybrid->add_transition(given);
    if (number != nullptr) *number = added;
  });
}

int sfdae_add_switch(sfdae_hybrid* hybrid, int below, int above, sfdae_equations_function surface, void* user,
                     const char* name, int* mode) {
  return guarded(hybrid, [&] {
    check_switch(*hybrid, below, above, name);
    if (surface == nullptr) refuse_argument("surface is NULL.");
    const EquationNames names({"the surface of a switch"});
    const int added = hybrid->add_switch(below, above, record_equations(surface, 1, hybrid->n(), user, names),
                                         name != nullptr ? name : "");
    if (mode != nullptr) *mode = added;
  });
}

int sfdae_start_hybrid(sfdae_hybrid* hybrid, int mode, double t, double toward, double* x, double* xdot) {
  return guarded(hybrid, [&]() -> CallResult {
    const PointOfInterest point{t, toward, x, xdot};
    check_start(*hybrid, mode, point);
    CallResult result = hybrid->start(mode, point);
    if (result.status < 0 && result.status != SFDAE_ZENO) return result;
    const HybridRun& run = hybrid->run;
    std::copy_n(run.x.begin(), hybrid->n(), x);
    if (xdot != nullptr) std::copy_n(run.xdot.begin(), hybrid->n(), xdot);
    return result;
  });
}

int sfdae_advance_hybrid(sfdae_hybrid* hybrid, double tout, double* t, double* x, double* xdot) {
  return advance(hybrid, tout, false, t, x, xdot);
}

int sfdae_advance_to_transition(sfdae_hybrid* hybrid, double tout, double* t, double* x, double* xdot) {
  return advance(hybrid, tout, true, t, x, xdot);
}

int sfdae_request_stop_hybrid(sfdae_hybrid* hybrid) {
  if (hybrid == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  hybrid->request_stop();
  return SFDAE_OK;
}

int sfdae_get_hybrid_checkpoint_length(sfdae_hybrid* hybrid, size_t* length) {
  return guarded(hybrid, [&] {
    if (length == nullptr) refuse_argument("length is NULL.");
    if (!hybrid->is_running()) refuse_without_run();
    *length = hybrid->checkpoint_length();
  });
}

int sfdae_save_hybrid_checkpoint(sfdae_hybrid* hybrid, double* checkpoint, size_t length) {
  return guarded(hybrid, [&] {
    if (checkpoint == nullptr) refuse_argument("checkpoint is NULL.");
    if (!hybrid->is_running()) refuse_without_run();
    hybrid->save_checkpoint(checkpoint, length);
  });
}

int sfdae_restore_hybrid_checkpoint(sfdae_hybrid* hybrid, const double* checkpoint, size_t length) {
  return guarded(hybrid, [&] {
    if (checkpoint == nullptr) refuse_argument("checkpoint is NULL.");
    if (hybrid->modes.empty()) refuse_argument("there are no modes: call sfdae_add_mode.");
    hybrid->restore_checkpoint({checkpoint, length});
  });
}

}  // extern "C"
