// Kinks of inputs, and steps across them (docs/design/inputs_and_discontinuities.md).
//
// A step ends where the gap of a kink begins, the next one crosses the gap, and the integrator restarts after each of
// them. If E x jumps in the gap, a jump by impulses (jump_rule.h) replaces the step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "expression/time_breakpoints.h"
#include "integrate/integration_options.h"
#include "integrate/integrator.h"
#include "integrate/step_output.h"

namespace sfdae::core {

// Time at which the next step from t toward tout, of size `longest` at most, must end; empty: any time.
struct StepFrom {
  double t, tout, direction;
};
std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step, double longest);

// True if the last point is an end of the gap of a kink.
bool is_at_kink(const IntegrationOptions& options, const StepState& state);

// True if a step of size h from t leads from one end of the gap of a kink to the other.
bool crosses_kink(const IntegrationOptions& options, double t, double h);

// Time at which the solution for t is evaluated: t, or an end of a gap near it.
double beside_kink(const IntegrationOptions& options, const Integrator& integrator, double t);
// Request for the solution at t, which is evaluated at the time of the given request.
PointRequest request_beside_kink(double t, const PointRequest& request);

// The gap of a jump that begins at t.
std::optional<TimeBreakpoints::Gap> jump_at(const IntegrationOptions& options, double t, double direction);

// Restricts the next evaluations to those of a step from t, on its side of breakpoints. start: of the integration.
void keep_to_piece(const IntegrationOptions& options, DaeSystem& system, const StepFrom& step, double start);

// Test whether E x may jump in a step across a gap: it has moved by more than slopes at both ends explain, or its
// movement is unknown. Small jumps count, since those of a staircase add up; if E x does not have to jump, the rule of
// jumps keeps it. With the adjoint, which cannot pass jumps, only large ones count. Created before the step, so that no
// memory is needed after it.
class JumpTest {
 public:
  explicit JumpTest(std::size_t unknowns) : jump_(unknowns), tolerances_(unknowns), x_(unknowns), slopes_(unknowns) {}
  bool has_jump(const Integrator& integrator, bool only_large);
  // After that: whether the jump is so large that E x has to move.
  bool is_large(const Integrator& integrator) const { return is_clear(integrator, true); }

 private:
  bool is_clear(const Integrator& integrator, bool only_large) const;
  // Ignores components whose slopes explain their changes in a step of size h.
  void leave_out(double h);

  std::vector<double> jump_, tolerances_, x_, slopes_;
};

}  // namespace sfdae::core
