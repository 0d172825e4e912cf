// A jump by impulses from values before a time to consistent ones after it (starts/impulses.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/matrix.h"

namespace sfdae::core {

struct Jump {
  std::vector<double> x;  // after, consistent
  Matrix impulses;        // n x mu: xi_0, xi_1, ...
};

// A jump and directions in which it moves, in the user's units.
struct MovingJump {
  double t, toward;
  const double *before, *after;  // n values
  std::vector<int> parameters;   // number of the parameter that each direction moves by 1, -1: none
  const double* shifts;          // of t
  ConstView moved;               // of the values before, n x directions
  int directions() const { return moved.cols; }
};

}  // namespace sfdae::core
