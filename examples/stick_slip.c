/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A mass of 1 on a belt of speed w = 1/2, held by a spring of stiffness 1, with dry friction F, at most 1, and 0.6
 * where
 * it slips:   x' = v,  v' = -x + F,   0: F = 0.6 (slips back),   1: v = w (sticks),   2: F = -0.6 (slips forward)
 *
 * Check: from x = 0.2, where it begins to stick, the motion has the period 0.8 / w + 2 pi - 2 atan(0.4 / w). */
#include <math.h>
#include <stdio.h>

#include <sfdae/hybrid.h>

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const int mode = *(const int*)user;
  (void)record, (void)t;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_subtract(sfdae_add(xdot[1], x[0]), x[2]);
  F[2] = sfdae_subtract(x[mode == 1 ? 1 : 2], sfdae_number(mode == 1 ? 0.5 : 0.6 * (1 - mode)));
  return 0;
}
static int breaks_loose(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot;
  g[0] = *(const double*)user * x[2] - 1; /* F > 1 or -F > 1 */
  return 0;
}
static int speed(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)t, (void)xdot, (void)user;
  g[0] = x[1] - 0.5;
  return 0;
}

int main(void) {
  const double period = 1.6 + 4 * acos(0.0) - 2 * atan(0.8);
  const int from[] = {1, 1, 0, 2}, to[] = {0, 2, 1, 1};
  int k, status = SFDAE_OK, modes[] = {0, 1, 2};
  double t = 0, x[] = {0.2, 0.5, 0.2}, sign[] = {1, -1, 0, 0};
  char report[2000] = "";
  sfdae_nonlinear_problem problem;
  sfdae_transition transition;
  sfdae_passage last;
  sfdae_solver* solvers[] = {NULL, NULL, NULL};
  sfdae_hybrid* hybrid = NULL;
  sfdae_create_hybrid(&hybrid), sfdae_passage_init(&last, sizeof last);
  sfdae_transition_init(&transition, sizeof transition), sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 3, problem.equations = equations;
  for (k = 0; k < 3 && status >= 0; ++k) {
    problem.user = &modes[k];
    status = sfdae_create_nonlinear(&solvers[k], &problem, NULL);
    if (status >= 0) status = sfdae_add_mode(hybrid, solvers[k], NULL, NULL);
  }
  for (k = 0; k < 4 && status >= 0; ++k) {
    transition.from = from[k], transition.to = to[k], transition.user = &sign[k];
    transition.kind = k < 2 ? SFDAE_TRANSITION_CONDITION : SFDAE_TRANSITION_ZERO;
    transition.function = k < 2 ? breaks_loose : speed;
    status = sfdae_add_transition(hybrid, &transition, NULL);
  }
  if (status >= 0) status = sfdae_start_hybrid(hybrid, 1, 0, 10 * period, x, NULL);
  if (status >= 0) status = sfdae_advance_hybrid(hybrid, 10.1 * period, &t, x, NULL);
  if (status >= 0) status = sfdae_get_passage(hybrid, 19, &last); /* sticks for the 11th time */
  sfdae_report_hybrid(hybrid, report, sizeof report, NULL);
  printf("10 periods: %.6f, exactly %.6f. %s\n%s", last.t, 10 * period, sfdae_get_hybrid_message(hybrid), report);
  sfdae_destroy_hybrid(&hybrid);
  for (k = 0; k < 3; ++k) sfdae_destroy(&solvers[k]);
  return status < 0 || !(fabs(last.t - 10 * period) <= 1e-4);
}
