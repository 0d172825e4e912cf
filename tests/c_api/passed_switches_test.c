/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Switches of conditions that an integration has passed: their times, texts, branches, jumps. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

#define NEAR(a, b, tol) CHECK(fabs((a) - (b)) <= (tol))

/* x0' = 1 if x0 < 0.5, else 2; x1' = x2 and x1 = 3 where t > 0.75, else 0: x2 has an impulse. */
static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)record, (void)user;
  const sfdae_expression early = sfdae_less(x[0], sfdae_number(0.5));
  const sfdae_expression late = sfdae_greater(t, sfdae_number(0.75));
  F[0] = sfdae_subtract(xdot[0], sfdae_choose(early, sfdae_number(1), sfdae_number(2)));
  F[1] = sfdae_subtract(xdot[1], x[2]);
  F[2] = sfdae_subtract(x[1], sfdae_choose(late, sfdae_number(3), sfdae_number(0)));
  return 0;
}

static sfdae_solver* create(int method) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = 1e-7;
  options.method = method;
  problem.num_equations = problem.num_unknowns = 3;
  problem.equations = equations;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

static void expect_switch(const sfdae_solver* solver, long number, double t, int before, int after, int jumps,
                          const char* condition) {
  sfdae_switch found;
  char text[100];
  size_t needed = 0;
  CHECK_STATUS(sfdae_switch_init(&found, sizeof found), SFDAE_OK);
  CHECK_STATUS(sfdae_get_switch(solver, number, &found, text, sizeof text, &needed), SFDAE_OK);
  NEAR(found.t, t, 1e-6);
  CHECK(found.before == before && found.after == after && found.jumps == jumps);
  CHECK(found.condition == number);
  CHECK(strcmp(text, condition) == 0);
  CHECK(needed == strlen(condition) + 1);
}

static void switches_are_listed(int method) {
  double t, x[3] = {0, 0, 0};
  long count = -1;
  char report[20000];
  sfdae_statistics statistics;
  sfdae_solver* solver = create(method);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_NOT_STARTED);
  CHECK(count == -1);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_OK);
  CHECK(count == 0);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  NEAR(x[0], 1.5, 1e-6);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_OK);
  CHECK(count == 2);
  expect_switch(solver, 0, 0.5, 1, 0, 0, "0.5 - x[0] > 0");
  expect_switch(solver, 1, 0.75, 0, 1, 1, "t - 0.75 > 0");
  sfdae_statistics_init(&statistics, sizeof statistics);
  CHECK_STATUS(sfdae_get_statistics(solver, &statistics), SFDAE_OK);
  CHECK(statistics.switches == 2 && statistics.jumps == 1);
  CHECK_STATUS(sfdae_report(solver, report, sizeof report, NULL), SFDAE_OK);
  x[0] = x[1] = x[2] = 0;
  CHECK(strstr(report, "switches of conditions: 2, with jumps of x by impulses: 1") != NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_OK);
  CHECK(count == 0);
  sfdae_destroy(&solver);
}

static void illegal_use_is_refused(void) {
  double t, x[3] = {0, 0, 0};
  char text[4] = "abc";
  size_t needed = 7;
  sfdae_switch found = {0};
  sfdae_solver* solver = create(SFDAE_METHOD_BDF);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_switches(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_switch(solver, 0, &found, NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "sfdae_switch_init") != NULL);
  sfdae_switch_init(&found, sizeof found);
  CHECK_STATUS(sfdae_get_switch(solver, 2, &found, text, sizeof text, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_switch(solver, -1, &found, text, sizeof text, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_switch(solver, 0, &found, NULL, 1, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(found.t == 0 && needed == 7 && strcmp(text, "abc") == 0);
  CHECK_STATUS(sfdae_get_switch(solver, 0, &found, text, sizeof text, NULL), SFDAE_OK);
  CHECK(strcmp(text, "0.5") == 0);
  CHECK_STATUS(sfdae_get_num_switches(NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_switch(NULL, 0, &found, NULL, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

int main(void) {
  switches_are_listed(SFDAE_METHOD_BDF);
  switches_are_listed(SFDAE_METHOD_RADAU);
  illegal_use_is_refused();
  return failures > 0;
}
