// SPDX-License-Identifier: BSD-3-Clause
// Plane pendulum of length 1, x = (x, y, u, v, lambda): it falls from the horizontal.
//
//   x' = u, y' = v, u' = -lambda x, v' = -lambda y - g, 0 = x^2 + y^2 - 1
//
// Reference: Taylor series of the equation of the angle in quadruple precision.
#ifndef SFDAE_TESTS_PENDULUM_H
#define SFDAE_TESTS_PENDULUM_H

#include "mechanical.h"
#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct Pendulum {
  static constexpr int positions = 2, multipliers = 1;
  static constexpr double gravity = 9.81;

  static double mass(int) { return 1.0; }

  template <class V>
  static void forces(const V&, const V* x, V* f) {
    f[0] = -x[4] * x[0];
    f[1] = -x[4] * x[1] - gravity;
  }
  template <class V>
  static void add_constraint_forces(const V&, const V* p, const V* mu, V* f) {
    for (int i = 0; i < 2; ++i) f[i] = f[i] + mu[0] * p[i];
  }
  template <class V>
  static void constraints(const V&, const V* p, V* g) {
    g[0] = square(p[0]) + square(p[1]) - 1.0;
  }
  template <class V>
  static void velocity_constraints(const V&, const V* p, const V* v, V* g) {
    g[0] = 2.0 * (p[0] * v[0] + p[1] * v[1]);
  }
  template <class V>
  static void acceleration_constraints(const V&, const V* p, const V* v, const V* a, V* g) {
    g[0] = 2.0 * (square(v[0]) + square(v[1]) + p[0] * a[0] + p[1] * a[1]);
  }
};

template <class V>
void pendulum_residual(const V& t, const V* x, const V* xdot, V* F) {
  direct_residual<Pendulum, ConstraintLevel::position>(t, x, xdot, F);
}

inline TestProblem pendulum() {
  TestProblem p{.name = "pendulum", .m = 5, .n = 5, .values = {2, 2, 3, 0, 0}, .t0 = 0.0, .tf = 10.0};
  p.x0 = {1.0, 0.0, 0.0, 0.0, 0.0};
  p.xdot0 = {0.0, 0.0, 0.0, -Pendulum::gravity, 0.0};
  p.references = {{10.0,
                   {2.75087462576116860054e-01, -9.61419205099125064265e-01, -4.17559810095172883646,
                    -1.19474905456047527165, 28.2945672060672506413}}};
  p.counted = first_components(4);
  return p;
}

}  // namespace sfdae_test

#endif
