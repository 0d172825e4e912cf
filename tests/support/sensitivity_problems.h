// SPDX-License-Identifier: BSD-3-Clause
// Recorded equations with parameters, of one kind each that sensitivities are found for in a way of its own.
#ifndef SFDAE_TESTS_SENSITIVITY_PROBLEMS_H
#define SFDAE_TESTS_SENSITIVITY_PROBLEMS_H

#include "sfdae/sfdae.hpp"

namespace sfdae_test {

// Mass points on massless rods in the plane, index raw, mu = 2: positions, velocities and a force for each. p is
// gravity, q the mass of the second.
inline sfdae::NonlinearProblem chain_of_rods(int links) {
  sfdae::NonlinearProblem problem(5 * links, 5 * links);
  problem.equations = [links](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    using sfdae::Expression;
    const Expression g = sfdae::parameter(t, "p", 9.81), mass = sfdae::parameter(t, "q", 1.5);
    const auto at = [&](int i, int k) { return i < 0 ? 0.0 * t : x[5 * i + k]; };
    for (int i = 0; i < links; ++i) {
      F[5 * i] = xdot[5 * i] - x[5 * i + 2];
      F[5 * i + 1] = xdot[5 * i + 1] - x[5 * i + 3];
      for (int k = 0; k < 2; ++k) {
        Expression force = (at(i, k) - at(i - 1, k)) * x[5 * i + 4];
        if (i + 1 < links) force = force - (at(i + 1, k) - at(i, k)) * x[5 * i + 9];
        const Expression m = i == 1 ? mass : 0.0 * t + 1.0;
        F[5 * i + 2 + k] = m * xdot[5 * i + 2 + k] + force + (k == 1 ? m * g : 0.0 * t);
      }
      const Expression dx = at(i, 0) - at(i - 1, 0), dy = at(i, 1) - at(i - 1, 1);
      F[5 * i + 4] = dx * dx + dy * dy - 1.0;
    }
  };
  return problem;
}

// Diffusion with fluxes as unknowns, mu = 0: u_i' = (phi_i - phi_{i+1}) - p u_i^2, 0 = phi_i - q (u_{i-1} - u_i).
inline sfdae::NonlinearProblem diffusion(int cells) {
  sfdae::NonlinearProblem problem(2 * cells, 2 * cells);
  problem.equations = [cells](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    using sfdae::Expression;
    const Expression p = sfdae::parameter(t, "p", 0.7), q = sfdae::parameter(t, "q", 50.0);
    for (int i = 0; i < cells; ++i) {
      const Expression out = i + 1 < cells ? x[2 * i + 3] : 0.0 * t;
      F[2 * i] = xdot[2 * i] - (x[2 * i + 1] - out) + p * x[2 * i] * x[2 * i];
      F[2 * i + 1] = x[2 * i + 1] - q * ((i > 0 ? x[2 * i - 2] : sin(t)) - x[2 * i]);
    }
  };
  return problem;
}

// x' is stiff where it turns, and steps fail there, for sensitivities too. From x = (2, 0, 0).
inline sfdae::NonlinearProblem van_der_pol() {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    const sfdae::Expression p = sfdae::parameter(t, "p", 20.0);
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] - p * (1.0 - x[0] * x[0]) * x[1] + x[0];
    F[2] = x[2] - x[0] * x[1];
  };
  return problem;
}

// Linear: x = (a cos p t, -a sin p t, c x_0) from x = (a, 0, c a) at t = 0.
inline sfdae::NonlinearProblem rotation() {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    const sfdae::Expression p = sfdae::parameter(t, "p", 1.5), c = sfdae::parameter(t, "c", 3.0);
    F[0] = xdot[0] - p * x[1];
    F[1] = xdot[1] + p * x[0];
    F[2] = x[2] - c * x[0];
  };
  return problem;
}

// mu = 1, with an input that has kinks at t = 0.5 and 1.25. From x = (0.5, 0.2, 0), to t = 2.
inline sfdae::NonlinearProblem driven_by_a_table() {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    const sfdae::Expression input = sfdae::table(t, 1, {0.0, 0.5, 1.25, 2.0}, {1.0, 0.0, 2.0, -1.0}),
                            p = sfdae::parameter(t, "p", 0.8), q = sfdae::parameter(t, "q", 1.5);
    F[0] = xdot[0] + p * x[0] * x[0] - x[1];
    F[1] = xdot[1] + x[2];
    F[2] = x[1] + q * sin(x[0]) - input;
  };
  return problem;
}

// A pendulum on a rod as a mechanical system, in SI units, with friction.
inline sfdae::MultibodyProblem pendulum_with_friction() {
  sfdae::MultibodyProblem system(2, 1);
  system.equations = [](const sfdae::Expression& t, auto q, auto v, const auto& to) {
    const sfdae::Expression m = sfdae::parameter(t, "m", 2.0), length = sfdae::parameter(t, "length", 0.7);
    to.M(0, 0) = to.M(1, 1) = m;
    to.f[0] = -sfdae::parameter(t, "friction", 0.02) * v[0];
    to.f[1] = -9.81 * m;
    to.g[0] = q[0] * q[0] + q[1] * q[1] - length * length;
  };
  return system;
}

}  // namespace sfdae_test

#endif
