/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Which torques u1, u2 move the hand of a robot arm with two links and an elastic joint along a path?
 *
 *     x1' = v1,  x2' = v2,  x3' = v3
 *     v1' = 2 c (v1+v3)^2 + d v1^2 + (2 x3 - x2)(a + 2 b) + a (u1 - u2)
 *     v2' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(1 - 3 a - 2 b) - a u1 + (a + 1) u2
 *     v3' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(a - 9 b) - 2 c v1^2 - d (v1+v3)^2 - (a + b)(u1 - u2)
 *     cos x1 + cos(x1+x3) = cos(1 - e^t) + cos(1 - t),  the same with sines
 *     a = 2 / (2 - cos^2 x3),  b = a/2 cos x3,  c = a/2 sin x3,  d = c cos x3
 *
 * Strangeness index 4, d = 0, a = 8; x1 = 1 - e^t, x3 = e^t - t. De Luca, Isidori (1987). */
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

typedef sfdae_expression expr;
static expr num(double value) { return sfdae_number(value); }
static expr add(expr a, expr b) { return sfdae_add(a, b); }
static expr sub(expr a, expr b) { return sfdae_subtract(a, b); }
static expr mul(expr a, expr b) { return sfdae_multiply(a, b); }
static expr times(double number, expr a) { return mul(num(number), a); }

static int equations(sfdae_record* record, expr t, const expr* x, const expr* xdot, expr* F, void* user) {
  const expr cosine = sfdae_cos(x[2]), a = sfdae_divide(num(2), sub(num(2), mul(cosine, cosine)));
  const expr b = times(0.5, mul(a, cosine)), c = times(0.5, mul(a, sfdae_sin(x[2]))), d = mul(c, cosine);
  const expr first = mul(x[3], x[3]), both = mul(add(x[3], x[5]), add(x[3], x[5])), hand = add(x[0], x[2]);
  const expr spring = sub(times(2, x[2]), x[1]), path1 = sub(num(1), sfdae_exp(t)), path2 = sub(num(1), t);
  const expr common = add(times(2, mul(c, both)), mul(d, first)), torque = sub(x[6], x[7]);
  int i;
  (void)record, (void)user;
  for (i = 0; i < 3; i++) F[i] = sub(xdot[i], x[3 + i]);
  F[3] = sub(sub(xdot[3], common), add(mul(spring, add(a, times(2, b))), mul(a, torque)));
  F[4] = sub(add(xdot[4], common), mul(spring, sub(num(1), add(times(3, a), times(2, b)))));
  F[4] = add(F[4], sub(mul(a, x[6]), mul(add(a, num(1)), x[7])));
  F[5] = sub(add(xdot[5], common), mul(spring, sub(a, times(9, b))));
  F[5] = add(F[5], add(add(times(2, mul(c, first)), mul(d, both)), mul(add(a, b), torque)));
  F[6] = sub(add(sfdae_cos(x[0]), sfdae_cos(hand)), add(sfdae_cos(path1), sfdae_cos(path2)));
  F[7] = sub(add(sfdae_sin(x[0]), sfdae_sin(hand)), add(sfdae_sin(path1), sfdae_sin(path2)));
  return 0;
}

int main(void) {
  double t = 0, x[8] = {0, 1, 1, 0, 0, 0, 0, 0}, error = HUGE_VAL; /* roughly: the start finds consistent values */
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  int status;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 8;
  problem.equations = equations;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, 1, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, 1, &t, x, NULL);
  if (status >= 0) error = fmax(fabs(x[0] - 1 + exp(t)), fabs(x[2] - exp(t) + t));
  printf("%s %s\n", sfdae_status_name(status), sfdae_message(solver));
  printf("torques %.8f, %.8f, error %.1e\n", x[6], x[7], error);
  sfdae_destroy(&solver);
  return !(error < 1e-11 && fabs(x[6] - 13.59126060175974609888) < 1e-9);
}
