// State of an integration at singular points: the points before one, and the passage across the last one.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "watch/singular_point.h"
#include "watch/trail.h"

namespace sfdae::core {

// Passage from the last point before a singular one to the first one after it.
class Passage {
 public:
  struct Point {
    double t;
    std::vector<double> x;
  };
  Passage(SmoothCourse course, Point before, Point after)
      : course_(std::move(course)), before_(std::move(before)), after_(std::move(after)) {}

  // True if t lies between both points.
  bool has(double t) const { return (t - before_.t) * (after_.t - t) > 0.0; }
  // Fits for smooth components, corrected linearly to meet both points; linear for others. xdot may be null.
  void evaluate(double t, double* x, double* xdot) const;

 private:
  SmoothCourse course_;
  Point before_, after_;
};

struct Branches {
  Trail trail;
  std::optional<SingularPoint> point;  // last one met, passed or not
  std::optional<Passage> passage;      // the last one
  long passed = 0;
  std::string refusal;  // reason why the point met last was not passed; empty: passing was not requested
  // Near a suspected singular point, steps up to this time are short, to resolve the solution.
  struct FineSteps {
    double until, step;
  };
  std::optional<FineSteps> fine;
};

}  // namespace sfdae::core
