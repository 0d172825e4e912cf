// Singular points of a solution: behavior in front of one, and smooth continuation
// (docs/design/events_and_switching.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "system/singular_part.h"
#include "watch/course_fit.h"
#include "watch/trail.h"

namespace sfdae::core {

// fold: the solution turns around with x' unbounded and ends; crossing: x is smooth, other branches may begin there;
// unbounded: differential variables grow without bound.
enum class SingularKind { unknown, fold, crossing, unbounded };

struct SingularPoint {
  double t = 0.0;
  SingularKind kind = SingularKind::unknown;
  SingularPart part = SingularPart::unknown;
  // The component of x that shows the kind, and the exponent of |t - t*| that it follows; component -1: none does.
  int component = -1;
  double exponent = 0.0;
  // If the point was passed: the last time before and the first one after it; otherwise t_after = t_before.
  double t_before = 0.0, t_after = 0.0;
  bool is_passed = false;
};

// Text for messages; begins with a space.
std::string description(const SingularPoint& point);

// Solution data in front of a singular point at t.
struct CourseData {
  const Trail& trail;
  double t, direction;
  std::vector<double> tolerances;       // n, of x
  std::vector<char> is_differentiated;  // n flags
};

// The smooth continuation: polynomials through nodes at distances up to `width` from the singular point.
struct SmoothCourse {
  CourseFit fit;
  double width;
  std::vector<int> degrees;    // of the components; -1: not smooth
  std::vector<double> errors;  // expected an eighth of the width after the point, in tolerances
};

// Empty if the solution in front of the point is not smooth enough for the tolerances.
std::optional<SmoothCourse> smooth_course(const CourseData& data);
// Sets kind, component and exponent, from the data and their smooth continuation.
void classify(const CourseData& data, const std::optional<SmoothCourse>& course, SingularPoint& point);

}  // namespace sfdae::core
