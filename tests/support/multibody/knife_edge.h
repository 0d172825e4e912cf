// SPDX-License-Identifier: BSD-3-Clause
// A skate on an inclined plane, q = (x, y, phi): it glides along its edge only, 0 = x' sin phi - y' cos phi. mu = 1.
//
// Started at rest at the origin with phi' = omega it never leaves a strip: with k = gravity / (2 omega^2)
//   x = k sin^2(omega t),  y = k (omega t - sin(2 omega t) / 2),  phi = omega t,  kappa = 2 gravity sin(omega t).
// [NF72] Ju. I. Neimark, N. A. Fufaev: Dynamics of Nonholonomic Systems. AMS, 1972.
#ifndef SFDAE_TESTS_MULTIBODY_KNIFE_EDGE_H
#define SFDAE_TESTS_MULTIBODY_KNIFE_EDGE_H

#include <cmath>

#include "system.h"

namespace sfdae_test {

struct KnifeEdge : MechanicalSystem {
  static constexpr double gravity = 5.0, inertia = 0.5, omega = 1.5;

  KnifeEdge() : MechanicalSystem({3, 0, 1}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    M[0] = M[4] = V(1.0);
    M[8] = V(inertia);
  }
  template <class V>
  void force(const V&, const V*, const V*, V* f) const {
    f[0] = V(gravity);
  }
  template <class V>
  void constraints(const V&, const V*, V*) const {}
  template <class V>
  void gradient(const V&, const V*, V*) const {}
  template <class V>
  void nonholonomic(const V&, const V* q, V* H, V*) const {
    using std::sin, std::cos;
    H[0] = sin(q[2]);
    H[1] = -cos(q[2]);
  }

  // (q, v, kappa)
  static std::vector<double> exact(double t) {
    const double k = gravity / (2.0 * omega * omega), angle = omega * t, s = std::sin(angle), c = std::cos(angle);
    return {k * s * s, k * (angle - s * c), angle, 2.0 * k * omega * s * c, 2.0 * k * omega * s * s,
            omega,     2.0 * gravity * s};
  }
};

}  // namespace sfdae_test

#endif
