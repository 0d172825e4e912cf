// Decision whether a new linearization pays for the next step of a mechanical system.
// SPDX-License-Identifier: BSD-3-Clause
#include "multibody/multibody_renewal.h"

namespace sfdae::core {

bool MultibodyRenewal::pays(int s, int iterations, double cost) {
  // After so many new linearizations in a row one is reused: a tenth of the steps tests whether that suffices.
  constexpr int most_in_a_row = 10;
  if (is_fresh_) {
    fresh_iterations_ = iterations;
    if (fresh_in_a_row_ < most_in_a_row) ++fresh_in_a_row_;
    else fresh_in_a_row_ = kept_iterations_ = 0;
  } else {
    kept_iterations_ = iterations;
  }
  is_fresh_ = false;
  return s * (kept_iterations_ - fresh_iterations_) >= cost;
}

}  // namespace sfdae::core
