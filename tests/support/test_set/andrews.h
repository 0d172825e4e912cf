// SPDX-License-Identifier: BSD-3-Clause
// Andrews' squeezing mechanism [TS]: seven bodies in a plane, six constraints, x = (q, q', q'', lambda), 27 unknowns,
// mu = 2. q = (beta, Theta, gamma, Phi, delta, Omega, epsilon).
//
// [S90] W. Schiehlen (ed.): Multibody Systems Handbook. Springer, 1990.
// Reference: quadruple precision; the published values are good to 9.5 digits.
#ifndef SFDAE_TESTS_ANDREWS_H
#define SFDAE_TESTS_ANDREWS_H

#include "mechanical.h"
#include "scalar.h"
#include "test_problem.h"

namespace sfdae_test {

struct Andrews {
  static constexpr int positions = 7, multipliers = 6;
  static constexpr double m1 = .04325, m2 = .00365, m3 = .02373, m4 = .00706, m5 = .07050, m6 = .00706, m7 = .05498;
  static constexpr double I1 = 2.194e-6, I2 = 4.410e-7, I3 = 5.255e-6, I4 = 5.667e-7, I5 = 1.169e-5, I6 = 5.667e-7,
                          I7 = 1.912e-5;
  static constexpr double xa = -.06934, ya = -.00227, xb = -.03635, yb = .03273, xc = .014, yc = .072;
  static constexpr double c0 = 4530.0, l0 = .07785, mom = .033;
  static constexpr double d = .028, da = .0115, e = .02, ea = .01421, rr = .007, ra = .00092, ss = .035, sa = .01874,
                          sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04, ua = .01228,
                          ub = .00449, zf = .02, zt = .04, fa = .01421;

  // Sines and cosines of the angles and of the sums that occur.
  template <class V>
  struct Angles {
    explicit Angles(const V* q) {
      using std::sin, std::cos;
      s_be = sin(q[0]), c_be = cos(q[0]), s_beth = sin(q[0] + q[1]), c_beth = cos(q[0] + q[1]);
      s_ga = sin(q[2]), c_ga = cos(q[2]), s_phde = sin(q[3] + q[4]), c_phde = cos(q[3] + q[4]);
      s_de = sin(q[4]), c_de = cos(q[4]), s_omep = sin(q[5] + q[6]), c_omep = cos(q[5] + q[6]);
      s_ep = sin(q[6]), c_ep = cos(q[6]);
    }
    V s_be, c_be, s_beth, c_beth, s_ga, c_ga, s_phde, c_phde, s_de, c_de, s_omep, c_omep, s_ep, c_ep;
  };

