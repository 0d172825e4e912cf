// The jets of the last two accepted points, and the guesses of others that they give.
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
  // Both points are this one.
  void restart(const Jet& jet) { accepted_ = before_ = jet; }
  // The next point, or the one accepted last as it has been solved again.
  void accept(const Jet& jet);
  const Jet& accepted() const { return accepted_; }
  bool has_two() const { return before_.t != accepted_.t; }
  // Where no point has been accepted yet: ahead of the last one or, where that is the only one, anywhere else.
  bool is_beyond(double t) const {
    return has_two() ? (t - accepted_.t) * (accepted_.t - before_.t) > 0.0 : t != accepted_.t;
  }
  // The nearer one of the two.
  const Jet& nearest(double t) const;

  // The jet := that at t linear between the two points, good enough to start from.
  void interpolate(double t, Jet& jet) const;
  // The jet at its t := what a block of the guess says; determined: flags of the components of y.
  void predict(const Guess& guess, int block, const std::vector<char>& determined, const Units& units,
               Jet& jet) const;
  // The derivatives of the jet := those of the point accepted last.
  void hold_derivatives(Jet& jet) const {
    std::copy(accepted_.x.begin() + jet.n, accepted_.x.end(), jet.x.begin() + jet.n);
  }

  void archive(Archive& archive);

 private:
  void predict_between(const Guess& guess, const double* taylor, const std::vector<char>& determined, Jet& jet) const;

  Jet accepted_, before_;
};

}  // namespace sfdae::core
