// SPDX-License-Identifier: BSD-3-Clause
// Four-bar mechanism in space: masses at the ends (p1, p2) of a crank and of a rocker, which turn around the z axis
// at the origin and at (base, 0, 0), and a coupler between them. Every joint keeps its bar normal to the z axis,
// which says once more than needed that the mechanism is plane: 6 constraints of rank 5, one degree of freedom.
//
//   0 = |p1|^2 - a^2,  0 = |p2 - p1|^2 - b^2,  0 = |p2 - (base, 0, 0)|^2 - c^2,  0 = z1,  0 = z2 - z1,  0 = z2
#ifndef SFDAE_TESTS_MULTIBODY_FOUR_BAR_H
#define SFDAE_TESTS_MULTIBODY_FOUR_BAR_H

#include <cmath>

#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

struct FourBar : MechanicalSystem {
  static constexpr double a = 1.0, b = 2.0, c = 2.5, base = 3.0, m1 = 1.0, m2 = 2.0, gravity = 9.81;

  FourBar() : MechanicalSystem({6, 6, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    for (int i = 0; i < 6; ++i) M[7 * i] = V(i < 3 ? m1 : m2);
  }
  template <class V>
  void force(const V&, const V*, const V*, V* f) const {
    f[1] = V(-m1 * gravity);
    f[4] = V(-m2 * gravity);
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    const V dx = q[3] - q[0], dy = q[4] - q[1], dz = q[5] - q[2], x = q[3] - base;
    g[0] = square(q[0]) + square(q[1]) + square(q[2]) - a * a;
    g[1] = square(dx) + square(dy) + square(dz) - b * b;
    g[2] = square(x) + square(q[4]) + square(q[5]) - c * c;
    g[3] = q[2];
    g[4] = dz;
    g[5] = q[5];
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    for (int k = 0; k < 3; ++k) {
      const V d = 2.0 * (q[3 + k] - q[k]);
      G[0 + 6 * k] = 2.0 * q[k];
      G[1 + 6 * k] = -d;
      G[1 + 6 * (3 + k)] = d;
      G[2 + 6 * (3 + k)] = 2.0 * (k == 0 ? q[3] - base : q[3 + k]);
    }
    G[3 + 6 * 2] = V(1.0);
    G[4 + 6 * 2] = V(-1.0);
    G[4 + 6 * 5] = V(1.0);
    G[5 + 6 * 5] = V(1.0);
  }
  static double energy(const double* q, const double* v) {
    const auto speed = [v](int i) { return v[i] * v[i] + v[i + 1] * v[i + 1] + v[i + 2] * v[i + 2]; };
    return 0.5 * (m1 * speed(0) + m2 * speed(3)) + gravity * (m1 * q[1] + m2 * q[4]);
  }
};

// The same in the plane, without what is redundant.
struct PlaneFourBar : MechanicalSystem {
  PlaneFourBar() : MechanicalSystem({4, 3, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    for (int i = 0; i < 4; ++i) M[5 * i] = V(i < 2 ? FourBar::m1 : FourBar::m2);
  }
  template <class V>
  void force(const V&, const V*, const V*, V* f) const {
    f[1] = V(-FourBar::m1 * FourBar::gravity);
    f[3] = V(-FourBar::m2 * FourBar::gravity);
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    const V dx = q[2] - q[0], dy = q[3] - q[1], x = q[2] - FourBar::base;
    g[0] = square(q[0]) + square(q[1]) - FourBar::a * FourBar::a;
    g[1] = square(dx) + square(dy) - FourBar::b * FourBar::b;
    g[2] = square(x) + square(q[3]) - FourBar::c * FourBar::c;
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    for (int k = 0; k < 2; ++k) {
      const V d = 2.0 * (q[2 + k] - q[k]);
      G[0 + 3 * k] = 2.0 * q[k];
      G[1 + 3 * k] = -d;
      G[1 + 3 * (2 + k)] = d;
      G[2 + 3 * (2 + k)] = 2.0 * (k == 0 ? q[2] - FourBar::base : q[2 + k]);
    }
  }
};

// At rest with the crank upright; p2 is the intersection of two circles that lies above.
inline std::vector<double> four_bar_start(bool in_space) {
  const double dx = FourBar::base, dy = -FourBar::a, distance = std::hypot(dx, dy);
  const double along = (FourBar::b * FourBar::b - FourBar::c * FourBar::c + distance * distance) / (2.0 * distance);
  const double across = std::sqrt(FourBar::b * FourBar::b - along * along);
  const double x2 = (along * dx - across * dy) / distance, y2 = FourBar::a + (along * dy + across * dx) / distance;
  std::vector<double> x = {0.0, FourBar::a, 0.0, x2, y2, 0.0};
  if (!in_space) x = {0.0, FourBar::a, x2, y2};
  x.resize(in_space ? 18 : 11, 0.0);
  return x;
}

}  // namespace sfdae_test

#endif
