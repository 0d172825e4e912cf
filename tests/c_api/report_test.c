/* SPDX-License-Identifier: BSD-3-Clause
 *
 * What the solver tells about itself: report text, rank decisions, changes of the characteristic values.
 *
 * GELDA's document problem (mu = 1, d = 0, a = 2):   0 = -x1 + t x2 + e^-t,   x1' - t x2' = 0
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

static int E(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1, matrix[3] = -t;
  if (order == 1) matrix[3] = -1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = -1, matrix[2] = t;
  if (order == 1) matrix[2] = 1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

static sfdae_solver* create(const sfdae_options* options) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static void solve(sfdae_solver* solver) {
  double t, x[2] = {3, 3};
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_VALUES_CHANGED);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
}

/* ---- Report ------------------------------------------------------------------------------------- */

/* Every length gives the beginning of the text and a final zero, and writes nothing behind. */
static void lengths_are_respected(const sfdae_solver* solver) {
  size_t needed = 0, length, again;
  char *whole, *part;
  CHECK_STATUS(sfdae_report(solver, NULL, 0, &needed), SFDAE_OK);
  CHECK(needed >= 1);
  whole = (char*)malloc(needed);
  part = (char*)malloc(needed + 8);
  if (!whole || !part) abort();
  memset(whole, '#', needed);
  CHECK_STATUS(sfdae_report(solver, whole, needed, &again), SFDAE_OK);
  CHECK(again == needed && strlen(whole) + 1 == needed);
  for (length = 0; length < needed + 8; length++) {
    const size_t written = length < needed ? length : needed;
    size_t i;
    memset(part, '#', needed + 8);
    again = 0;
    CHECK_STATUS(sfdae_report(solver, part, length, &again), SFDAE_OK);
    CHECK(again == needed);
    if (written > 0) CHECK(memcmp(part, whole, written - 1) == 0 && part[written - 1] == 0);
    for (i = written; i < needed + 8; i++)
      if (part[i] != '#') break;
    CHECK(i == needed + 8);
  }
  CHECK_STATUS(sfdae_report(solver, part, needed, NULL), SFDAE_OK);
  CHECK(strcmp(part, whole) == 0);
  free(whole);
  free(part);
}

