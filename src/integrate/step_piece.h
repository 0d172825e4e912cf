// Piece of an integration: stored steps, or a checkpoint from which they are repeated.
//
// Steps are repeated by the same sequence of attempts, including failed ones, because the system remembers them. No
// decision is repeated, so events, outputs, stops and other tasks of the driver are not needed, and the results agree
// bitwise: the checkpoint contains all data on which the next step depends (checkpoint.h).
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
  std::size_t origin = 0;          // the point at which the BDF history starts
  KeptSteps kept;                  // those of all points; empty: they have been dropped
  bool has_failures = false;       // evaluations have failed in a step that was taken: it is never repeated
  bool begins_anew = false;        // no step leads to its first point
  std::vector<KeptPoint> before;   // the last points before, the newest first; only that one has more than x
  std::vector<double> checkpoint;  // of the first point, or of the one before; empty: steps are stored
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
  // Takes the points of the previous piece on which points within the first steps depend.
  void follow(const StepPiece& last, std::size_t most);
  // Saves the current state of the integrator.
  void save(Integrator& integrator);
};

// Repeats the steps of a piece. times: of all points. Throws Failure, also if user-supplied functions return other
// values than before.
KeptSteps steps_made_again(const StepPiece& piece, const std::vector<double>& times, SystemTwin& twin);

}  // namespace sfdae::core
