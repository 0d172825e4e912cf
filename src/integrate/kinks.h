// Kinks of inputs, and how steps cross them (docs/decisions/41-tables-and-solutions.md).
//
// A step ends where the gap of a kink begins, the next one leads across the gap, and the integrator starts anew after
// each of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "expression/time_breakpoints.h"
#include "integrate/integration_options.h"
#include "integrate/integrator.h"
#include "integrate/step_output.h"

namespace sfdae::core {

// Where the next step from t toward tout has to end; none: anywhere.
struct StepFrom {
  double t, tout, direction;
};
std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step);

// The last point, up to which there are steps, is an end of the gap of a kink.
bool is_at_kink(const IntegrationOptions& options, const StepState& state);

// A step of size h from t leads from one end of the gap of a kink to the other.
bool crosses_kink(const IntegrationOptions& options, double t, double h);

// t, or where the solution is evaluated for it.
double beside_kink(const IntegrationOptions& options, const Integrator& integrator, double t);
// The solution at t is asked for, which is evaluated where the request says.
PointRequest request_beside_kink(double t, const PointRequest& request);

// The gap of a jump begins at t.
std::optional<TimeBreakpoints::Gap> jump_at(const IntegrationOptions& options, double t, double direction);

// The next evaluations are those of a step from t: they stay on the side of breakpoints that it is on. start: of the
// integration.
void keep_to_piece(const IntegrationOptions& options, DaeSystem& system, const StepFrom& step, double start);

// What keeps the step across the gap, which has been tried, from being accepted: what is differentiated jumps.
std::optional<CallResult> obstacle_at_kink(const Integrator& integrator);

}  // namespace sfdae::core
