/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Andrews' squeezing mechanism: seven bodies in a plane, moved by a motor. Angles q = (beta, theta, gamma, phi,
 * delta, omega, epsilon); six constraints close three loops, so that one angle determines all others.
 *
 * W. Schiehlen (ed.): Multibody Systems Handbook. Springer, 1990. Data: IVP test set, Bari and CWI; the values at
 * t = 0.03, good to 9 digits there, come from an integration in quadruple precision. */
#ifndef SQUEEZER_MODEL_H
#define SQUEEZER_MODEL_H

#include <math.h>

static const double m1 = .04325, m2 = .00365, m3 = .02373, m4 = .00706, m5 = .07050, m6 = .00706, m7 = .05498;
static const double I1 = 2.194e-6, I2 = 4.410e-7, I3 = 5.255e-6, I4 = 5.667e-7, I5 = 1.169e-5, I6 = 5.667e-7;
static const double I7 = 1.912e-5, xa = -.06934, ya = -.00227, xb = -.03635, yb = .03273, xc = .014, yc = .072;
static const double c0 = 4530, l0 = .07785, motor = .033, d = .028, da = .0115, e = .02, ra = .00092, rr = .007;
static const double ss = .035, sa = .01874, sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04;
static const double ua = .01228, ub = .00449, zf = .02, zt = .04, ee = .02 - .01421, zz = .02 - .01421;

static const double angles_at_start[7] = {-0.0617138900142764496, 0,
                                          0.455279819163070380,   0.222668390165885885,
                                          0.487364979543842550,   -0.222668390165885885,
                                          1.23054744454982119};
static const double angles_at_end[7] = {15.8107711951537071,   -15.7563710584118394, 0.0408222401196458049,
                                        -0.534730116342079594, 0.524409965879954069, 0.534730116342079594,
                                        1.04808074104193787};

/* Entry (i, j) of a symmetric 7 x 7 matrix. */
static void set(double* M, int i, int j, double value) { M[i + 7 * j] = M[j + 7 * i] = value; }

static int mass(double t, const double* q, double* M, void* user) {
  const double c_th = cos(q[1]), s_ph = sin(q[3]), s_om = sin(q[5]);
  (void)t, (void)user;
  set(M, 0, 0, m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * c_th + da * da) + I1 + I2);
  set(M, 1, 0, m2 * (da * da - da * rr * c_th) + I2);
  set(M, 1, 1, m2 * da * da + I2);
  set(M, 2, 2, m3 * (sa * sa + sb * sb) + I3);
  set(M, 3, 3, m4 * ee * ee + I4);
  set(M, 4, 3, m4 * (ee * ee + zt * ee * s_ph) + I4);
  set(M, 4, 4, m4 * (zt * zt + 2 * zt * ee * s_ph + ee * ee) + m5 * (ta * ta + tb * tb) + I4 + I5);
  set(M, 5, 5, m6 * zz * zz + I6);
  set(M, 6, 5, m6 * (zz * zz - u * zz * s_om) + I6);
  set(M, 6, 6, m6 * (zz * zz - 2 * u * zz * s_om + u * u) + m7 * (ua * ua + ub * ub) + I6 + I7);
  return 0;
}

static int forces(double t, const double* q, const double* v, double* f, void* user) {
  const double s = sin(q[2]), c = cos(q[2]), x = sd * c + sc * s + xb - xc, y = sd * s - sc * c + yb - yc;
  const double spring = -c0 * (1 - l0 / sqrt(x * x + y * y));
  (void)t, (void)user;
  f[0] = motor - m2 * da * rr * v[1] * (v[1] + 2 * v[0]) * sin(q[1]);
  f[1] = m2 * da * rr * v[0] * v[0] * sin(q[1]);
  f[2] = spring * (x * (sc * c - sd * s) + y * (sd * c + sc * s));
  f[3] = m4 * zt * ee * v[4] * v[4] * cos(q[3]);
  f[4] = -m4 * zt * ee * v[3] * (v[3] + 2 * v[4]) * cos(q[3]);
  f[5] = -m6 * u * zz * v[6] * v[6] * cos(q[5]);
  f[6] = m6 * u * zz * v[5] * (v[5] + 2 * v[6]) * cos(q[5]);
  return 0;
}

static int constraints(double t, const double* q, double* g, void* user) {
  const double x = rr * cos(q[0]) - d * cos(q[0] + q[1]), y = rr * sin(q[0]) - d * sin(q[0] + q[1]);
  (void)t, (void)user;
  g[0] = x - ss * sin(q[2]) - xb;
  g[1] = y + ss * cos(q[2]) - yb;
  g[2] = x - e * sin(q[3] + q[4]) - zt * cos(q[4]) - xa;
  g[3] = y + e * cos(q[3] + q[4]) - zt * sin(q[4]) - ya;
  g[4] = x - zf * cos(q[5] + q[6]) - u * sin(q[6]) - xa;
  g[5] = y - zf * sin(q[5] + q[6]) + u * cos(q[6]) - ya;
  return 0;
}

static int constraint_jacobian(double t, const double* q, double* g_q, void* user) {
  int i;
  (void)t, (void)user;
  for (i = 0; i < 6; i += 2) {
    g_q[i + 6] = d * sin(q[0] + q[1]), g_q[i] = g_q[i + 6] - rr * sin(q[0]);
    g_q[i + 7] = -d * cos(q[0] + q[1]), g_q[i + 1] = g_q[i + 7] + rr * cos(q[0]);
  }
  g_q[12] = -ss * cos(q[2]), g_q[13] = -ss * sin(q[2]);
  g_q[20] = -e * cos(q[3] + q[4]), g_q[26] = g_q[20] + zt * sin(q[4]);
  g_q[21] = -e * sin(q[3] + q[4]), g_q[27] = g_q[21] - zt * cos(q[4]);
  g_q[34] = zf * sin(q[5] + q[6]), g_q[40] = g_q[34] - u * cos(q[6]);
  g_q[35] = -zf * cos(q[5] + q[6]), g_q[41] = g_q[35] - u * sin(q[6]);
  return 0;
}

#endif
