// SPDX-License-Identifier: BSD-3-Clause
// Plane five-bar linkage: uniform links of lengths l1, ..., l4 at angles q1, ..., q4, two arms (1, 2) and (3, 4) from
// hinges at the origin and at (base, 0), whose ends are pinned together; gravity, a torsion spring at each ground
// hinge and a torque on link 1 that oscillates. Two degrees of freedom.
//
//   0 = l1 cos q1 + l2 cos q2 - base - l3 cos q3 - l4 cos q4,   0 = l1 sin q1 + l2 sin q2 - l3 sin q3 - l4 sin q4
#ifndef SFDAE_TESTS_MULTIBODY_FIVE_BAR_H
#define SFDAE_TESTS_MULTIBODY_FIVE_BAR_H

#include <cmath>
#include <vector>

#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

struct FiveBar : MechanicalSystem {
  static constexpr double length[] = {1.0, 1.5, 0.9, 1.6}, link_mass[] = {1.0, 1.4, 0.8, 1.5}, base = 1.2;
  static constexpr double gravity = 9.81, stiffness = 15.0, torque = 4.0, rate = 3.0;

  FiveBar() : MechanicalSystem({4, 2, 0}) {}
  // Of each arm that of a double pendulum.
  template <class V>
  void mass(const V&, const V* q, V* M) const {
    using std::cos;
    for (int arm = 0; arm < 4; arm += 2) {
      const double inner = length[arm], outer = length[arm + 1], m = link_mass[arm + 1];
      const V coupling = 0.5 * m * inner * outer * cos(q[arm] - q[arm + 1]);
      M[5 * arm] = V((link_mass[arm] / 3.0 + m) * inner * inner);
      M[5 * arm + 1] = coupling;
      M[5 * arm + 4] = coupling;
      M[5 * arm + 5] = V(m / 3.0 * outer * outer);
    }
  }
  template <class V>
  void force(const V& t, const V* q, const V* v, V* f) const {
    using std::cos, std::sin;
    for (int arm = 0; arm < 4; arm += 2) {
      const double inner = length[arm], outer = length[arm + 1], m = link_mass[arm + 1];
      const V coupling = 0.5 * m * inner * outer * sin(q[arm] - q[arm + 1]);
      f[arm] = -1.0 * coupling * square(v[arm + 1]) - (0.5 * link_mass[arm] + m) * gravity * inner * cos(q[arm]) -
               stiffness * (q[arm] - 1.5);
      f[arm + 1] = coupling * square(v[arm]) - 0.5 * m * gravity * outer * cos(q[arm + 1]);
    }
    f[0] = f[0] + torque * sin(rate * t);
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    using std::cos, std::sin;
    g[0] = length[0] * cos(q[0]) + length[1] * cos(q[1]) - base - length[2] * cos(q[2]) - length[3] * cos(q[3]);
    g[1] = length[0] * sin(q[0]) + length[1] * sin(q[1]) - length[2] * sin(q[2]) - length[3] * sin(q[3]);
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    using std::cos, std::sin;
    for (int j = 0; j < 4; ++j) {
      const double l = j < 2 ? length[j] : -length[j];
      G[2 * j] = -l * sin(q[j]);
      G[2 * j + 1] = l * cos(q[j]);
    }
  }
};

// At rest, the inner links at 1.9 and 1.3; the outer ones meet above.
inline std::vector<double> five_bar_start() {
  const double q1 = 1.9, q3 = 1.3;
  const double x1 = FiveBar::length[0] * std::cos(q1), y1 = FiveBar::length[0] * std::sin(q1);
  const double dx = FiveBar::base + FiveBar::length[2] * std::cos(q3) - x1,
               dy = FiveBar::length[2] * std::sin(q3) - y1;
  const double r2 = FiveBar::length[1], r4 = FiveBar::length[3], distance = std::hypot(dx, dy);
  const double along = (r2 * r2 - r4 * r4 + distance * distance) / (2.0 * distance);
  const double across = std::sqrt(r2 * r2 - along * along), direction = std::atan2(dy, dx);
  const double q2 = direction + std::atan2(across, along), q4 = direction + std::atan2(across, along - distance);
  std::vector<double> x = {q1, q2, q3, q4};
  x.resize(10, 0.0);
  return x;
}

}  // namespace sfdae_test

#endif
