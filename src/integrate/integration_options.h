// What the user may choose about an integration, and what it counts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "integrate/stepper.h"
#include "sfdae/sfdae.h"
#include "system/tolerances.h"

namespace sfdae::core {

struct Events;
class ContinuationRule;
class HeldConditions;
class JumpRule;
class TimeBreakpoints;
class TimeInputs;

// automatic: Radau, until frequent output or failing steps show that BDF is better off.
enum class Method { bdf, radau, automatic };

struct IntegrationOptions : Acceptance {
  Method method = Method::bdf;
  StepOptions stepping;
  bool interpolates_outputs = false;  // by the method's polynomial alone, where that is accurate
  bool never_pass_output = false;     // steps end at tout instead of being interpolated
  bool short_checkpoints = false;     // without what only statistics and x' by differences need
  double initial_step = 0.0;          // 0: chosen
  double max_step = 0.0;              // 0: none
  std::optional<double> stop_time;
  long max_steps = 100000;
  sfdae_monitor_function monitor = nullptr;
  void* monitor_user = nullptr;
  Events* events = nullptr;                  // not owned; none
  TimeBreakpoints* breakpoints = nullptr;    // not owned; none: where steps end
  bool hides_switches = false;               // equations are callbacks, which may switch at any time
  HeldConditions* conditions = nullptr;      // not owned; none: on x, at which E x may jump
  TimeInputs* inputs = nullptr;              // not owned; none: what steps must not step over
  JumpRule* jumps = nullptr;                 // not owned; what happens at those where x may jump
  ContinuationRule* continuation = nullptr;  // not owned; none: singular points are not passed
  long max_passed = 0;                       // singular points that may be passed
  int recorded = 0;                          // the first unknowns, which go to solutions; 0: all
};

struct IntegrationCounts {
  long steps = 0, error_failures = 0, other_failures = 0;
  long reductions = 0, factorizations = 0;
  double first_step = 0.0;
  double smallest_kept = 1.0;
  double inconsistency = 0.0;
  double rounding = 0.0;  // largest rounding error of a component against its tightened tolerance
};

// Status of a call and what sfdae_message says about it.
struct CallResult {
  int status = SFDAE_OK;
  std::string message;
};

}  // namespace sfdae::core
