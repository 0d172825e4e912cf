// Points within the last step of a Radau method: Hermite polynomials through nodes, and nodes within the step where
// they are not accurate enough (docs/decisions/13-radau-points-within-steps.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/hermite_table.h"
#include "integrate/radau_guess.h"
#include "integrate/radau_history.h"
#include "integrate/radau_stages.h"
#include "integrate/step_scales.h"

namespace sfdae::core {

// What is computed anew for every step or point.
struct RadauWorkspace {
  HermiteTable table;
  RadauGuess guess;
  StepScales scales;
};

class RadauOutput {
 public:
  void resize(std::size_t n, std::size_t size_w, int most_stages);
  // Leaves the polynomial for w in the table.
  void interpolate(const RadauHistory& history, HermiteTable& table, const PointValues& point);
  // Moves the system to the point interpolated last. Where the polynomial for w, still in the table, is not accurate
  // enough, the stages of a step to the point are solved.
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point,
                     RadauHistory& history, RadauWorkspace& workspace);

 private:
  // Sets within_.end at t. Where that fails t is the stage that does.
  PointStatus solve_within(StrangenessFreeSystem& system, ErrorWeights& weights, const RadauHistory& history,
                           RadauWorkspace& workspace, double& t);

  RadauStep within_;
  RadauNode from_;  // where it starts
  std::vector<double> contribution_, mapped_;
};

}  // namespace sfdae::core
