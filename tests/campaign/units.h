// Units in which a problem is stated: rows are multiplied, unknowns and time measured anew. Nothing of the theory
// depends on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "random_numbers.h"

namespace campaign {

struct Units {
  std::vector<double> rows;      // factors of the equations
  std::vector<double> unknowns;  // x = c x^, x^ is what the library sees
  double time = 1.0;             // t = time * s, s is the problem's own time

  Units() = default;
  Units(int m, int n) : rows(static_cast<std::size_t>(m), 1.0), unknowns(static_cast<std::size_t>(n), 1.0) {}
};

// Powers of ten up to 1e+-8 each, whole ones or any.
inline Units random_units(int m, int n, RandomNumbers& random) {
  Units units(m, n);
  const bool whole = random.chance(0.5);
  const auto power = [&] {
    return whole ? std::pow(10.0, random.integer(-8, 8)) : std::pow(10.0, random.uniform(-8.0, 8.0));
  };
  for (double& row : units.rows) row = power();
  for (double& unknown : units.unknowns) unknown = power();
  units.time = power();
  return units;
}

}  // namespace campaign
