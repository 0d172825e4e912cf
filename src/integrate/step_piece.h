// A piece of an integration: steps that are kept, or a checkpoint from which they are made again.
//
// Steps are made again by what the stepper was asked for, attempt by attempt, those that failed included, as the
// system remembers them. Nothing is decided anew, so that events, outputs, stops and whatever else the driver had to
// do with need not come again, and the same bits come out: the checkpoint has all that the next step depends on
// (checkpoint.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "integrate/companion.h"
#include "integrate/kept_steps.h"

namespace sfdae::core {

struct Attempt {
  double t;
  AttemptEnd end;
  double part;  // of the tolerances (ErrorWeights)
};

struct StepPiece {
  std::size_t first = 0;           // number of its first point
  std::size_t count = 0;           // of points
  std::size_t origin = 0;          // the point at which the history of BDF starts
  KeptSteps kept;                  // those of all points, or none: they have been dropped
  bool has_failures = false;       // evaluations have failed in a step that was taken: it is not made again
  bool begins_anew = false;        // no step leads to its first point
  std::vector<KeptPoint> before;   // the last points before, the newest first; but for that one x alone
  std::vector<double> checkpoint;  // of the first point, or of the one before; empty: steps are kept
  Method method = Method::bdf;
  double direction = 1.0;
  std::shared_ptr<const IntegrationOptions> options;
  std::vector<Attempt> attempts;

  bool is_dropped() const { return kept.count() < count; }
  std::size_t bytes() const {
    std::size_t sum = kept.bytes() + sizeof(double) * checkpoint.capacity() + sizeof(Attempt) * attempts.capacity();
    for (const KeptPoint& point : before) sum += bytes_of(point);
    return sum;
  }
  // After the steps of another one: what points within its first steps depend on.
  void follow(const StepPiece& last, std::size_t most);
  // The integrator as it is now.
  void save(Integrator& integrator);
};

// The steps of a piece. times: of all points. Throws Failure, where functions of the user's do not return what they
// have returned, too.
KeptSteps steps_made_again(const StepPiece& piece, const std::vector<double>& times, SystemTwin& twin);

}  // namespace sfdae::core
