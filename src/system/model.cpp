// Functions shared by models of all kinds.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/model.h"

#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

void add_derivative(DaeSystem& system, double direction, ConsistentPoint& point) {
  point.xdot.resize(point.x.size());
  point.derivative_exact = system.consistent_derivative(point.x.data(), direction, point.xdot.data());
  if (!all_finite(point.xdot.data(), point.xdot.size()))
    throw Failure(SFDAE_NOT_FINITE, format("the derivative of the initial values overflows at t = %.15g.", point.t));
}

void demand_point(const DaeSystem& system, PointStatus status, double t, const char* advice) {
  if (status == PointStatus::callback_error) system.callback_error().raise();
  if (status == PointStatus::ok) return;
  throw Failure(SFDAE_CHARACTERISTICS_CHANGED, "the characteristic values known (" +
                                                   describe(system.analysis().values) +
                                                   format(") do not hold at t = %.15g. ", t) + advice);
}

}  // namespace sfdae::core
