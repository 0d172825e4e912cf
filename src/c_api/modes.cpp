// Breakpoints, and jumps of values where equations change: the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include "sfdae/modes.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "c_api/solver.h"
#include "linalg/index.h"

using namespace sfdae::core;

namespace {

constexpr int most_breakpoints = 1000000;

void check_breakpoints(int count, const double* t, const int* kinds) {
  if (count < 0 || count > most_breakpoints)
    refuse_argument(format("count = %d; it must be 0 ... %d.", count, most_breakpoints));
  if (count > 0 && t == nullptr) refuse_argument("t is NULL.");
  for (int k = 0; k < count; ++k) {
    if (!std::isfinite(t[k])) refuse_argument(format("t[%d] is %g.", k, t[k]));
    if (k > 0 && t[k] == t[k - 1])
      refuse_argument(format("t[%d] = t[%d] = %.17g: breakpoints must be different.", k - 1, k, t[k]));
    if (k > 0 && !(t[k] > t[k - 1]))
      refuse_argument(
          format("t[%d] = %.17g is before t[%d] = %.17g: breakpoints must be in order.", k, t[k], k - 1, t[k - 1]));
    if (kinds != nullptr && kinds[k] != SFDAE_BREAKPOINT_KINK && kinds[k] != SFDAE_BREAKPOINT_JUMP)
      refuse_argument(
          format("kinds[%d] = %d; it must be SFDAE_BREAKPOINT_KINK or SFDAE_BREAKPOINT_JUMP.", k, kinds[k]));
  }
}

void check_restitution(const double* restitution, int count) {
  for (int i = 0; i < count && restitution != nullptr; ++i)
    if (!(restitution[i] >= 0.0 && restitution[i] <= 1.0))
      refuse_argument(format("restitution[%d] = %g; it must be 0 ... 1.", i, restitution[i]));
}

}  // namespace

extern "C" {

int sfdae_set_breakpoints(sfdae_solver* solver, int count, const double* t, const int* kinds) {
  return guarded(solver, [&] {
    check_breakpoints(count, t, kinds);
    std::vector<double> times;
    if (count > 0) times.assign(t, t + count);
    std::vector<char> jumps(index(count), 0);
    for (int k = 0; k < count && kinds != nullptr; ++k) jumps[index(k)] = kinds[k] == SFDAE_BREAKPOINT_JUMP ? 1 : 0;
    solver->set_breakpoints(std::move(times), std::move(jumps));
  });
}

int sfdae_get_jump(const sfdae_solver* solver, double* t, double* before, double* after, double* impulse) {
  if (solver == nullptr) return SFDAE_ILLEGAL_ARGUMENT;
  const auto& last = solver->jumps.last();
  if (!last) {
    if (!solver->message_explains_failure)
      std::snprintf(solver->message, sizeof solver->message, "no jump has been crossed since sfdae_start.");
    return SFDAE_NOT_STARTED;
  }
  if (t != nullptr) *t = last->t;
  if (before != nullptr) std::copy(last->before.begin(), last->before.end(), before);
  if (after != nullptr) std::copy(last->after.begin(), last->after.end(), after);
  if (impulse != nullptr) std::copy(last->impulse.begin(), last->impulse.end(), impulse);
  return SFDAE_OK;
}

int sfdae_jump(sfdae_solver* solver, double t, double toward, const double* before, double* after, int orders,
               double* impulses) {
  return guarded(solver, [&] {
    if (before == nullptr || after == nullptr) refuse_argument("before and after must not be NULL.");
    if (orders < 0 || (orders > 0 && impulses == nullptr))
      refuse_argument(format("orders = %d, impulses %s: orders must be 0 or the columns of impulses.", orders,
                             impulses == nullptr ? "NULL" : "given"));
    const Jump jump = solver->jump({t, toward, before});
    const std::size_t n = index(solver->model.n());
    std::copy(jump.x.begin(), jump.x.end(), after);
    for (int k = 0; k < orders; ++k) {
      double* column = impulses + index(k) * n;
      if (k < jump.impulses.cols()) std::copy_n(jump.impulses.view().column(k), n, column);
      else std::fill_n(column, n, 0.0);
    }
  });
}

int sfdae_impact(sfdae_solver* solver, double t, const double* restitution, const double* before, double* after,
                 double* impulses) {
  return guarded(solver, [&] {
    MultibodyModel* const model = solver->model.multibody();
    if (model == nullptr) refuse_argument("impacts are those of multibody systems: call sfdae_jump.");
    if (before == nullptr || after == nullptr) refuse_argument("before and after must not be NULL.");
    const int count = model->problem().sizes().constraints();
    check_restitution(restitution, count);
    std::vector<double> coefficients;
    if (restitution != nullptr) coefficients.assign(restitution, restitution + count);
    const Jump jump = solver->impact({t, time_beside(t, solver->direction), before}, coefficients);
    std::copy(jump.x.begin(), jump.x.end(), after);
    for (int i = 0; i < count && impulses != nullptr; ++i) impulses[i] = jump.impulses(model->n() - count + i, 0);
  });
}

}  // extern "C"
