// State of a run across modes.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "integrate/integration.h"
#include "sfdae/hybrid.h"

namespace sfdae::core {

// Sums over the visits of a mode.
struct VisitCounts {
  double duration = 0.0;
  long visits = 0, steps = 0, error_failures = 0, other_failures = 0, reductions = 0, factorizations = 0;
  double smallest_kept = 0.0, consistency = 0.0, rounding = 0.0;
  void add(const IntegrationCounts& counts);
};

// The visit of the present mode.
struct ModeVisit {
  double entered = 0.0;
  bool is_fresh = false;  // conditions of the mode have not been tested since it was entered
  const Integration* integration = nullptr;
  double short_time = 0.0;  // in which x moves only by a few tolerances
};

// The last visits that were all shorter than their short_time.
struct ShortVisits {
  long count = 0;
  double first = 0.0;
};

// Transitions of the run: those before a checkpoint are only counted.
struct PassageList {
  long forgotten = 0;
  std::vector<sfdae_passage> known;
  long count() const { return forgotten + static_cast<long>(known.size()); }
};

// Values at the last transition.
struct ValuesAtTransition {
  std::vector<double> before, after, impulse;
};

// With sensitivities: dt/dp of the last transition, 0 at the start, and the derivatives of the values there including
// dt/dp, width() per parameter. With the adjoint: for all columns that span S.
struct MovingValues {
  std::vector<double> shifts, moved;
  double time_before = 0.0;  // time scale of x before the transition
};

// t, x, xdot: the point reached; if there are switches, the part of the mode above is appended.
struct HybridRun {
  int mode = -1;
  double start = 0.0, toward = 0.0;
  double t = 0.0;
  std::vector<double> x, xdot;
  ModeVisit visit;
  ShortVisits short_visits;
  PassageList passages;
  ValuesAtTransition last;
  MovingValues moving;
  std::optional<double> accumulation;
  CallResult warning;  // the first one of the call
  double direction() const { return toward < start ? -1.0 : 1.0; }
  // End of the run, or a time just after t if the end has been passed.
  double toward_from() const;
};

}  // namespace sfdae::core
