/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The theory's objects of every solver that a program destroys: the linker puts these functions in place of those of
 * the library (--wrap), whatever language the program is written in. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "theory_check.h"

int __real_sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem,
                               const sfdae_options* options);
int __real_sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                                  const sfdae_options* options);
int __real_sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                                  const sfdae_options* options);
int __real_sfdae_destroy(sfdae_solver** solver);
int __wrap_sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem,
                               const sfdae_options* options);
int __wrap_sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                                  const sfdae_options* options);
int __wrap_sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                                  const sfdae_options* options);
int __wrap_sfdae_destroy(sfdae_solver** solver);

enum { MOST = 64 };
static theory_subject subjects[MOST];
static int num_subjects, num_checked;

static void report(void) {
  if (num_checked > 0) return;
  fprintf(stderr, "no solver has been checked\n");
  fflush(stdout);
  _Exit(1);
}

static int keep(int status, sfdae_solver* solver, enum theory_kind kind, int m, int n) {
  const theory_subject subject = {"example", kind, m, n, solver};
  if (num_subjects == 0) atexit(report);
  if (status >= 0 && num_subjects < MOST) subjects[num_subjects++] = subject;
  return status;
}

int __wrap_sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* p, const sfdae_options* options) {
  const int status = __real_sfdae_create_linear(solver, p, options);
  return keep(status, *solver, THEORY_LINEAR, p->num_equations, p->num_unknowns);
}

int __wrap_sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* p,
                                  const sfdae_options* options) {
  const int status = __real_sfdae_create_nonlinear(solver, p, options);
  /* Linear formulas become linear problems: their array needs no x. */
  const int is_linear =
      p->total_derivative == NULL && sfdae_get_derivative_array(*solver, 0, 0, NULL, NULL, NULL) >= 0;
  return keep(status, *solver, is_linear ? THEORY_LINEAR : THEORY_NONLINEAR, p->num_equations, p->num_unknowns);
}

int __wrap_sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* p,
                                  const sfdae_options* options) {
  const int status = __real_sfdae_create_multibody(solver, p, options);
  const int velocities = p->num_velocities > 0 ? p->num_velocities : p->num_positions;
  const int n = p->num_positions + velocities + p->num_constraints + p->num_nonholonomic;
  return keep(status, *solver, p->equations ? THEORY_MULTIBODY : THEORY_MULTIBODY_CALLBACKS, n, n);
}

/* At the end of the last step and within it; without steps, at the point of the analysis. */
static int violations_of(const theory_subject* subject) {
  sfdae_statistics s;
  sfdae_characteristics c;
  sfdae_statistics_init(&s, sizeof s);
  sfdae_characteristics_init(&c, sizeof c);
  if (sfdae_get_characteristics(subject->solver, &c) < 0) return 0;
  num_checked++;
  sfdae_get_statistics(subject->solver, &s);
  if (s.steps > 0)
    return theory_check(subject, s.t_internal) + theory_check(subject, s.t_internal - 0.3 * s.last_step);
  return subject->kind == THEORY_LINEAR ? theory_check_linear(subject, c.t) : theory_check(subject, c.t);
}

int __wrap_sfdae_destroy(sfdae_solver** solver) {
  int i;
  for (i = 0; solver && i < num_subjects; i++)
    if (subjects[i].solver && subjects[i].solver == *solver) {
      if (violations_of(&subjects[i]) > 0) {
        fflush(stdout);
        _Exit(1);
      }
      subjects[i].solver = NULL;
    }
  return __real_sfdae_destroy(solver);
}
