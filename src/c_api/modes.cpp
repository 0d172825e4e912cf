// Breakpoints, and jumps of values where equations change: the C API over the core.
// SPDX-License-Identifier: BSD-3-Clause
#include "sfdae/modes.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "c_api/solver.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

ConsistentPoint JumpsOfModel::values_after(const PointOfInterest& before) {
  Model& model = solver_.model;
  const ModelOptions& options = solver_.options.model;
  Jump jump = model.jump(before, options);
  ConsistentPoint after = model.consistent_point({before.t, before.toward, jump.x.data()}, options);
  const std::size_t n = index(model.n());
  Crossed crossed{before.t, {before.x, before.x + n}, after.x, std::vector<double>(n, 0.0)};
  if (jump.impulses.cols() > 0) std::copy_n(jump.impulses.data(), n, crossed.impulse.begin());
  last_ = std::move(crossed);
  return after;
}

}  // namespace sfdae::core

using namespace sfdae::core;

namespace {

constexpr int most_breakpoints = 1000000;

CallResult check_breakpoints(int count, const double* t, const int* kinds) {
  if (count < 0 || count > most_breakpoints)
    return illegal_argument(format("count = %d; it must be 0 ... %d.", count, most_breakpoints));
  if (count > 0 && t == nullptr) return illegal_argument("t is NULL.");
  for (int k = 0; k < count; ++k) {
    if (!std::isfinite(t[k])) return illegal_argument(format("t[%d] is %g.", k, t[k]));
    if (k > 0 && t[k] == t[k - 1])
      return illegal_argument(format("t[%d] = t[%d] = %.17g: breakpoints must be different.", k - 1, k, t[k]));
    if (k > 0 && !(t[k] > t[k - 1]))
      return illegal_argument(
          format("t[%d] = %.17g is before t[%d] = %.17g: breakpoints must be in order.", k, t[k], k - 1, t[k - 1]));
    if (kinds != nullptr && kinds[k] != SFDAE_BREAKPOINT_KINK && kinds[k] != SFDAE_BREAKPOINT_JUMP)
      return illegal_argument(
          format("kinds[%d] = %d; it must be SFDAE_BREAKPOINT_KINK or SFDAE_BREAKPOINT_JUMP.", k, kinds[k]));
  }
  return {};
}

CallResult check_jump(const sfdae_solver& solver, double t, double toward, const double* before,
                      const double* after) {
  const int n = solver.model.n();
  if (!std::isfinite(t) || !std::isfinite(toward) || t == toward)
    return illegal_argument(format("t = %g, toward = %g: must be finite and different.", t, toward));
  if (before == nullptr || after == nullptr) return illegal_argument("before and after must not be NULL.");
  if (!all_finite(before, index(n))) return illegal_argument("before contains NaN or Inf.");
  const auto& stop = solver.options.integration.stop_time;
  if (stop && (*stop - t) * (toward - t) <= 0.0)
    return illegal_argument(format("t = %.15g lies at or beyond stop_time = %.15g.", t, *stop));
  return {};
}

CallResult check_restitution(const double* restitution, int count) {
  for (int i = 0; i < count && restitution != nullptr; ++i)
    if (!(restitution[i] >= 0.0 && restitution[i] <= 1.0))
      return illegal_argument(format("restitution[%d] = %g; it must be 0 ... 1.", i, restitution[i]));
  return {};
}

}  // namespace

extern "C" {

int sfdae_set_breakpoints(sfdae_solver* solver, int count, const double* t, const int* kinds) {
  return guarded(solver, [&]() -> CallResult {
    const CallResult checked = check_breakpoints(count, t, kinds);
    if (checked.status != SFDAE_OK) return checked;
    std::vector<double> times;
    if (count > 0) times.assign(t, t + count);
    std::vector<char> jumps(index(count), 0);
    for (int k = 0; k < count && kinds != nullptr; ++k) jumps[index(k)] = kinds[k] == SFDAE_BREAKPOINT_JUMP ? 1 : 0;
    // Nothing fails from here on.
    solver->breakpoints->set_times(std::move(times), std::move(jumps));
    solver->use_breakpoints(solver->options.integration);
    if (solver->integration) {
      solver->integration->set_breakpoints(solver->options.integration);
      set_limits(*solver, solver->integration->start(), solver->direction);
    }
    return {};
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
  return guarded(solver, [&]() -> CallResult {
    const CallResult checked = check_jump(*solver, t, toward, before, after);
    if (checked.status != SFDAE_OK) return checked;
    if (orders < 0 || (orders > 0 && impulses == nullptr))
      return illegal_argument(format("orders = %d, impulses %s: orders must be 0 or the columns of impulses.", orders,
                                     impulses == nullptr ? "NULL" : "given"));
    const PointOfInterest point{t, toward, before};
    prepare_start(*solver, point);
    const UserTime user_time(solver->problem(), t);
    const Jump jump = solver->model.jump(point, solver->options.model);
    const std::size_t n = index(solver->model.n());
    std::copy(jump.x.begin(), jump.x.end(), after);
    for (int k = 0; k < orders; ++k) {
      double* column = impulses + index(k) * n;
      if (k < jump.impulses.cols()) std::copy_n(jump.impulses.view().column(k), n, column);
      else std::fill_n(column, n, 0.0);
    }
    return {};
  });
}

int sfdae_impact(sfdae_solver* solver, double t, const double* restitution, const double* before, double* after,
                 double* impulses) {
  return guarded(solver, [&]() -> CallResult {
    StructuredMultibody* model = solver->kind.multibody;
    if (model == nullptr) return illegal_argument("impacts are those of multibody systems: call sfdae_jump.");
    const double toward = time_beside(t, solver->direction);
    CallResult checked = check_jump(*solver, t, toward, before, after);
    const int count = model->problem().sizes().constraints();
    if (checked.status == SFDAE_OK) checked = check_restitution(restitution, count);
    if (checked.status != SFDAE_OK) return checked;
    std::vector<double> coefficients;
    if (restitution != nullptr) coefficients.assign(restitution, restitution + count);
    const PointOfInterest point{t, toward, before};
    prepare_start(*solver, point);
    const UserTime user_time(solver->problem(), t);
    const Jump jump = model->impact(point, solver->options.model, coefficients);
    std::copy(jump.x.begin(), jump.x.end(), after);
    for (int i = 0; i < count && impulses != nullptr; ++i) impulses[i] = jump.impulses(model->n() - count + i, 0);
    return {};
  });
}

}  // extern "C"
