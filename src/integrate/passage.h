// What an integration knows of branches of its solution: the way to a singular point, and the passage across the last
// one.
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

// From the last point before a singular one to the first one after it.
class Passage {
 public:
  struct Point {
    double t;
    std::vector<double> x;
  };
  Passage(SmoothCourse course, Point before, Point after)
      : course_(std::move(course)), before_(std::move(before)), after_(std::move(after)) {}

  // t lies after the one and before the other.
  bool has(double t) const { return (t - before_.t) * (after_.t - t) > 0.0; }
  // The polynomials of what is smooth, and a line for the rest, through both points. xdot may be null.
  void evaluate(double t, double* x, double* xdot) const;

 private:
  SmoothCourse course_;
  Point before_, after_;
};

struct Branches {
  Trail trail;
  std::optional<SingularPoint> point;  // met last, passed or not
  std::optional<Passage> passage;      // the last one
  long passed = 0;
  std::string refusal;  // why the point met last was not passed; empty: nobody asked for that
  // Steps about a suspected singular point, up to this time, are so short that they tell what the solution does.
  struct FineSteps {
    double until, step;
  };
  std::optional<FineSteps> fine;
};

}  // namespace sfdae::core
