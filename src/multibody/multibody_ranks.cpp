// Characteristic ranks of a mechanical system at a point.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_ranks.h"

namespace sfdae::core {

CharacteristicValues characteristic_values(const MultibodySizes& sizes, const MultibodyRanks& ranks) {
  CharacteristicValues values;
  values.mu = sizes.holonomic > 0 ? 2 : sizes.nonholonomic > 0 ? 1 : 0;
  values.d = sizes.positions - ranks.positions + sizes.velocities - ranks.velocities;
  values.a = sizes.unknowns() - values.d;
  values.u = values.v = 0;
  return values;
}

}  // namespace sfdae::core