static void report_is_complete_in_every_phase(void) {
  sfdae_solver* solver = create(NULL);
  char before[8000], analyzed[8000], solved[8000];
  size_t needed = 17;
  CHECK_STATUS(sfdae_report(solver, NULL, 5, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(needed == 17);
  lengths_are_respected(solver);
  CHECK_STATUS(sfdae_report(solver, before, sizeof before, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  lengths_are_respected(solver);
  CHECK_STATUS(sfdae_report(solver, analyzed, sizeof analyzed, NULL), SFDAE_OK);
  solve(solver);
  lengths_are_respected(solver);
  CHECK_STATUS(sfdae_report(solver, solved, sizeof solved, NULL), SFDAE_OK);
  CHECK(strstr(analyzed, "strangeness index 1") != NULL);
  CHECK(strstr(solved, "strangeness index 1") != NULL);
  CHECK(strlen(before) < strlen(analyzed) && strlen(analyzed) < strlen(solved));
  sfdae_destroy(&solver);
}

/* ---- Rank decisions -------------------------------------------------------------------------------- */

/* Every decision is consistent in itself; returns the smallest gap between kept and dropped values. */
static double check_decisions(const sfdae_solver* solver, int max_index) {
  double smallest = HUGE_VAL;
  int count = -1, i;
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_OK);
  CHECK(count >= 1);
  for (i = 0; i < count; i++) {
    sfdae_decision d;
    sfdae_decision_init(&d, sizeof d);
    CHECK_STATUS(sfdae_get_decision(solver, i, &d), SFDAE_OK);
    CHECK(d.size == sizeof d);
    CHECK(d.t >= 0 && d.t <= 1);
    CHECK(d.level >= 0 && d.level <= max_index);
    CHECK(d.what >= SFDAE_DECISION_STAGE && d.what <= SFDAE_DECISION_ARRAY);
    CHECK(d.what == SFDAE_DECISION_STAGE ? d.stage >= 1 && d.stage <= d.level + 1 : d.stage == 0);
    CHECK(d.rows >= 0 && d.columns >= 0 && d.rank >= 0 && d.rank <= d.rows && d.rank <= d.columns);
    CHECK(d.rank > 0 ? d.kept > 0 : d.kept == 0);
    CHECK(d.rank < d.rows && d.rank < d.columns ? d.dropped >= 0 : d.dropped == 0);
    CHECK(d.noise >= 0 && d.threshold >= 0 && d.gap >= 0);
    if (d.rank > 0) CHECK(d.kept >= d.dropped && d.kept >= d.threshold);
    CHECK(d.dropped <= d.threshold);
    if (d.rank > 0 && d.dropped + d.noise > 0) {
      const double gap = d.kept / (d.dropped > d.noise ? d.dropped : d.noise);
      CHECK(fabs(d.gap - gap) <= 1e-12 * gap);
    }
    CHECK(d.verdict == SFDAE_VERDICT_CLEAR || d.verdict == SFDAE_VERDICT_CONFIRMED ||
          d.verdict == SFDAE_VERDICT_USER);
    if (d.rank > 0 && d.gap < smallest) smallest = d.gap;
  }
  return smallest;
}

static int count_decisions(const sfdae_solver* solver, int what, int verdict) {
  int count = 0, found = 0, i;
  sfdae_get_num_decisions(solver, &count);
  for (i = 0; i < count; i++) {
    sfdae_decision d;
    sfdae_decision_init(&d, sizeof d);
    sfdae_get_decision(solver, i, &d);
    if (d.what == what && d.verdict == verdict) found++;
  }
  return found;
}

static void decisions_support_the_characteristics(void) {
  sfdae_solver* solver = create(NULL);
  sfdae_characteristics c;
  double smallest;
  sfdae_characteristics_init(&c, sizeof c);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_OK);
  CHECK(c.t == 0 && c.strangeness_index == 1 && c.differential == 0 && c.algebraic == 2);
  CHECK(c.undetermined == 0 && c.redundant == 0 && c.rank_E == 1);
  CHECK(c.leading_term > SFDAE_LEADING_AUTOMATIC && c.leading_term <= SFDAE_LEADING_IDENTITY);
  CHECK(c.time_scale > 0);
  smallest = check_decisions(solver, 5);
  CHECK(fabs(c.smallest_gap - smallest) <= 1e-12 * smallest);
  CHECK(c.smallest_gap >= 1e3);
  CHECK(count_decisions(solver, SFDAE_DECISION_STAGE, SFDAE_VERDICT_CLEAR) > 0);
  CHECK(count_decisions(solver, SFDAE_DECISION_A2, SFDAE_VERDICT_CLEAR) > 0);
  sfdae_destroy(&solver);
}

static void svd_judges_the_whole_array(void) {
  sfdae_options options;
  sfdae_solver* solver;
  sfdae_characteristics c;
  sfdae_options_init(&options, sizeof options);
  sfdae_characteristics_init(&c, sizeof c);
  options.reduction = SFDAE_REDUCTION_SVD;
  solver = create(&options);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_OK);
  CHECK(c.strangeness_index == 1 && c.differential == 0 && c.algebraic == 2);
  check_decisions(solver, 5);
  CHECK(count_decisions(solver, SFDAE_DECISION_ARRAY, SFDAE_VERDICT_CLEAR) > 0);
  sfdae_destroy(&solver);
}

static void rank_tol_decides_instead(void) {
  sfdae_options options;
  sfdae_solver* solver;
  int count, i;
  sfdae_options_init(&options, sizeof options);
  options.rank_tol = 1e-9;
  solver = create(&options);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_OK);
  for (i = 0; i < count; i++) {
    sfdae_decision d;
    sfdae_decision_init(&d, sizeof d);
    CHECK_STATUS(sfdae_get_decision(solver, i, &d), SFDAE_OK);
    CHECK(d.verdict == SFDAE_VERDICT_USER);
  }
  sfdae_destroy(&solver);
}

static void decisions_that_do_not_exist_are_refused(void) {
  sfdae_solver* solver = create(NULL);
  sfdae_decision d, before;
  int count = -1;
  sfdae_decision_init(&d, sizeof d);
  d.level = 77;
  before = d;
  CHECK(sfdae_get_decision(solver, 0, &d) < 0);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_OK);
  CHECK_STATUS(sfdae_get_decision(solver, -1, &d), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_decision(solver, count, &d), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK(memcmp(&d, &before, sizeof d) == 0);
  sfdae_destroy(&solver);
}

/* ---- Unclear ranks ------------------------------------------------------------------------------------ */

static int E_unclear(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = 1, matrix[3] = 1e-14;
  return 0;
}

static int A_decay(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[3] = -1;
  return 0;
}

/* eps x2' = -x2 with eps near the rounding errors is neither differential nor algebraic: the user decides. */
static void unclear_ranks_are_an_error_that_rank_tol_resolves(void) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_characteristics c;
  char text[8000];
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  sfdae_characteristics_init(&c, sizeof c);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E_unclear;
  problem.A = A_decay;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_RANK_UNCLEAR);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK(count_decisions(solver, SFDAE_DECISION_STAGE, SFDAE_VERDICT_UNCLEAR) > 0);
  CHECK_STATUS(sfdae_report(solver, text, sizeof text, NULL), SFDAE_OK);

  options.rank_tol = 1e-12;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_OK);
  CHECK(c.strangeness_index == 0 && c.differential == 1 && c.algebraic == 1 && c.rank_E == 1);
  options.rank_tol = 1e-15;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_OK);
  CHECK(c.strangeness_index == 0 && c.differential == 2 && c.algebraic == 0 && c.rank_E == 2);
  sfdae_destroy(&solver);
}

