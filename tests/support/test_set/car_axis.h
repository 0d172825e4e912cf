// SPDX-License-Identifier: BSD-3-Clause
// Car axis on a bumpy road [TS], x = (xl, yl, xr, yr, velocities, lambda): four positions, two constraints, mu = 2.
//
// Reference: quadruple precision; the published values are good to 9.2 digits.
#ifndef SFDAE_TESTS_CAR_AXIS_H
#define SFDAE_TESTS_CAR_AXIS_H

#include "mechanical.h"
#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct CarAxis {
  static constexpr int positions = 4, multipliers = 2;
  static constexpr double L = 1.0, L0 = 0.5, eps = 1e-2, M = 10.0, r = 0.1, w = 10.0, gravity = 1.0;
  static constexpr double K = 0.5 * M * eps * eps;

  static double mass(int) { return K; }

  // Lower end of the right spring, xb^2 + yb^2 = L^2.
  template <class V>
  struct Road {
    explicit Road(const V& t) {
      using std::sin, std::sqrt;
      yb = r * sin(w * t);
      xb = sqrt(L * L - yb * yb);
    }
    V xb, yb;
  };
  template <class V>
  struct RoadSlope : Road<V> {
    explicit RoadSlope(const V& t) : Road<V>(t) {
      using std::cos;
      yb1 = r * w * cos(w * t);
      xb1 = -this->yb * yb1 / this->xb;
    }
    V xb1, yb1;
  };

  template <class V>
  static void forces(const V& t, const V* x, V* f) {
    using std::sqrt;
    const Road<V> road(t);
    const V xd = x[2] - road.xb, yd = x[3] - road.yb;
    const V left = L0 / sqrt(square(x[0]) + square(x[1])) - 1.0;
    const V right = L0 / sqrt(square(xd) + square(yd)) - 1.0;
    const V l1 = x[8], l2 = 2.0 * x[9];
    f[0] = left * x[0] + l1 * road.xb + l2 * (x[0] - x[2]);
    f[1] = left * x[1] + l1 * road.yb + l2 * (x[1] - x[3]) - K * gravity;
    f[2] = right * xd - l2 * (x[0] - x[2]);
    f[3] = right * yd - l2 * (x[1] - x[3]) - K * gravity;
  }
  template <class V>
  static void add_constraint_forces(const V& t, const V* p, const V* mu, V* f) {
    const Road<V> road(t);
    const V dx = 2.0 * mu[1] * (p[0] - p[2]), dy = 2.0 * mu[1] * (p[1] - p[3]);
    f[0] = f[0] + mu[0] * road.xb + dx;
    f[1] = f[1] + mu[0] * road.yb + dy;
    f[2] = f[2] - dx;
    f[3] = f[3] - dy;
  }
  template <class V>
  static void constraints(const V& t, const V* p, V* g) {
    const Road<V> road(t);
    g[0] = road.xb * p[0] + road.yb * p[1];
    g[1] = square(p[0] - p[2]) + square(p[1] - p[3]) - L * L;
  }
  template <class V>
  static void velocity_constraints(const V& t, const V* p, const V* v, V* g) {
    const RoadSlope<V> road(t);
    g[0] = road.xb1 * p[0] + road.yb1 * p[1] + road.xb * v[0] + road.yb * v[1];
    g[1] = 2.0 * ((p[0] - p[2]) * (v[0] - v[2]) + (p[1] - p[3]) * (v[1] - v[3]));
  }
  template <class V>
  static void acceleration_constraints(const V& t, const V* p, const V* v, const V* a, V* g) {
    const RoadSlope<V> road(t);
    const V yb2 = -w * w * road.yb;
    const V xb2 = -(square(road.yb1) + road.yb * yb2 + square(road.xb1)) / road.xb;
    g[0] = xb2 * p[0] + yb2 * p[1] + 2.0 * (road.xb1 * v[0] + road.yb1 * v[1]) + road.xb * a[0] + road.yb * a[1];
    g[1] = 2.0 * (square(v[0] - v[2]) + square(v[1] - v[3]) + (p[0] - p[2]) * (a[0] - a[2]) +
                  (p[1] - p[3]) * (a[1] - a[3]));
  }
};

template <class V>
void car_axis_residual(const V& t, const V* x, const V* xdot, V* F) {
  direct_residual<CarAxis, ConstraintLevel::position>(t, x, xdot, F);
}

inline TestProblem car_axis() {
  TestProblem p{.name = "car_axis", .m = 10, .n = 10, .values = {2, 4, 6, 0, 0}, .t0 = 0.0, .tf = 3.0};
  p.x0 = {0.0, 0.5, 1.0, 0.5, -0.5, 0.0, -0.5, 0.0, 0.0, 0.0};
  // Both springs have their natural length: only gravity acts.
  p.xdot0 = {-0.5, 0.0, -0.5, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0, 0.0};
  p.references = {
      {3.0,
       {4.93455784275240921439865551e-02, 4.96989460230008106761603288e-01, 1.04174252488542611520891349,
        3.73911027265365819369119080e-01, -7.70583684035920842803963695e-02, 7.44686659206841649305666799e-03,
        1.75568157535417367410755794e-02, 7.70341043779601064070371553e-01, -4.73688659085332651736954818e-03,
        -1.10468033125956584088150853e-03}}};
  p.counted = first_components(10);
  return p;
}

}  // namespace sfdae_test

#endif
