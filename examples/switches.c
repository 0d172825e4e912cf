/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What is kept over a switch: capacitors of 1 F (with a leak of 1 S) and 3 F, connected at t = 1, where v = (2, 0), and
 * inertias of 1 and 2 with speeds of 0.2 and 1 that a clutch joins at t = 1:
 *
 *     v1' + v1 + i = 0,  3 v2' - i = 0,  i = 0, then v1 = v2;     w1' + T = 0,  2 w2' - T = 0,  T = 0, then w1 = w2
 *
 * Check: v = 2 / 4 by charge, 3/2 of which flow; then exp(-(t - 1) / 4) / 2. w = 2.2 / 3 by momentum, with an impulse
 * 0.2 - 2.2 / 3 of T. */
#include <math.h>
#include <stdio.h>

#include <sfdae/modes.h>

typedef struct {
  double first, second, leak; /* C1, C2 and the leak, or the inertias and no friction */
  double x0[3], after, impulse, end;
} pair;

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const pair* p = (const pair*)user;
  const sfdae_expression closed = sfdae_parameter(record, "closed", 0),
                         open = sfdae_subtract(sfdae_number(1), closed);
  const sfdae_expression leak = sfdae_multiply(sfdae_number(p->leak), x[0]);
  (void)t;
  F[0] = sfdae_add(sfdae_add(sfdae_multiply(sfdae_number(p->first), xdot[0]), leak), x[2]);
  F[1] = sfdae_subtract(sfdae_multiply(sfdae_number(p->second), xdot[1]), x[2]);
  F[2] = sfdae_add(sfdae_multiply(closed, sfdae_subtract(x[0], x[1])), sfdae_multiply(open, x[2]));
  return 0;
}

static int run(const char* name, pair* p) {
  double t = 0, x[3] = {p->x0[0], p->x0[1], p->x0[2]}, impulse[3] = {0, 0, 0}, error;
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  int status;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 3;
  problem.equations = equations, problem.user = p;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, 1, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, 1, &t, x, NULL);
  printf("%s: %.6f and %.6f", name, x[0], x[1]);
  if (status >= 0) status = sfdae_set_parameter(solver, "closed", 1);
  if (status >= 0) status = sfdae_jump(solver, 1, 2, x, x, 1, impulse);
  printf(" become %.6f by an impulse of %.6f;", x[0], impulse[2]);
  error = fmax(fabs(x[0] - p->after), fmax(fabs(x[1] - p->after), fabs(impulse[2] - p->impulse)));
  if (status >= 0) status = sfdae_start(solver, 1, 2, x, NULL);
  if (status >= 0) status = sfdae_advance(solver, 2, &t, x, NULL);
  printf(" %.6f at t = %g. %s %s\n", x[0], t, sfdae_status_name(status), sfdae_message(solver));
  sfdae_destroy(&solver);
  return status != SFDAE_OK || !(error <= 1e-5) || !(fabs(x[0] - p->end) <= 1e-5);
}

int main(void) {
  pair capacitors = {1, 3, 1, {2 * exp(1), 0, 0}, 0.5, 1.5, 0.5 * exp(-0.25)};
  pair clutch = {1, 2, 0, {0.2, 1, 0}, 2.2 / 3, 0.2 - 2.2 / 3, 2.2 / 3};
  return run("volts", &capacitors) + run("speeds", &clutch);
}
