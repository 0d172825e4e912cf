// Values of the formulas of a mechanical system at several points, side by side; S is the identity, and there are no
// nonholonomic constraints. Matrices consist of the entries that can differ from zero.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/lanes.h"

namespace sfdae::core {

struct LaneMatrix {
  struct Place {
    int row, column;
  };
  std::vector<Place> places;
  LaneArray entries;
  void resize() { entries.resize(places.size() + 1); }
};

struct MultibodyLaneTerms {
  LaneMatrix M, C;
  bool has_diagonal_mass = false;  // whatever the values are
  bool is_rheonomic = false;       // else r = 0
  LaneArray g, f;
  LaneArray velocity_rest;      // r
  LaneArray acceleration_rest;  // s
};

}  // namespace sfdae::core
