// Resolution of event functions: tests whether steps are short enough.
//
// The step size depends on the errors of w = W x. Algebraic components may vary many times within a step, and the
// polynomials of the step, which interpolate its ends, do not show it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "linalg/archive.h"

namespace sfdae::core {

class EventResolution {
 public:
  void resize(std::size_t functions);
  // Forgets all previous steps.
  void start() { num_points_ = 0, halvings_ = 0, misleading_ = 0.0; }
  // A step begins at t, with values g.
  void begin_step(double t, const std::vector<double>& g);
  // True if g at the end of the step agrees with extrapolation from the starts of previous steps: the deviation is a
  // small part of the change that would make g zero.
  bool expects(double t, const std::vector<double>& g) const;

  // Restricts the tests to these functions: others may be dominated by roundoff, which no polynomial follows.
  template <class Predicate>
  void look_at(Predicate is_armed) {
    for (std::size_t i = 0; i < looks_at_.size(); ++i) looks_at_[i] = is_armed(i);
  }
  bool looks_at(std::size_t i) const { return looks_at_[i]; }

  // is_suspicious(): a step of length h may mislead like an earlier one. is_misleading(): it is as long as that one;
  // equidistant points can hide variations.
  bool is_suspicious(double h) const;
  bool is_misleading(double h) const { return misleading_ > 0.0 && std::fabs(h) >= misleading_; }
  // Number of halvings of the step in a search, whatever its order; 0: its polynomials are accurate enough.
  int halvings() const { return halvings_; }
  // start_rates() and take_rates() enclose the sampling of rates of change of g along a step; then halvings() is set.
  void start_rates();
  void add_rate(double delta, const std::vector<double>& g, const std::vector<double>& g_after_delta);
  void take_rates(double h);

  void archive(Archive& archive);

 private:
  static constexpr std::size_t most_points = 4;
  std::array<double, most_points> t_{};
  std::array<std::vector<double>, most_points> g_;  // newest first
  std::size_t num_points_ = 0;
  int halvings_ = 0;
  double misleading_ = 0.0;  // length of the shortest recent step whose polynomials were misleading; 0: none
  std::vector<bool> looks_at_;
  std::vector<double> sizes_, rates_;  // largest ones of each function
};

}  // namespace sfdae::core
