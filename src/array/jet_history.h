// The jets of the last two accepted points, and predictions of other jets from them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/archive.h"
#include "linalg/units.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class JetHistory {
 public:
  // All jets are of this size.
  void resize(int n, int order);
  // Sets both points to this one.
  void restart(const Jet& jet) { accepted_ = before_ = jet; }
  // Adds the next point, or replaces the last accepted one if it has been solved again.
  void accept(const Jet& jet);
  const Jet& accepted() const { return accepted_; }
  bool has_two() const { return before_.t != accepted_.t; }
  // True if t is ahead of the last accepted point or, if there is only one, differs from it.
  bool is_beyond(double t) const {
    return has_two() ? (t - accepted_.t) * (accepted_.t - before_.t) > 0.0 : t != accepted_.t;
  }
  // The nearer one of the two points.
  const Jet& nearest(double t) const;

  // Interpolates the jet at t linearly between the two points, as a starting value.
  void interpolate(double t, Jet& jet) const;
  // Predicts the jet at its t from a block of the guess. determined: flags of the components of y.
  void predict(const Guess& guess, int block, const std::vector<char>& determined, const Units& units,
               Jet& jet) const;
  // Sets the derivatives of the jet to those of the last accepted point.
  void hold_derivatives(Jet& jet) const {
    std::copy(accepted_.x.begin() + jet.n, accepted_.x.end(), jet.x.begin() + jet.n);
  }

  void archive(Archive& archive);

 private:
  void predict_between(const Guess& guess, const double* taylor, const std::vector<char>& determined, Jet& jet) const;

  Jet accepted_, before_;
};

}  // namespace sfdae::core