/* ---- Changes of the characteristic values ------------------------------------------------------------- */

/* x1' = -x1,  (t - 1/2) x2' = x2 - 1:  (0, 2, 0) but (0, 1, 1) at t = 1/2.  x = (e^-t, 1) */
static int E_passes_zero(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = 1, matrix[3] = t - 0.5;
  if (order == 1) matrix[3] = 1;
  return 0;
}

static int A_saddle(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = -1, matrix[3] = 1;
  return 0;
}

static int f_saddle(double t, int order, double* vector, void* user) {
  (void)t, (void)user;
  if (order == 0) vector[1] = -1;
  return 0;
}

static void changes_are_located(void) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_change change;
  double t, x[2] = {1, 1};
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_change_init(&change, sizeof change);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = E_passes_zero;
  problem.A = A_saddle;
  problem.f = f_saddle;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_CHARACTERISTICS_CHANGED);
  CHECK(strstr(sfdae_message(solver), "0.5") != NULL || strstr(sfdae_message(solver), "0.49") != NULL);
  CHECK(t > 0 && t <= 0.5);
  CHECK(fabs(x[0] - exp(-t)) <= 10 * (1e-6 * exp(-t) + 1e-6) && fabs(x[1] - 1) <= 10 * 2e-6);
  CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_OK);
  CHECK(fabs(change.t - 0.5) <= 1e-6); /* the step is below 1 */
  CHECK(change.old_strangeness_index == 0 && change.old_differential == 2 && change.old_algebraic == 0);
  CHECK(change.old_undetermined == 0 && change.old_redundant == 0);
  if (change.new_strangeness_index == -1)
    CHECK(change.new_differential == -1 && change.new_algebraic == -1 && change.new_redundant == -1);
  else CHECK(change.new_strangeness_index == 0 && change.new_differential == 1 && change.new_algebraic == 1);

  /* Behind the change a new analysis goes on. */
  x[0] = exp(-0.6);
  x[1] = 1;
  CHECK_STATUS(sfdae_analyze(solver, 0.6, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0.6, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1 && fabs(x[0] - exp(-1)) <= 10 * (1e-6 * exp(-1) + 1e-6));
  sfdae_destroy(&solver);
}

/* ---- Certificates ------------------------------------------------------------------------------- */

/* [1 1; 1 1+h] x' = -x: entries that change by h / 4 of themselves make E singular. */
static double h;

static int nearly_singular(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[1] = matrix[2] = 1, matrix[3] = 1 + h;
  return 0;
}

static int minus_identity(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[3] = -1;
  return 0;
}

static void certificates_tell_the_distance(void) {
  for (h = 1e-2; h > 1e-7; h /= 10) {
    sfdae_linear_problem problem;
    sfdae_solver* solver = NULL;
    double distance = -1, x[2] = {1, 1}, t, before[2], after[2];
    char text[4000];
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 2;
    problem.E = nearly_singular;
    problem.A = minus_identity;
    CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_certify(solver, &distance), SFDAE_NOT_STARTED);
    CHECK(distance == -1);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_certify(solver, &distance), SFDAE_OK);
    CHECK(distance >= h / 20 && distance <= h);
    CHECK_STATUS(sfdae_report(solver, text, sizeof text, NULL), SFDAE_OK);
    CHECK(strstr(text, "the smallest relative change of the data that gives another answer is about") != NULL);
    /* Nothing of the integration changes. */
    CHECK_STATUS(sfdae_advance(solver, 1, &t, before, NULL), SFDAE_OK);
    x[0] = x[1] = 1;
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, after, NULL), SFDAE_OK);
    CHECK(memcmp(before, after, sizeof before) == 0);
    CHECK_STATUS(sfdae_certify(solver, NULL), SFDAE_OK);
    sfdae_destroy(&solver);
  }
  CHECK_STATUS(sfdae_certify(NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
}

int main(void) {
  certificates_tell_the_distance();
  report_is_complete_in_every_phase();
  decisions_support_the_characteristics();
  svd_judges_the_whole_array();
  rank_tol_decides_instead();
  decisions_that_do_not_exist_are_refused();
  unclear_ranks_are_an_error_that_rank_tol_resolves();
  changes_are_located();
  return failures != 0;
}
