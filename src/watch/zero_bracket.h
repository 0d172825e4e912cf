// Bracket of the first point where one of several functions has lost its sign, narrowed by Illinois steps, and by
// bisection if they are slow. "before" and "after" refer to the direction of integration.
//
// M. Dowell, P. Jarratt: A modified regula falsi method for computing the root of an equation. BIT 11 (1971).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace sfdae::core {

class ZeroBracket {
 public:
  void resize(int count);
  // signs[i]: that of g_before[i], or 0 to ignore the function. At least one sign is lost at `after`, none at `before`.
  void start(const std::vector<int>& signs, double before, const std::vector<double>& g_before, double after,
             const std::vector<double>& g_after);
  static bool is_lost(int sign, double g) { return sign != 0 && sign * g <= 0.0; }
  bool is_lost(const std::vector<double>& g) const;

  // Width at which both ends count as one point.
  double resolution() const;
  bool is_resolved() const;
  // next(): point to evaluate; place() takes the values there, and returns true if it becomes the new end `after`.
  double next();
  bool place(double t, const std::vector<double>& g);
  double before() const { return before_; }
  double after() const { return after_; }
  const std::vector<double>& g_after() const { return g_after_; }

 private:
  double secant() const;

  std::vector<int> signs_;
  double before_ = 0.0, after_ = 0.0;
  std::vector<double> g_before_, g_after_;
  double floor_ = 0.0;      // minimum of the resolution
  double factor_ = 1.0;     // of g_before: turns the secant into the Illinois method
  int last_side_ = 0;       // end replaced last: -1 before, +1 after
  double old_width_ = 0.0;  // at the beginning of a round of steps
  int steps_ = 0;
  int slow_rounds_ = 0;  // rounds in which the width was not halved
};

}  // namespace sfdae::core
