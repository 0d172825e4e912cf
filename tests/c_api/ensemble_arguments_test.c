/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Ensembles in C: what is refused changes nothing, what may be left out can be left out.
 *
 *     x1' = x2,   x2' = -p^2 x1,   0 = x3^3 + x3 - x1:   x1 = cos p t from (1, 0), x3 by bisection
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "checks.h"

enum { N = 3, INSTANCES = 6, TIMES = 2, TEXT = 40 };

static const char* const names[] = {"p"};
static const double times[TIMES] = {0.5, 2};
static double parameters[INSTANCES], x0[N * INSTANCES];
static double x[N * TIMES * INSTANCES], xdot[N * TIMES * INSTANCES];
static int statuses[INSTANCES], num_outputs[INSTANCES];
static char messages[INSTANCES][TEXT];

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* unknowns,
                     const sfdae_expression* derivatives, sfdae_expression* F, void* user) {
  const sfdae_expression p = sfdae_parameter(record, "p", 1), x3 = unknowns[2];
  (void)t, (void)user;
  F[0] = sfdae_subtract(derivatives[0], unknowns[1]);
  F[1] = sfdae_add(derivatives[1], sfdae_multiply(sfdae_multiply(p, p), unknowns[0]));
  F[2] = sfdae_subtract(sfdae_add(sfdae_power(x3, sfdae_number(3)), x3), unknowns[0]);
  return 0;
}

static double root(double right) {
  double low = -2, high = 2;
  while (high - low > 1e-14) {
    const double middle = 0.5 * (low + high);
    if (middle * middle * middle + middle < right) low = middle;
    else high = middle;
  }
  return low;
}