  template <class V>
  static void constraints(const V&, const V* q, V* g) {
    const Angles<V> z(q);
    const V x = rr * z.c_be - d * z.c_beth, y = rr * z.s_be - d * z.s_beth;
    g[0] = x - ss * z.s_ga - xb;
    g[1] = y + ss * z.c_ga - yb;
    g[2] = x - e * z.s_phde - zt * z.c_de - xa;
    g[3] = y + e * z.c_phde - zt * z.s_de - ya;
    g[4] = x - zf * z.c_omep - u * z.s_ep - xa;
    g[5] = y - zf * z.s_omep + u * z.c_ep - ya;
  }
  // G v
  template <class V>
  static void velocity_constraints(const V&, const V* q, const V* v, V* g) {
    const Angles<V> z(q);
    const V beth = v[0] + v[1], phde = v[3] + v[4], omep = v[5] + v[6];
    const V x = -rr * z.s_be * v[0] + d * z.s_beth * beth, y = rr * z.c_be * v[0] - d * z.c_beth * beth;
    g[0] = x - ss * z.c_ga * v[2];
    g[1] = y - ss * z.s_ga * v[2];
    g[2] = x - e * z.c_phde * phde + zt * z.s_de * v[4];
    g[3] = y - e * z.s_phde * phde - zt * z.c_de * v[4];
    g[4] = x + zf * z.s_omep * omep - u * z.c_ep * v[6];
    g[5] = y - zf * z.c_omep * omep - u * z.s_ep * v[6];
  }
  // G a + (dG/dt) v
  template <class V>
  static void acceleration_constraints(const V& t, const V* q, const V* v, const V* a, V* g) {
    velocity_constraints(t, q, a, g);
    const Angles<V> z(q);
    const V beta = square(v[0]), beth = square(v[0] + v[1]), gamma = square(v[2]), phde = square(v[3] + v[4]);
    const V delta = square(v[4]), omep = square(v[5] + v[6]), epsilon = square(v[6]);
    const V x = -rr * z.c_be * beta + d * z.c_beth * beth, y = -rr * z.s_be * beta + d * z.s_beth * beth;
    g[0] = g[0] + x + ss * z.s_ga * gamma;
    g[1] = g[1] + y - ss * z.c_ga * gamma;
    g[2] = g[2] + x + e * z.s_phde * phde + zt * z.c_de * delta;
    g[3] = g[3] + y - e * z.c_phde * phde + zt * z.s_de * delta;
    g[4] = g[4] + x + zf * z.c_omep * omep + u * z.s_ep * epsilon;
    g[5] = g[5] + y + zf * z.s_omep * omep - u * z.c_ep * epsilon;
  }

  template <class V>
  static void balance(const V* x, V* r) {
    apply_mass(x, x + 14, r);
    subtract_forces(x, x + 7, r);
    add_multipliers(x, x + 21, r);
  }

