// Kinks of inputs, and how steps cross them (docs/design/inputs_and_discontinuities.md).
//
// A step ends where the gap of a kink begins, the next one leads across the gap, and the integrator starts anew after
// each of them. If E x jumps in the gap, a jump by impulses (jump_rule.h) takes the place of the step.
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

// The time at which the next step from t toward tout, which is not longer than `longest`, has to end; none: any time.
struct StepFrom {
  double t, tout, direction;
};
std::optional<double> next_kink(const IntegrationOptions& options, const StepFrom& step, double longest);

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

// Tells whether E x may jump in a step across a gap that has been tried: it has moved by more than slopes at both ends
// explain, or it is not known how far. Small jumps count, as those of a staircase add up; if E x does not have to jump,
// the rule of jumps keeps it. With the adjoint, which cannot be carried over jumps, only large ones count. This is made
// before the step, so that no memory is needed after it.
class JumpTest {
 public:
  explicit JumpTest(std::size_t unknowns) : jump_(unknowns), tolerances_(unknowns), x_(unknowns), slopes_(unknowns) {}
  bool has_jump(const Integrator& integrator, bool only_large);

 private:
  bool is_clear(const Integrator& integrator, bool only_large) const;
  // Components whose slopes explain their changes in a step of size h do not count.
  void leave_out(double h);

  std::vector<double> jump_, tolerances_, x_, slopes_;
};

}  // namespace sfdae::core
