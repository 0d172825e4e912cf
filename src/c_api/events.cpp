// Events and values within the last step: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "c_api/solver.h"
#include "linalg/index.h"

using namespace sfdae::core;

namespace {

constexpr int most_events = 10000;

void check_events(int num_events, sfdae_event_function function, const int* directions) {
  if (num_events < 0 || num_events > most_events)
    refuse_argument(format("num_events = %d; it must be 0 ... %d.", num_events, most_events));
  if (num_events > 0 && function == nullptr) refuse_argument("function is NULL.");
  for (int i = 0; i < num_events && directions != nullptr; ++i)
    if (directions[i] < -1 || directions[i] > 1)
      refuse_argument(format("directions[%d] = %d; it must be -1, 0 or 1.", i, directions[i]));
}

}  // namespace

extern "C" {

int sfdae_set_events(sfdae_solver* solver, int num_events, sfdae_event_function function, const int* directions,
                     void* user) {
  return guarded(solver, [&] {
    if (solver->hybrid != nullptr)
      refuse_argument("the solver is a mode of a hybrid system, whose transitions are its events.");
    check_events(num_events, function, directions);
    std::unique_ptr<Events> events;
    if (num_events > 0) {
      std::vector<int> wanted(index(num_events), 0);
      if (directions != nullptr) std::copy_n(directions, num_events, wanted.begin());
      events = std::make_unique<Events>(function, user, std::move(wanted));
    }
    solver->set_events(std::move(events));
  });
}

int sfdae_get_events(const sfdae_solver* solver, int* which) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  if (which == nullptr) {
    if (!solver->message_explains_failure) std::snprintf(solver->message, sizeof solver->message, "which is NULL.");
    return SFDAE_ILLEGAL_ARGUMENT;
  }
  if (!solver->events) return SFDAE_OK;
  const std::vector<int>& fired = solver->events->search.fired();
  std::copy(fired.begin(), fired.end(), which);
  return SFDAE_OK;
}

int sfdae_interpolate(sfdae_solver* solver, double t, double* x, double* xdot) {
  return guarded(solver, [&]() -> CallResult {
    if (x == nullptr) refuse_argument("x is NULL.");
    if (!std::isfinite(t)) refuse_argument(format("t is %g.", t));
    solver->demand_integration();
    solver->integration->want_slopes(xdot != nullptr);
    return solver->integration->interpolate(t, true, x, xdot);
  });
}

}  // extern "C"
