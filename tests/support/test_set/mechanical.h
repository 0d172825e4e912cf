// SPDX-License-Identifier: BSD-3-Clause
// Constrained mechanical systems: the raw equations with constraints on positions (mu = 2), and the forms that codes
// for low index need, in which the constraints are differentiated by hand.
//
// A system is a struct of constants and static templates:
//   positions, multipliers                         numbers np, nl
//   constraints(t, p, g)                           g(t, p) = 0
//   velocity_constraints(t, p, v, g)               dg/dt
//   acceleration_constraints(t, p, v, a, g)        d^2 g/dt^2
// and either, with a diagonal mass matrix, x = (p, v, lambda),
//   mass(i), forces(t, x, f)                       mass v' = f(t, p, v, lambda), constraint forces included
//   add_constraint_forces(t, p, mu, f)             f += G^T mu up to a factor
// or, with accelerations w among the unknowns, x = (p, v, w, lambda),
//   balance(x, r)                                  r = M w - f + G^T lambda
#ifndef SFDAE_TESTS_MECHANICAL_H
#define SFDAE_TESTS_MECHANICAL_H

#include <array>
#include <cstddef>

namespace sfdae_test {

enum class ConstraintLevel { position, velocity, acceleration };

template <class System, class V>
void constraints_at(ConstraintLevel level, const V& t, const V* x, const V* a, V* g) {
  const V* p = x;
  const V* v = x + System::positions;
  switch (level) {
    case ConstraintLevel::position: return System::constraints(t, p, g);
    case ConstraintLevel::velocity: return System::velocity_constraints(t, p, v, g);
    case ConstraintLevel::acceleration: return System::acceleration_constraints(t, p, v, a, g);
  }
}

// x = (p, v, lambda).
template <class System, ConstraintLevel level, class V>
void direct_residual(const V& t, const V* x, const V* xdot, V* F) {
  constexpr int np = System::positions;
  std::array<V, static_cast<std::size_t>(np)> force, acceleration;
  System::forces(t, x, force.data());
  for (int i = 0; i < np; ++i) {
    const auto k = static_cast<std::size_t>(i);
    F[i] = xdot[i] - x[np + i];
    F[np + i] = System::mass(i) * xdot[np + i] - force[k];
    if (level == ConstraintLevel::acceleration) acceleration[k] = force[k] / System::mass(i);
  }
  constraints_at<System>(level, t, x, acceleration.data(), F + 2 * np);
}

// x = (p, v, lambda, mu), constraints on positions and velocities, p' = v - G^T mu.
//
// C. W. Gear, G. K. Gupta, B. Leimkuhler: Automatic integration of Euler-Lagrange equations with constraints.
// J. Comp. Appl. Math. 12/13, 1985.
template <class System, class V>
void stabilized_residual(const V& t, const V* x, const V* xdot, V* F) {
  constexpr int np = System::positions, nl = System::multipliers;
  direct_residual<System, ConstraintLevel::position>(t, x, xdot, F);
  System::add_constraint_forces(t, x, x + 2 * np + nl, F);
  System::velocity_constraints(t, x, x + np, F + 2 * np + nl);
}

// x = (p, v, w, lambda).
template <class System, ConstraintLevel level, class V>
void accelerated_residual(const V& t, const V* x, const V* xdot, V* F) {
  constexpr int np = System::positions;
  for (int i = 0; i < 2 * np; ++i) F[i] = xdot[i] - x[np + i];
  System::balance(x, F + 2 * np);
  constraints_at<System>(level, t, x, x + 2 * np, F + 3 * np);
}

}  // namespace sfdae_test

#endif