static sfdae_solver* create(void) {
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.equations = equations;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static sfdae_ensemble ensemble_of_all(void) {
  sfdae_ensemble ensemble;
  int i;
  CHECK_STATUS(sfdae_ensemble_init(&ensemble, sizeof ensemble), SFDAE_OK);
  CHECK(ensemble.size == sizeof ensemble && ensemble.num_threads == 0 && ensemble.num_instances == 0);
  for (i = 0; i < INSTANCES; i++) {
    parameters[i] = 1 + 0.25 * i;
    x0[N * i] = 1, x0[N * i + 1] = 0, x0[N * i + 2] = 0.5;
  }
  ensemble.num_instances = INSTANCES;
  ensemble.num_parameters = 1;
  ensemble.parameter_names = names;
  ensemble.parameters = parameters;
  ensemble.x0 = x0;
  ensemble.num_times = TIMES;
  ensemble.times = times;
  ensemble.num_threads = 2;
  return ensemble;
}

static sfdae_ensemble_results results_of_all(void) {
  sfdae_ensemble_results results;
  CHECK_STATUS(sfdae_ensemble_results_init(&results, sizeof results), SFDAE_OK);
  results.x = x;
  results.xdot = xdot;
  results.statuses = statuses;
  results.num_outputs = num_outputs;
  results.messages = messages[0];
  results.message_length = TEXT;
  return results;
}

static void check_outputs(void) {
  int i, k;
  for (i = 0; i < INSTANCES; i++)
    for (k = 0; k < TIMES; k++) {
      const double* const at = x + N * (k + TIMES * i);
      const double p = parameters[i];
      /* Errors grow in the phase: far below 1000 tolerances until t = 2. */
      CHECK(fabs(at[0] - cos(p * times[k])) < 1e-3);
      CHECK(fabs(at[2] - root(at[0])) < 1e-12);
    }
}

/* ---- What it does ---------------------------------------------------------------------------- */

static void test_solves(void) {
  sfdae_solver* solver = create();
  const sfdae_ensemble ensemble = ensemble_of_all();
  sfdae_ensemble_results results = results_of_all();
  int i;
  memset(messages, '?', sizeof messages);
  CHECK_STATUS(sfdae_solve_ensemble(solver, &ensemble, &results), SFDAE_OK);
  CHECK(sfdae_message(solver)[0] == '\0');
  CHECK(results.num_failed == 0 && results.num_analyses == 1);
  CHECK(results.num_threads >= 1 && results.num_threads <= 2);
  for (i = 0; i < INSTANCES; i++) {
    CHECK_STATUS(statuses[i], SFDAE_OK);
    CHECK(num_outputs[i] == TIMES && messages[i][0] == '\0');
    CHECK(fabs(xdot[N * TIMES * i] - x[N * TIMES * i + 1]) < 1e-3);
  }
  check_outputs();
  sfdae_destroy(&solver);
}

/* Structs of programs that know no more than what is needed. */
static void test_leaves_out_what_is_not_asked_for(void) {
  sfdae_solver* solver = create();
  sfdae_ensemble ensemble = ensemble_of_all();
  sfdae_ensemble_results results;
  memset(x, 0, sizeof x);
  ensemble.size = offsetof(sfdae_ensemble, monitor);
  memset(&ensemble.monitor, 1, sizeof ensemble.monitor);
  sfdae_ensemble_results_init(&results, sizeof results);
  results.size = offsetof(sfdae_ensemble_results, num_failed);
  results.x = x;
  results.statuses = statuses;
  results.num_failed = 77;
  CHECK_STATUS(sfdae_solve_ensemble(solver, &ensemble, &results), SFDAE_OK);
  CHECK(results.num_failed == 77 && results.size == offsetof(sfdae_ensemble_results, num_failed));
  check_outputs();
  sfdae_destroy(&solver);
}

static void test_cuts_messages(void) {
  sfdae_solver* solver = create();
  const sfdae_ensemble ensemble = ensemble_of_all();
  sfdae_ensemble_results results = results_of_all();
  int i;
  parameters[1] = HUGE_VAL;
  memset(x, 0, sizeof x);
  CHECK_STATUS(sfdae_solve_ensemble(solver, &ensemble, &results), SFDAE_INSTANCES_FAILED);
  CHECK(results.num_failed == 1);
  CHECK(strstr(sfdae_message(solver), "first of all instance 1 with SFDAE_ILLEGAL_ARGUMENT: ") != NULL);
  for (i = 0; i < INSTANCES; i++) CHECK((statuses[i] == SFDAE_OK) == (i != 1));
  CHECK(num_outputs[1] == 0 && x[N * TIMES] == 0);
  CHECK(strncmp(messages[1], "the value of parameter \"p\" is inf.", TEXT - 1) == 0);
  results.message_length = 5;
  CHECK_STATUS(sfdae_solve_ensemble(solver, &ensemble, &results), SFDAE_INSTANCES_FAILED);
  CHECK(strcmp(messages[0] + 5, "the ") == 0);
  sfdae_destroy(&solver);
}

static sfdae_solver* watched;
static int status_within;

static int look_from_within(const sfdae_ensemble_progress* progress, void* user) {
  double p = 0;
  CHECK(progress->size == sizeof *progress && user == &status_within);
  status_within = sfdae_start(watched, 0, 1, x, NULL);
  CHECK_STATUS(sfdae_get_parameter(watched, "p", &p), SFDAE_OK);
  CHECK(p == 1);
  return 0;
}

static void test_is_busy_for_its_monitor(void) {
  sfdae_ensemble ensemble = ensemble_of_all();
  sfdae_ensemble_results results = results_of_all();
  watched = create();
  ensemble.monitor = look_from_within;
  ensemble.monitor_user = &status_within;
  CHECK_STATUS(sfdae_solve_ensemble(watched, &ensemble, &results), SFDAE_OK);
  CHECK_STATUS(status_within, SFDAE_BUSY);
  sfdae_destroy(&watched);
}

/* ---- What it refuses ------------------------------------------------------------------------- */

/* An integration under way, refused ensembles, and no bit has changed. */
static double solved_beside(void (*disturb)(sfdae_solver*)) {
  sfdae_solver* solver = create();
  double t = 0, point[N] = {1, 0, 0.7};
  CHECK_STATUS(sfdae_start(solver, 0, 3, point, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, point, NULL), SFDAE_OK);
  if (disturb) disturb(solver);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, point, NULL), SFDAE_OK);
  sfdae_destroy(&solver);
  return point[0];
}

static void refuse(sfdae_solver* solver, const sfdae_ensemble* ensemble, sfdae_ensemble_results* results,
                   const char* why) {
  const sfdae_ensemble_results before = *results;
  memset(x, 7, sizeof x), memset(statuses, 7, sizeof statuses);
  CHECK_STATUS(sfdae_solve_ensemble(solver, ensemble, results), SFDAE_ILLEGAL_ARGUMENT);
  if (!strstr(sfdae_message(solver), why)) {
    fprintf(stderr, "\"%s\" does not say \"%s\"\n", sfdae_message(solver), why);
    failures++;
  }
  CHECK(memcmp(&before, results, sizeof before) == 0);
  CHECK(memchr(x, 0, sizeof x) == NULL && statuses[0] == 0x07070707);
}

