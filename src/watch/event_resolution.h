// Whether steps are short enough to show what event functions do.
//
// Steps are as long as w = W x allows. Algebraic components may vary many times within one, and the polynomials of
// the step, which go through its ends, show nothing of that.
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
  // Nothing is known of steps before.
  void start() { num_points_ = 0, halvings_ = 0, misleading_ = 0.0; }
  // A step begins at t, with values g.
  void begin_step(double t, const std::vector<double>& g);
  // Whether g at its end is what the points where steps began lead to expect: a polynomial through them is off by a
  // small part of what g would have to change by to become zero.
  bool expects(double t, const std::vector<double>& g) const;

  // Functions that are looked at from now on: others may be nothing but rounding errors, which no polynomial follows.
  template <class Predicate>
  void look_at(Predicate is_armed) {
    for (std::size_t i = 0; i < looks_at_.size(); ++i) looks_at_[i] = is_armed(i);
  }
  bool looks_at(std::size_t i) const { return looks_at_[i]; }

  // Whether steps of length h may be as misleading as one before, and whether they are as long as that: points at
  // regular distances can hide it.
  bool is_suspicious(double h) const;
  bool is_misleading(double h) const { return misleading_ > 0.0 && std::fabs(h) >= misleading_; }
  // How often the step is halved, whatever its order; 0: its polynomials are good enough.
  int halvings() const { return halvings_; }
  // Begins to look at the rates of change of g along a step of length h, and ends: halvings() follows.
  void start_rates();
  void add_rate(double delta, const std::vector<double>& g, const std::vector<double>& g_after_delta);
  void take_rates(double h);

  void archive(Archive& archive);

 private:
  static constexpr std::size_t most_points = 4;
  std::array<double, most_points> t_{};
  std::array<std::vector<double>, most_points> g_;  // the newest first
  std::size_t num_points_ = 0;
  int halvings_ = 0;
  double misleading_ = 0.0;  // a step whose polynomials said nothing, the shortest one of late; 0: none
  std::vector<bool> looks_at_;
  std::vector<double> sizes_, rates_;  // the largest ones, for each function
};

}  // namespace sfdae::core
