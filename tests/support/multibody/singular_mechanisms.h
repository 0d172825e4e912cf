// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms whose configurations become singular while their motion stays smooth, with exact motions by one angle.
#ifndef SFDAE_TESTS_MULTIBODY_SINGULAR_MECHANISMS_H
#define SFDAE_TESTS_MULTIBODY_SINGULAR_MECHANISMS_H

#include <cmath>
#include <vector>

#include "system.h"
#include "test_set/scalar.h"

namespace sfdae_test {

// A02 of the IFToMM benchmark library: N windows of homogeneous bars of length and mass 1 in the plane. Bars from (k,
// 0) to (x_k, y_k), k = 0 ... N, and between (x_k, y_k) and (x_(k+1), y_(k+1)). All of them lie in one line again and
//    again. As one
// angle, phi'' = -g (N + (N + 1) / 2) / (N + (N + 1) / 3) cos phi.
struct Windows : MechanicalSystem {
  static constexpr double gravity = 9.81;
  explicit Windows(int its_windows, double its_second = 1.0)
      : MechanicalSystem({2 * (its_windows + 1), 2 * its_windows + 1, 0}), windows(its_windows), second(its_second) {}

  template <class V>
  void mass(const V&, const V*, V* M) const {
    const int n = sizes.positions;
    for (int k = 0; k <= windows; ++k) {
      // A third of a crank each, and thirds and sixths of couplers.
      const int couplers = (k > 0 ? 1 : 0) + (k < windows ? 1 : 0);
      for (int c = 0; c < 2; ++c) {
        const int i = 2 * k + c;
        M[i + n * i] = V((1.0 + couplers) / 3.0);
        if (k < windows) M[i + n * (i + 2)] = M[i + 2 + n * i] = V(1.0 / 6.0);
      }
    }
  }
  template <class V>
  void force(const V&, const V*, const V*, V* f) const {
    for (int k = 0; k <= windows; ++k) {
      const int bars = 1 + (k > 0 ? 1 : 0) + (k < windows ? 1 : 0);
      f[2 * k + 1] = V(-0.5 * gravity * bars / (second * second));
    }
  }
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    for (int k = 0; k <= windows; ++k) g[k] = square(q[2 * k] - 1.0 * k) + square(q[2 * k + 1]) - 1.0;
    for (int k = 0; k < windows; ++k)
      g[windows + 1 + k] = square(q[2 * k + 2] - q[2 * k]) + square(q[2 * k + 3] - q[2 * k + 1]) - 1.0;
  }
  std::vector<double> start(double phi, double speed) const {
    std::vector<double> x(static_cast<std::size_t>(sizes.unknowns()), 0.0);
    for (int k = 0; k <= windows; ++k) {
      const auto i = static_cast<std::size_t>(2 * k), j = i + static_cast<std::size_t>(sizes.positions);
      x[i] = k + std::cos(phi), x[i + 1] = std::sin(phi);
      x[j] = -speed / second * std::sin(phi), x[j + 1] = speed / second * std::cos(phi);
    }
    return x;
  }

  int windows;
  double second;  // unit of time: so many units are one second
};

// Crank from (0, 0) to (x1, y1) and rod from there to the slider (x2, 0), both of length 1, masses 1 at the joint and
// the slider, without gravity: x2 = 2 cos phi, (1 + 4 sin^2 phi) phi'^2 constant. Upright, phi = pi/2, the slider may
// stay at x2 = 0 as well.
struct EqualSliderCrank : MechanicalSystem {
  EqualSliderCrank() : MechanicalSystem({3, 2, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    M[0] = M[4] = M[8] = V(1.0);
  }
  template <class V>
  void force(const V&, const V*, const V*, V*) const {}
  template <class V>
  void constraints(const V&, const V* q, V* g) const {
    g[0] = square(q[0]) + square(q[1]) - 1.0;
    g[1] = square(q[2] - q[0]) + square(q[1]) - 1.0;
  }
  template <class V>
  void gradient(const V&, const V* q, V* G) const {
    G[0] = 2.0 * q[0];
    G[2] = 2.0 * q[1];
    G[1] = 2.0 * (q[0] - q[2]);
    G[3] = 2.0 * q[1];
    G[5] = 2.0 * (q[2] - q[0]);
  }
  static std::vector<double> start(double phi, double speed) {
    return {std::cos(phi),
            std::sin(phi),
            2.0 * std::cos(phi),
            -speed * std::sin(phi),
            speed * std::cos(phi),
            -2.0 * speed * std::sin(phi),
            0.0,
            0.0};
  }
};

// phi after `time` with phi'' = f(phi, phi'), by the classical method of order 4.
template <class Acceleration>
double angle_after(double phi, double speed, double time, Acceleration f, int steps = 200000) {
  const double h = time / steps;
  for (int k = 0; k < steps; ++k) {
    const double k1 = speed, a1 = f(phi, speed), k2 = speed + 0.5 * h * a1, a2 = f(phi + 0.5 * h * k1, k2),
                 k3 = speed + 0.5 * h * a2, a3 = f(phi + 0.5 * h * k2, k3), k4 = speed + h * a3,
                 a4 = f(phi + h * k3, k4);
    phi += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    speed += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return phi;
}

}  // namespace sfdae_test

#endif
