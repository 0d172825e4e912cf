// Options and counts of an integration.
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

// automatic: Radau, until frequent outputs or failing steps show that BDF is more efficient.
enum class Method { bdf, radau, automatic };

struct IntegrationOptions : Acceptance {
  Method method = Method::bdf;
  StepOptions stepping;
  bool interpolates_outputs = false;  // by the polynomial of the method only, if accurate
  bool never_pass_output = false;     // steps end at tout instead of being interpolated
  bool short_checkpoints = false;     // without data for statistics and finite-difference x'
  double initial_step = 0.0;          // 0: automatic
  double max_step = 0.0;              // 0: unlimited
  std::optional<double> stop_time;
  long max_steps = 100000;
  sfdae_monitor_function monitor = nullptr;
  void* monitor_user = nullptr;
  Events* events = nullptr;                  // not owned; may be null
  TimeBreakpoints* breakpoints = nullptr;    // not owned; may be null: where steps end
  bool hides_switches = false;               // equations are callbacks, which may switch at any time
  HeldConditions* conditions = nullptr;      // not owned; may be null: on x; E x may jump there
  TimeInputs* inputs = nullptr;              // not owned; may be null: steps must not miss their changes
  JumpRule* jumps = nullptr;                 // not owned; values after breakpoints where x may jump
  ContinuationRule* continuation = nullptr;  // not owned; null: singular points are not passed
  long max_passed = 0;                       // singular points that may be passed
  int recorded = 0;                          // number of leading unknowns that are recorded; 0: all
};

struct IntegrationCounts {
  long steps = 0, error_failures = 0, other_failures = 0;
  long reductions = 0, factorizations = 0;
  double first_step = 0.0;
  double smallest_kept = 1.0;
  double inconsistency = 0.0;
  double rounding = 0.0;  // largest rounding error of a component relative to its tightened tolerance
};

// Status of a call and its text for sfdae_message.
struct CallResult {
  int status = SFDAE_OK;
  std::string message;
};

}  // namespace sfdae::core
