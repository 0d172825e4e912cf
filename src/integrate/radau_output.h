// Points within the last step of a Radau method: by its collocation polynomial, if that is inaccurate by Hermite
// polynomials through nodes, and if these are inaccurate by nodes within the step (docs/design/radau.md,
// error_control.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "integrate/hermite_table.h"
#include "integrate/radau_guess.h"
#include "integrate/radau_history.h"
#include "integrate/radau_stages.h"
#include "integrate/step_scales.h"
#include "integrate/taylor_guess.h"

namespace sfdae::core {

// Work arrays that are recomputed for every step or point.
struct RadauWorkspace {
  HermiteTable table;
  RadauGuess guess;
  StepScales scales;
};

class RadauOutput {
 public:
  void resize(const StrangenessFreeSystem& system, int most_stages);
  // Updates this object after the last step of the history has changed.
  void note_step(const RadauHistory& history);

  // interpolates_well(): the collocation polynomial is accurate enough for w; interpolates_x(): also for x without
  // constraints.
  bool interpolates_well() const { return interpolates_well_; }
  bool interpolates_x(const RadauHistory& history) const;
  // Largest step size for which it would be. stages: of the next step; more stages than before allow longer steps.
  // Hermite polynomials are trusted if there are enough nodes, until they fail.
  double longest_interpolated(const RadauHistory& history, int stages) const {
    const bool has_hermite = !interpolates_well_ && history.count() > stages && history.inner_count() == 0;
    return has_hermite || stages > history.polynomial().stages() ? std::numeric_limits<double>::infinity() : longest_;
  }
  std::optional<double> point_of_test(const RadauHistory& history) const;
  // By the weights of the step; if false, the polynomial has passed a test.
  bool gives_up_polynomial(RadauHistory& history, const ErrorWeights& weights, const double* interpolated,
                           const double* x);
  Guess guess_within(const RadauHistory& history, double t, int order);

  void interpolate(const RadauHistory& history, HermiteTable& table, const PointValues& point);
  // Moves the system to the point. If the polynomial for w is inaccurate, the stages of a step to the point are
  // computed.
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point,
                     RadauHistory& history, RadauWorkspace& workspace);

 private:
  // Computes within_.end at t by a shorter step.
  PointStatus solve_within(StrangenessFreeSystem& system, ErrorWeights& weights, const RadauHistory& history,
                           RadauWorkspace& workspace, double target);

  bool is_linear_ = true;
  bool interpolates_well_ = false;
  double longest_ = std::numeric_limits<double>::infinity();
  RadauStep within_;
  RadauNode from_;  // start of that step
  std::vector<double> contribution_, mapped_;
  TaylorGuess guess_;
};

}  // namespace sfdae::core
