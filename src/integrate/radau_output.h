// Points within the last step of a Radau method: its collocation polynomial; where that is not accurate enough Hermite
// polynomials through nodes, and nodes within the step where these are not
// (docs/design/radau.md, error_control.md).
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

// What is computed anew for every step or point.
struct RadauWorkspace {
  HermiteTable table;
  RadauGuess guess;
  StepScales scales;
};

class RadauOutput {
 public:
  void resize(const StrangenessFreeSystem& system, int most_stages);
  // The history has another last step, or none.
  void note_step(const RadauHistory& history);

  // Of the collocation polynomial: whether it is accurate enough for w, and for x without constraints to help; and up
  // to which step size the former would be.
  bool interpolates_well() const { return interpolates_well_; }
  bool interpolates_x(const RadauHistory& history) const;
  // stages: of the next step, of which more make up for its length. Hermite polynomials are trusted where there are
  // nodes enough, until they fail.
  double longest_interpolated(const RadauHistory& history, int stages) const {
    const bool has_hermite = !interpolates_well_ && history.count() > stages && history.inner_count() == 0;
    return has_hermite || stages > history.polynomial().stages() ? std::numeric_limits<double>::infinity() : longest_;
  }
  std::optional<double> point_of_test(const RadauHistory& history) const;
  // By the weights of the step; else the polynomial has passed a test.
  bool gives_up_polynomial(RadauHistory& history, const ErrorWeights& weights, const double* interpolated,
                           const double* x);
  Guess guess_within(const RadauHistory& history, double t, int order);

  void interpolate(const RadauHistory& history, HermiteTable& table, const PointValues& point);
  // Moves the system to the point. Where the polynomial for w is not accurate enough the stages of a step to the point
  // are solved.
  PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point,
                     RadauHistory& history, RadauWorkspace& workspace);

 private:
  // Sets within_.end at t. Where that fails t is the stage that does.
  PointStatus solve_within(StrangenessFreeSystem& system, ErrorWeights& weights, const RadauHistory& history,
                           RadauWorkspace& workspace, double target);

  bool is_linear_ = true;
  bool interpolates_well_ = false;
  double longest_ = std::numeric_limits<double>::infinity();
  RadauStep within_;
  RadauNode from_;  // where it starts
  std::vector<double> contribution_, mapped_;
  TaylorGuess guess_;
};

}  // namespace sfdae::core
