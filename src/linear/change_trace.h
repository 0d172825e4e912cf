// Quantities that reveal a change of the characteristic values, at the points that a step went through.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "linalg/index.h"
#include "linear/linear_point.h"
#include "system/stage_method.h"

namespace sfdae::core {

struct ChangeTrace {
  double t = 0.0;
  bool orientation_kept = true;
  double kept_constraints = 1.0, kept_differential = 1.0;
  std::vector<double> row_norms;  // largest entries of the rows of [E A], unscaled

  void take(const LinearPoint& point, bool is_orientation_kept) {
    t = point.t;
    orientation_kept = is_orientation_kept;
    kept_constraints = point.kept_constraints;
    kept_differential = point.kept_of_rows();
    row_norms.assign(point.data.row_norm.begin(), point.data.row_norm.end());
  }
};

// Traces of all stages of a Runge-Kutta step except the last one, which is the current point; none after steps of other
// methods.
struct StageTraces {
  std::array<ChangeTrace, max_stages - 1> of_stage;
  int count = 0;
  const ChangeTrace& operator[](int i) const { return of_stage[index(i)]; }
};

}  // namespace sfdae::core
