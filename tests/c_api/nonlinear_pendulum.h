/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A pendulum that is pushed by a horizontal force x6, recorded and with total derivatives written by hand:
 *
 *     x1' = x3,  x2' = x4,  x3' = -2 x1 x5 + x6,  x4' = -2 x2 x5 - g,  0 = x1^2 + x2^2 - 1
 *
 * m = 5, n = 6, mu = 2, d = 2, a = 3, u = 1. With the angle p = -pi/2 + sin(t)/2 of the position (cos p, sin p),
 *
 *     x6 = -(p'' + g cos p) / sin p,   x5 = (p'^2 + x6 cos p - g sin p) / 2
 */
#ifndef SFDAE_TESTS_NONLINEAR_PENDULUM_H
#define SFDAE_TESTS_NONLINEAR_PENDULUM_H

#include <math.h>
#include <stddef.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

enum { M = 5, N = 6 };
static const double gravity = 2;
static const double unset = -12345.678; /* outputs that nobody has written */
static const int force_component[1] = {N - 1};

/* Bytes that no call that fails may change. */
static inline void guard(void* bytes, size_t length) { memset(bytes, 0xA5, length); }

static inline int guarded(const void* bytes, size_t length) {
  const unsigned char* byte = (const unsigned char*)bytes;
  size_t i;
  for (i = 0; i < length; i++)
    if (byte[i] != 0xA5) return 0;
  return 1;
}

static inline void exact(double t, double* x) {
  const double p = sin(t) / 2 - acos(0.0), p1 = cos(t) / 2, p2 = -sin(t) / 2;
  x[0] = cos(p);
  x[1] = sin(p);
  x[2] = -p1 * sin(p);
  x[3] = p1 * cos(p);
  x[5] = -(p2 + gravity * cos(p)) / sin(p);
  x[4] = (p1 * p1 + x[5] * cos(p) - gravity * sin(p)) / 2;
}

static inline double force(double t) {
  double x[N];
  exact(t, x);
  return x[5];
}

/* The error stays below 10 times the tolerance. */
static inline int accurate(double t, const double* x, double tol) {
  double xe[N];
  int i;
  exact(t, xe);
  for (i = 0; i < N; i++)
    if (!(fabs(x[i] - xe[i]) <= 10 * (tol * fabs(xe[i]) + tol))) return 0;
  return 1;
}

/* Largest residual of the constraints, hidden ones included. */
static inline double violation(const double* x) {
  const double position = x[0] * x[0] + x[1] * x[1] - 1, velocity = x[0] * x[2] + x[1] * x[3];
  const double acceleration = x[2] * x[2] + x[3] * x[3] - 2 * x[4] + x[0] * x[5] - gravity * x[1];
  return fmax(fabs(position), fmax(fabs(velocity), fabs(acceleration)));
}

static inline int pendulum_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression rod = sfdae_multiply(sfdae_number(2), x[4]), g = sfdae_parameter(record, "g", gravity);
  (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_subtract(sfdae_add(xdot[2], sfdae_multiply(x[0], rod)), x[5]);
  F[3] = sfdae_add(sfdae_add(xdot[3], sfdae_multiply(x[1], rod)), g);
  F[4] = sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1]));
  F[4] = sfdae_subtract(F[4], sfdae_number(1));
  return 0;
}

/* Order k by the rule of Leibniz. */
static inline int pendulum_derivative(double t, int k, const double* jet, double* F, double* F_x, double* F_xdot,
                                      void* user) {
  double binomial = 1;
  int i;
  (void)t, (void)user;
#define X(component, order) jet[(component) + N * (order)]
  for (i = 0; i < 4; i++) F[i] = X(i, k + 1);
  F[0] -= X(2, k), F[1] -= X(3, k), F[2] -= X(5, k);
  if (k == 0) F[3] += gravity, F[4] -= 1;
  for (i = 0; i <= k; i++) {
    F[2] += 2 * binomial * X(0, i) * X(4, k - i);
    F[3] += 2 * binomial * X(1, i) * X(4, k - i);
    F[4] += binomial * (X(0, i) * X(0, k - i) + X(1, i) * X(1, k - i));
    binomial = binomial * (k - i) / (i + 1);
  }
  if (F_x) {
    if (k == 0) F_x[0 + M * 2] = F_x[1 + M * 3] = F_x[2 + M * 5] = -1;
    F_x[2 + M * 0] = F_x[3 + M * 1] = 2 * X(4, k);
    F_x[2 + M * 4] = F_x[4 + M * 0] = 2 * X(0, k);
    F_x[3 + M * 4] = F_x[4 + M * 1] = 2 * X(1, k);
  }
  if (F_xdot && k == 0)
    for (i = 0; i < 4; i++) F_xdot[i + M * i] = 1;
#undef X
  return 0;
}

static inline int push(double t, int order, double* values, void* user) {
  (void)user;
  CHECK(order == 0 && values[0] == 0);
  values[0] = force(t);
  return 0;
}

/* Without a function for F. The force is prescribed. */
static inline sfdae_nonlinear_problem pendulum_problem(void) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = M;
  problem.num_unknowns = N;
  problem.num_prescribed = 1;
  problem.prescribed = force_component;
  problem.prescribed_values = push;
  return problem;
}

static inline sfdae_nonlinear_problem recorded_pendulum(void) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  problem.equations = pendulum_equations;
  return problem;
}

static inline sfdae_nonlinear_problem differentiated_pendulum(void) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  problem.total_derivative = pendulum_derivative;
  return problem;
}

static inline sfdae_options default_options(void) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  return options;
}

static inline sfdae_solver* create_solver(int line, const sfdae_nonlinear_problem* problem,
                                          const sfdae_options* options) {
  sfdae_solver* solver = NULL;
  check_status(__FILE__, line, "sfdae_create_nonlinear", sfdae_create_nonlinear(&solver, problem, options), SFDAE_OK);
  return solver;
}
#define CREATE(problem, options) create_solver(__LINE__, (problem), (options))

#endif
