// Characteristic ranks of a mechanical system at a point: the ranks of its constraints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "multibody/multibody_partition.h"
#include "multibody/multibody_problem.h"
#include "reduction/index_analysis.h"

namespace sfdae::core {

struct MultibodyRanks {
  int positions = 0;   // rank g_q
  int velocities = 0;  // rank C
  bool operator==(const MultibodyRanks&) const = default;
};
CharacteristicValues characteristic_values(const MultibodySizes& sizes, const MultibodyRanks& ranks);

// Settings that are decided before an integration.
struct MultibodySettings {
  MultibodyRanks ranks;
  Coordinates coordinates = Coordinates::orthogonal;
  double rank_tol = 0.0;  // by which the ranks were decided; 0: by rounding errors
};

}  // namespace sfdae::core