  // r = M(q) w
  template <class V>
  static void apply_mass(const V* q, const V* w, V* r) {
    using std::sin, std::cos;
    constexpr double ee = e - ea, zz = zf - fa;
    const V arm = m2 * da * (da - rr * cos(q[1])), body4 = m4 * ee * (ee + zt * sin(q[3]));
    const V body6 = m6 * zz * (zz - u * sin(q[5]));
    const V M21 = arm + I2, M54 = body4 + I4, M76 = body6 + I6;
    r[0] = (m1 * ra * ra + m2 * (rr * rr - 2.0 * da * rr * cos(q[1]) + da * da) + I1 + I2) * w[0] + M21 * w[1];
    r[1] = M21 * w[0] + (m2 * da * da + I2) * w[1];
    r[2] = (m3 * (sa * sa + sb * sb) + I3) * w[2];
    r[3] = (m4 * ee * ee + I4) * w[3] + M54 * w[4];
    r[4] = M54 * w[3] +
           (m4 * (zt * zt + 2.0 * zt * ee * sin(q[3]) + ee * ee) + m5 * (ta * ta + tb * tb) + I4 + I5) * w[4];
    r[5] = (m6 * zz * zz + I6) * w[5] + M76 * w[6];
    r[6] =
        M76 * w[5] + (m6 * (zz * zz - 2.0 * u * zz * sin(q[5]) + u * u) + m7 * (ua * ua + ub * ub) + I6 + I7) * w[6];
  }
  // r -= f(q, v)
  template <class V>
  static void subtract_forces(const V* q, const V* v, V* r) {
    using std::sin, std::cos, std::sqrt;
    constexpr double ee = e - ea, zz = zf - fa;
    const V s_ga = sin(q[2]), c_ga = cos(q[2]);
    const V x = sd * c_ga + sc * s_ga + xb - xc, y = sd * s_ga - sc * c_ga + yb - yc;
    const V tension = -c0 * (1.0 - l0 / sqrt(square(x) + square(y)));
    r[0] = r[0] - (mom - m2 * da * rr * v[1] * (v[1] + 2.0 * v[0]) * sin(q[1]));
    r[1] = r[1] - m2 * da * rr * square(v[0]) * sin(q[1]);
    r[2] = r[2] - tension * (x * (sc * c_ga - sd * s_ga) + y * (sd * c_ga + sc * s_ga));
    r[3] = r[3] - m4 * zt * ee * square(v[4]) * cos(q[3]);
    r[4] = r[4] + m4 * zt * ee * v[3] * (v[3] + 2.0 * v[4]) * cos(q[3]);
    r[5] = r[5] + m6 * u * zz * square(v[6]) * cos(q[5]);
    r[6] = r[6] - m6 * u * zz * v[5] * (v[5] + 2.0 * v[6]) * cos(q[5]);
  }
  // r += G^T lambda
  template <class V>
  static void add_multipliers(const V* q, const V* l, V* r) {
    const Angles<V> z(q);
    const V x = l[0] + l[2] + l[4], y = l[1] + l[3] + l[5];
    const V theta = d * (z.s_beth * x - z.c_beth * y);
    const V phi = -e * (z.c_phde * l[2] + z.s_phde * l[3]), omega = zf * (z.s_omep * l[4] - z.c_omep * l[5]);
    r[0] = r[0] + theta + rr * (z.c_be * y - z.s_be * x);
    r[1] = r[1] + theta;
    r[2] = r[2] - ss * (z.c_ga * l[0] + z.s_ga * l[1]);
    r[3] = r[3] + phi;
    r[4] = r[4] + phi + zt * (z.s_de * l[2] - z.c_de * l[3]);
    r[5] = r[5] + omega;
    r[6] = r[6] + omega - u * (z.c_ep * l[4] + z.s_ep * l[5]);
  }
};

template <class V>
void andrews_residual(const V& t, const V* x, const V* xdot, V* F) {
  accelerated_residual<Andrews, ConstraintLevel::position>(t, x, xdot, F);
}

inline TestProblem andrews() {
  TestProblem p{.name = "andrews", .m = 27, .n = 27, .values = {2, 2, 25, 0, 0}, .t0 = 0.0, .tf = 0.03};
  p.x0.assign(27, 0.0);
  p.x0[0] = -0.0617138900142764496358948458001;
  p.x0[2] = 0.455279819163070380255912382449;
  p.x0[3] = 0.222668390165885884674473185609;
  p.x0[4] = 0.487364979543842550225598953530;
  p.x0[5] = -0.222668390165885884674473185609;
  p.x0[6] = 1.23054744454982119249735015568;
  p.x0[14] = 14222.4439199541138705911625887;
  p.x0[15] = -10666.8329399655854029433719415;
  p.x0[21] = 98.5668703962410896057654982170;
  p.x0[22] = -6.12268834425566265503114393122;
  p.xdot0.assign(27, 0.0);
  p.xdot0[7] = p.x0[14];
  p.xdot0[8] = p.x0[15];
  p.references = {
      {0.03,
       {1.58107711951537070973952522e+01,  -1.57563710584118394700700285e+01, 4.08222401196458048609037954e-02,
        -5.34730116342079593765728728e-01, 5.24409965879954069371905990e-01,  5.34730116342079593765706730e-01,
        1.04808074104193787306824039e+00,  1.13992030225910606419245898e+03,  -1.42437929517754007318371028e+03,
        1.10329119106185938231563317e+01,  1.92933741050320409677205682e+01,  5.73569914829502457843553520e-01,
        -1.92933741050320409677209457e+01, 3.23179149249130877338127187e-01,  -2.46317631228746347412984947e+04,
        5.18503196364642319531785033e+04,  3.24102600707578605797400322e+05,  5.66749422000995326467611383e+05,
        1.67436354183454446066697582e+04,  -5.66749422000995326467600538e+05, 9.82650780154416269516191814e+03,
        1.99175348104538628180738529e+02,  -2.97553099749717633455564584e+01, 2.30665436116221511273902448e+01,
        3.14527252757711370699969340e+01,  2.26424947863943785766551101e+01,  1.16173923526112559139851939e+01}}};
  p.counted = first_components(7);
  return p;
}

}  // namespace sfdae_test

#endif
