// The plane pendulum of length 1 in Cartesian coordinates, its constraint (|q|^2 - 1) / 2 = 0 repeated as often as
// wanted.
//
// q'' = (0, -g) - lambda q with g = 1: lambda = |v|^2 - q_2 g, and the energy |v|^2 / 2 + g q_2 is constant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "multibody_run.h"

namespace sfdae::test {

struct Pendulum {
  int copies = 1;
  double offset = 0.0;  // of the squared length in the last copy

  static int forces(double, const double*, const double*, double* f, void*) {
    f[1] = -1.0;
    return 0;
  }
  static int constraints(double, const double* q, double* g, void* user) {
    const auto& self = *static_cast<const Pendulum*>(user);
    for (int i = 0; i < self.copies; ++i) g[i] = 0.5 * (q[0] * q[0] + q[1] * q[1] - 1.0);
    g[self.copies - 1] += self.offset;
    return 0;
  }
  static int jacobian(double, const double* q, double* g_q, void* user) {
    const int copies = static_cast<const Pendulum*>(user)->copies;
    for (int i = 0; i < copies; ++i) {
      g_q[i] = q[0];
      g_q[i + copies] = q[1];
    }
    return 0;
  }
  static int curvature(double, const double*, const double* v, double* gamma, void* user) {
    for (int i = 0; i < static_cast<const Pendulum*>(user)->copies; ++i) gamma[i] = v[0] * v[0] + v[1] * v[1];
    return 0;
  }

  sfdae_multibody_problem problem() {
    sfdae_multibody_problem result = multibody_problem_of(2, copies);
    result.forces = forces;
    result.constraints = constraints;
    result.constraint_jacobian = jacobian;
    result.constraint_curvature = curvature;
    result.user = this;
    return result;
  }

  static double energy(const double* x) { return 0.5 * (x[2] * x[2] + x[3] * x[3]) + x[1]; }
  // x at the angle phi from below with the angular velocity omega.
  static std::vector<double> state(double phi, double omega) {
    return {std::sin(phi), -std::cos(phi), omega * std::cos(phi), omega * std::sin(phi),
            omega * omega + std::cos(phi)};
  }
};

}  // namespace sfdae::test
