// Equality of times up to roundoff: of outputs, samples, switches and the time reached.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace sfdae::cli {

class TimeRounding {
 public:
  // interval: length of the simulation.
  explicit TimeRounding(double interval) : interval_(interval) {}

  // The rounding error bound of t; size: magnitude of the largest number that t was computed from.
  double of(double t, double size = 0.0) const {
    return relative * std::max({std::fabs(t), std::fabs(size), part_of_interval * interval_});
  }
  bool is_same(double a, double b) const { return std::fabs(a - b) <= of(a, b); }

  // True if an event planned for t is due at the time reached, or overdue.
  bool is_due(double t, double reached) const { return t <= reached || is_same(t, reached); }

 private:
  // Near 0, the bound is relative to this part of the interval.
  static constexpr double relative = 1e-14, part_of_interval = 0.01;

  double interval_;
};

}  // namespace sfdae::cli
