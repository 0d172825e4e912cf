// What is asked of a problem of any kind.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/model.h"

#include "linalg/matrix.h"
#include "problem/failure.h"

namespace sfdae::core {

void demand_array_for_sensitivities(const ModelOptions& options) {
  if (options.for_sensitivities && options.structure == StructureUse::required)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("structure = SFDAE_STRUCTURE_REQUIRED and %s exclude each other: they are computed with the "
                         "whole derivative array.",
                         options.for_adjoint ? "the adjoint" : "sensitivities of mechanical systems"));
}

void demand_dense(int n) {
  if (n > most_dense_unknowns)
    throw Failure(
        SFDAE_ILLEGAL_ARGUMENT,
        format("%d unknowns are too many for the whole derivative array, which the options or the equations ask "
               "for: more than %d need their structure.",
               n, most_dense_unknowns));
}

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
