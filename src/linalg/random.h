// Random numbers for trial perturbations: the same ones in every run and with every standard library.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

namespace sfdae::core {

// From -1 to 1, in steps of 2e-9.
inline double symmetric_random(std::minstd_rand& generator) {
  return 2e-9 * static_cast<double>(generator() % 1000000001u) - 1.0;
}

}  // namespace sfdae::core