#define REFUSE(change, why)                            \
  do {                                                 \
    sfdae_ensemble ensemble = ensemble_of_all();       \
    sfdae_ensemble_results results = results_of_all(); \
    change;                                            \
    refuse(solver, &ensemble, &results, why);          \
  } while (0)

static void refuse_everything(sfdae_solver* solver) {
  static const char* const unknown[] = {"q"};
  static const char* const twice[] = {"p", "p"};
  static const char* const none[] = {NULL};
  static const double backward[] = {0.5, 0.4}, equal[] = {0.5, 0.5}, at_start[] = {0, 0}, endless[] = {HUGE_VAL, 2},
                      infinite[] = {1, HUGE_VAL}, before[] = {-1, 2};
  CHECK_STATUS(sfdae_solve_ensemble(solver, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  REFUSE(ensemble.size = 0, "sfdae_ensemble_init");
  REFUSE(results.size = 0, "sfdae_ensemble_results_init");
  REFUSE(ensemble.num_instances = -1, "num_instances = -1");
  REFUSE(ensemble.num_threads = -1, "num_threads = -1");
  REFUSE(ensemble.num_threads = 1025, "num_threads = 1025");
  REFUSE(ensemble.num_parameters = -1, "num_parameters = -1");
  REFUSE(ensemble.parameter_names = NULL, "parameter_names");
  REFUSE(ensemble.parameters = NULL, "parameters");
  REFUSE(ensemble.parameter_names = unknown, "no parameter \"q\"");
  REFUSE(ensemble.parameter_names = none, "parameter_names[0] is NULL");
  REFUSE((ensemble.parameter_names = twice, ensemble.num_parameters = 2), "named twice");
  REFUSE(ensemble.num_times = 0, "num_times = 0");
  REFUSE(ensemble.times = NULL, "times is NULL");
  REFUSE(ensemble.times = backward, "times[1] = 0.4");
  REFUSE(ensemble.times = equal, "times[1] = 0.5");
  REFUSE(ensemble.times = at_start, "must be finite and different");
  REFUSE(ensemble.times = endless, "times[0] = inf");
  REFUSE(ensemble.times = infinite, "must be finite and different");
  REFUSE(ensemble.times = before, "times[0] = -1");
  REFUSE(ensemble.t0 = NAN, "must be finite and different");
  REFUSE(ensemble.x0 = NULL, "x0 is NULL");
  REFUSE(results.x = NULL, "x or statuses");
  REFUSE(results.statuses = NULL, "x or statuses");
  REFUSE(results.message_length = 0, "message_length is 0");
  REFUSE(results.message_length = (size_t)-1, "message_length is more than");
}

static int never(double t, const double* at, const double* slopes, double* g, void* user) {
  (void)t, (void)at, (void)slopes, (void)user;
  g[0] = 1;
  return 0;
}

static void refuse_events(sfdae_solver* solver) {
  CHECK_STATUS(sfdae_set_events(solver, 1, never, NULL, NULL), SFDAE_OK);
  REFUSE((void)0, "sfdae_set_events");
  CHECK_STATUS(sfdae_set_events(solver, 0, NULL, NULL, NULL), SFDAE_OK);
}

static int matrix(double t, int order, double* values, void* user) {
  (void)t, (void)user;
  if (order == 0) values[0] = 1;
  return 0;
}

static void test_refusals(void) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_options options;
  const double undisturbed = solved_beside(NULL);
  CHECK(solved_beside(refuse_everything) == undisturbed);
  CHECK(solved_beside(refuse_events) == undisturbed);
  CHECK_STATUS(sfdae_ensemble_init(NULL, sizeof(sfdae_ensemble)), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_ensemble_results_init(NULL, sizeof(sfdae_ensemble_results)), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_solve_ensemble(NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);

  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 1;
  problem.E = problem.A = matrix;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  REFUSE((void)0, "recorded equations");
  sfdae_destroy(&solver);

  solver = create();
  sfdae_options_init(&options, sizeof options);
  options.use_stop_time = 1, options.stop_time = 1.5;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  REFUSE((void)0, "beyond stop_time");
  sfdae_destroy(&solver);
}

int main(void) {
  test_solves();
  test_leaves_out_what_is_not_asked_for();
  test_cuts_messages();
  test_is_busy_for_its_monitor();
  test_refusals();
  CHECK(strcmp(sfdae_status_name(SFDAE_INSTANCES_FAILED), "SFDAE_INSTANCES_FAILED") == 0);
  return failures != 0;
}
