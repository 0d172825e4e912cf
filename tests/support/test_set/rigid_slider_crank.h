// SPDX-License-Identifier: BSD-3-Clause
// Slider crank of rigid bodies with a spring and a damper between crank and slider, x = (q, x, p, velocities,
// lambda): crank angle q, slider position x, angle p of the rod; mu = 2. Data as in an example
// of SUNDIALS, idaSlCrank.
//
// Reference: index-1 form, Runge-Kutta method of high order, 11 digits.
#ifndef SFDAE_TESTS_RIGID_SLIDER_CRANK_H
#define SFDAE_TESTS_RIGID_SLIDER_CRANK_H

#include "mechanical.h"
#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct RigidSliderCrank {
  static constexpr int positions = 3, multipliers = 2;
  static constexpr double a = 0.5, J1 = 1.0, m2 = 1.0, J2 = 2.0, k = 1.0, c = 1.0, l0 = 1.0, F = 1.0;

  static double mass(int i) { return i == 0 ? J1 : i == 1 ? m2 : J2; }

  template <class V>
  static void forces(const V& t, const V* y, V* f) {
    using std::sin, std::cos, std::sqrt;
    const V q = y[0], x = y[1], p = y[2], qd = y[3], xd = y[4], pd = y[5];
    const V sq = sin(q), cq = cos(q), sp = sin(p), cp = cos(p), s21 = sin(p - q), c21 = cos(p - q);
    const V l = sqrt(square(x) - x * (cp + a * cq) + 0.25 * (1.0 + a * a) + 0.5 * a * c21);
    const V ld =
        (2.0 * x * xd - xd * (cp + a * cq) + x * (sp * pd + a * sq * qd) - 0.5 * a * s21 * (pd - qd)) / (2.0 * l);
    const V fl = (k * (l - l0) + c * ld) / l;
    f[0] = -0.5 * a * fl * (0.5 * s21 + x * sq);
    f[1] = fl * (0.5 * cp - x + 0.5 * a * cq) + F;
    f[2] = -0.5 * fl * (x * sp - 0.5 * a * s21) - F * sp;
    const V minus_lambda[] = {-y[6], -y[7]};
    add_constraint_forces(t, y, minus_lambda, f);
  }
  // f += G^T mu, G = [a sin q, 1, sin p; -a cos q, 0, -cos p].
  template <class V>
  static void add_constraint_forces(const V&, const V* y, const V* mu, V* f) {
    using std::sin, std::cos;
    f[0] = f[0] + a * (sin(y[0]) * mu[0] - cos(y[0]) * mu[1]);
    f[1] = f[1] + mu[0];
    f[2] = f[2] + sin(y[2]) * mu[0] - cos(y[2]) * mu[1];
  }
  template <class V>
  static void constraints(const V&, const V* y, V* g) {
    using std::sin, std::cos;
    g[0] = y[1] - cos(y[2]) - a * cos(y[0]);
    g[1] = -sin(y[2]) - a * sin(y[0]);
  }
  template <class V>
  static void velocity_constraints(const V&, const V* y, const V* v, V* g) {
    using std::sin, std::cos;
    g[0] = v[1] + sin(y[2]) * v[2] + a * sin(y[0]) * v[0];
    g[1] = -cos(y[2]) * v[2] - a * cos(y[0]) * v[0];
  }
  template <class V>
  static void acceleration_constraints(const V& t, const V* y, const V* v, const V* w, V* g) {
    using std::sin, std::cos;
    velocity_constraints(t, y, w, g);
    const V qq = a * square(v[0]), pp = square(v[2]);
    g[0] = g[0] + cos(y[2]) * pp + cos(y[0]) * qq;
    g[1] = g[1] + sin(y[2]) * pp + sin(y[0]) * qq;
  }
};

template <class V>
void rigid_slider_crank_residual(const V& t, const V* x, const V* xdot, V* F) {
  direct_residual<RigidSliderCrank, ConstraintLevel::position>(t, x, xdot, F);
}

// Multipliers and accelerations at rest: the second derivatives of the constraints are affine in the multipliers.
inline void make_rest_consistent(TestProblem& p) {
  using System = RigidSliderCrank;
  double f[3], acceleration[3], g[3][2];
  for (int j = 0; j < 3; ++j) {  // no multipliers, the first is 1, the second is 1
    p.x0[6] = j == 1 ? 1.0 : 0.0;
    p.x0[7] = j == 2 ? 1.0 : 0.0;
    System::forces(0.0, p.x0.data(), f);
    for (int i = 0; i < 3; ++i) acceleration[i] = f[i] / System::mass(i);
    System::acceleration_constraints(0.0, p.x0.data(), p.x0.data() + 3, acceleration, g[j]);
  }
  const double a = g[1][0] - g[0][0], b = g[2][0] - g[0][0], c = g[1][1] - g[0][1], d = g[2][1] - g[0][1];
  p.x0[6] = (-g[0][0] * d + g[0][1] * b) / (a * d - b * c);
  p.x0[7] = (-g[0][1] * a + g[0][0] * c) / (a * d - b * c);
  System::forces(0.0, p.x0.data(), f);
  for (int i = 0; i < 3; ++i) p.xdot0[static_cast<std::size_t>(3 + i)] = f[i] / System::mass(i);
}

inline TestProblem rigid_slider_crank() {
  TestProblem p{.name = "rigid_slider_crank", .m = 8, .n = 8, .values = {2, 2, 6, 0, 0}, .t0 = 0.0, .tf = 10.0};
  const double q = 2.0 * std::atan(1.0), rod = std::asin(-RigidSliderCrank::a);
  p.x0 = {q, std::cos(rod) + RigidSliderCrank::a * std::cos(q), rod, 0.0, 0.0, 0.0, 0.0, 0.0};
  p.xdot0.assign(8, 0.0);
  make_rest_consistent(p);
  p.references = {{10.0,
                   {1.27567584865, 1.02357855898, -0.4988130491825, -0.239914997196, 0.1337782832158,
                    0.03973149599132, 1.113756158263, -0.7625072751064}}};
  p.reference_digits = 11.0;
  p.counted = first_components(8);
  return p;
}

}  // namespace sfdae_test

#endif
