/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Nonlinear problems from init to destroy: every function with right and with wrong arguments. A call that fails says
 * why and leaves its outputs as they were.
 */
#include <limits.h>
#include <stdio.h>

#include "nonlinear_pendulum.h"

#define TOL 1e-6

static void solve_and_check(sfdae_solver* solver) {
  double t = 0, x[N];
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1 && accurate(t, x, TOL) && violation(x) <= 1e-12);
}

/* ---- Problems --------------------------------------------------------------------------------- */

static void init_writes_no_more_than_its_caller_has(void) {
  union {
    sfdae_nonlinear_problem problem;
    unsigned char bytes[sizeof(sfdae_nonlinear_problem) + 64];
  } p;
  size_t size;
  CHECK(sfdae_nonlinear_problem_init(NULL, sizeof p.problem) == SFDAE_ILLEGAL_ARGUMENT);
  for (size = 0; size <= sizeof p; size++) {
    int status;
    guard(&p, sizeof p);
    status = sfdae_nonlinear_problem_init(&p.problem, size);
    CHECK(guarded(p.bytes + size, sizeof p - size));
    CHECK(status == SFDAE_OK ? p.problem.size == size : status == SFDAE_ILLEGAL_ARGUMENT && guarded(&p, size));
  }
  CHECK_STATUS(sfdae_nonlinear_problem_init(&p.problem, sizeof p.problem), SFDAE_OK);
  CHECK(p.problem.equations == NULL && p.problem.linear_equations == NULL && p.problem.total_derivative == NULL);
  CHECK(p.problem.num_prescribed == 0 && p.problem.user == NULL);
}

/* Creation and check refuse with the status and a reason. */
static void refused(int line, const sfdae_nonlinear_problem* problem, const sfdae_options* options, int expected) {
  static int nothing;
  sfdae_solver* solver = (sfdae_solver*)(void*)&nothing;
  char text[512], tiny[4];
  check_status(__FILE__, line, "sfdae_create_nonlinear", sfdae_create_nonlinear(&solver, problem, options), expected);
  CHECK(solver == NULL);
  guard(text, sizeof text);
  check_status(__FILE__, line, "sfdae_check_nonlinear", sfdae_check_nonlinear(problem, options, text, sizeof text),
               expected);
  CHECK(memchr(text, 0, sizeof text) != NULL && text[0] != 0);
  guard(tiny, sizeof tiny);
  CHECK(sfdae_check_nonlinear(problem, options, tiny, 3) == expected);
  CHECK(tiny[2] == 0 && memcmp(tiny, text, 2) == 0 && guarded(tiny + 3, 1));
  CHECK(sfdae_check_nonlinear(problem, options, NULL, 0) == expected);
}
#define REFUSED(problem, options, expected) refused(__LINE__, (problem), (options), (expected))

static int linear_equations(sfdae_record* record, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                            sfdae_expression* f, void* user) {
  (void)record, (void)t, (void)E, (void)A, (void)f, (void)user;
  return 0;
}

static void wrong_problems_are_refused(void) {
  static const int twice[2] = {1, 1}, outside[1] = {N}, negative[1] = {-1};
  static const int sizes[][2] = {{-1, N}, {M, -1}, {5001, N}, {M, INT_MAX}, {INT_MIN, INT_MIN}};
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_options options = default_options();
  char text[64];
  size_t i;
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, text, sizeof text), SFDAE_OK);
  CHECK(text[0] == 0);
  CHECK_STATUS(sfdae_check_nonlinear(&problem, NULL, NULL, 8), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_create_nonlinear(NULL, &problem, NULL), SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(NULL, NULL, SFDAE_ILLEGAL_ARGUMENT);

  for (i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    problem = recorded_pendulum();
    problem.num_equations = sizes[i][0];
    problem.num_unknowns = sizes[i][1];
    REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  }
  problem = recorded_pendulum();
  problem.num_unknowns = 0;
  REFUSED(&problem, NULL, SFDAE_EMPTY_PROBLEM);
  problem = recorded_pendulum();
  problem.num_equations = 0;
  REFUSED(&problem, NULL, SFDAE_EMPTY_PROBLEM);

  /* One function, no less and no more. */
  problem = pendulum_problem();
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem = recorded_pendulum();
  problem.total_derivative = pendulum_derivative;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.linear_equations = linear_equations;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.equations = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);

  problem = recorded_pendulum();
  problem.num_prescribed = -1;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.num_prescribed = N + 1;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.num_prescribed = 2;
  problem.prescribed = twice;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.num_prescribed = 1;
  problem.prescribed = outside;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.prescribed = negative;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.prescribed = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem = recorded_pendulum();
  problem.prescribed_values = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);

  problem = recorded_pendulum();
  problem.size = 0;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem = recorded_pendulum();
  options.rtol = NAN;
  REFUSED(&problem, &options, SFDAE_ILLEGAL_ARGUMENT);
  options = default_options();
  options.size = 0;
  REFUSED(&problem, &options, SFDAE_ILLEGAL_ARGUMENT);
}

enum mistake { NONE, ENTRY_FORGOTTEN, NOT_FINITE, NEVER_SET, RETURNS_MINUS_1, RETURNS_1, MISTAKES };
typedef struct {
  enum mistake mistake;
  int calls;
} recording;

static int mistaken(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void* user) {
  recording* r = (recording*)user;
  const sfdae_expression last = F[M - 1];
  r->calls++;
  pendulum_equations(record, t, x, xdot, F, NULL);
  switch (r->mistake) {
    case ENTRY_FORGOTTEN: F[M - 1] = last; break;
    case NOT_FINITE: F[0] = sfdae_add(F[0], sfdae_log(sfdae_number(-1))); break;
    case NEVER_SET: F[1] = sfdae_add(F[1], last); break;
    case RETURNS_MINUS_1: return -1;
    case RETURNS_1: return 1;
    default: break;
  }
  return 0;
}

/* They name the place, and nothing is kept. */
static void mistakes_in_equations_are_refused(void) {
  static const int expected[MISTAKES] = {SFDAE_OK,
                                         SFDAE_ILLEGAL_ARGUMENT,
                                         SFDAE_ILLEGAL_ARGUMENT,
                                         SFDAE_ILLEGAL_ARGUMENT,
                                         SFDAE_CALLBACK_STOPPED,
                                         SFDAE_CALLBACK_FAILED};
  static const char* const words[MISTAKES] = {"", "residual[4]", "finite", "no value", "-1", "1"};
  sfdae_nonlinear_problem problem = recorded_pendulum();
  recording r;
  int mistake;
  memset(&r, 0, sizeof r);
  problem.equations = mistaken;
  problem.user = &r;
  for (mistake = 0; mistake < MISTAKES; mistake++) {
    sfdae_solver* solver = NULL;
    char text[256];
    r.mistake = (enum mistake)mistake;
    r.calls = 0;
    CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), expected[mistake]);
    CHECK(r.calls == 1 && (solver != NULL) == (mistake == NONE));
    if (mistake == NONE) {
      solve_and_check(solver);
      CHECK(r.calls == 1);
      sfdae_destroy(&solver);
    } else {
      CHECK(sfdae_check_nonlinear(&problem, NULL, text, sizeof text) == expected[mistake]);
      CHECK(strstr(text, words[mistake]) != NULL);
    }
  }
}

/* What is passed in may go when the call is over, but for the callbacks and their object. */
static void everything_is_copied(void) {
  int component = N - 1;
  double tolerances[N] = {TOL, TOL, TOL, TOL, TOL, TOL};
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_options options = default_options();
  sfdae_solver* solver;
  problem.prescribed = &component;
  options.rtol_vector = options.atol_vector = tolerances;
  solver = CREATE(&problem, &options);
  component = 0;
  guard(tolerances, sizeof tolerances);
  guard(&problem, sizeof problem);
  guard(&options, sizeof options);
  solve_and_check(solver);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
  CHECK(solver == NULL);
}

/* ---- Calls ------------------------------------------------------------------------------------ */

static void no_solver_is_refused(void) {
  double x[N], value = unset, jet[3 * N];
  sfdae_derivative_check check;
  sfdae_derivative_check_init(&check, sizeof check);
  guard(x, sizeof x);
  memset(jet, 0, sizeof jet);
  CHECK(sfdae_analyze_at(NULL, 0, 1, x, NULL) == SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_set_parameter(NULL, "g", 1) == SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_get_parameter(NULL, "g", &value) == SFDAE_ILLEGAL_ARGUMENT && value == unset);
  CHECK(sfdae_check_total_derivatives(NULL, 0, jet, 1, &check) == SFDAE_ILLEGAL_ARGUMENT && check.function == 0);
  CHECK(guarded(x, sizeof x));
}

static void wrong_points_are_refused(void) {
  static const double bad[] = {NAN, INFINITY, -INFINITY};
  sfdae_nonlinear_problem problems[2];
  int k, i;
  problems[0] = recorded_pendulum();
  problems[1] = differentiated_pendulum();
  for (k = 0; k < 2; k++) {
    sfdae_solver* solver = CREATE(&problems[k], NULL);
    sfdae_characteristics c;
    double x[N], xdot[N];
    exact(0, x);
    guard(xdot, sizeof xdot);
    sfdae_characteristics_init(&c, sizeof c);
    CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_ILLEGAL_ARGUMENT);
    CHECK(strstr(sfdae_message(solver), "sfdae_analyze_at") != NULL && c.strangeness_index == 0);
    CHECK_STATUS(sfdae_analyze_at(solver, 0, 0, x, &c), SFDAE_ILLEGAL_ARGUMENT);
    CHECK_STATUS(sfdae_analyze_at(solver, 0, 1, NULL, &c), SFDAE_ILLEGAL_ARGUMENT);
    for (i = 0; i < 3; i++) {
      CHECK_STATUS(sfdae_analyze_at(solver, bad[i], 1, x, &c), SFDAE_ILLEGAL_ARGUMENT);
      CHECK_STATUS(sfdae_analyze_at(solver, 0, bad[i], x, &c), SFDAE_ILLEGAL_ARGUMENT);
      CHECK_STATUS(sfdae_start(solver, bad[i], 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
      CHECK_STATUS(sfdae_make_consistent(solver, bad[i], x, xdot), SFDAE_ILLEGAL_ARGUMENT);
      x[3] = bad[i];
      CHECK_STATUS(sfdae_analyze_at(solver, 0, 1, x, &c), SFDAE_ILLEGAL_ARGUMENT);
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
      CHECK_STATUS(sfdae_make_consistent(solver, 0, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
      exact(0, x);
    }
    CHECK(guarded(xdot, sizeof xdot) && c.strangeness_index == 0 && c.t == 0);
    c.size = 0;
    CHECK_STATUS(sfdae_analyze_at(solver, 0, 1, x, &c), SFDAE_ILLEGAL_ARGUMENT);
    CHECK_STATUS(sfdae_get_characteristics(solver, &c), SFDAE_ILLEGAL_ARGUMENT);
    solve_and_check(solver);
    sfdae_destroy(&solver);
  }
}

/* Far away numbers: an answer, whatever it is, and no crash. */
static void absurd_guesses_are_survived(void) {
  static const double values[] = {0, 1e-300, 1e-8, 1e8, 1e150, 1e300, 1.7e308, -1e308};
  sfdae_nonlinear_problem problems[2];
  int k, i, j;
  problems[0] = recorded_pendulum();
  problems[1] = differentiated_pendulum();
  for (k = 0; k < 2; k++)
    for (i = 0; i < 8; i++)
      for (j = -1; j < N; j++) {
        sfdae_solver* solver = CREATE(&problems[k], NULL);
        double x[N], before[N];
        int status, l;
        exact(0, x);
        for (l = 0; l < N; l++)
          if (j < 0 || l == j) x[l] = values[i];
        memcpy(before, x, sizeof x);
        status = sfdae_make_consistent(solver, 0, x, NULL);
        if (status == SFDAE_OK || status == SFDAE_VALUES_CHANGED)
          CHECK(violation(x) <= 1e-9 * (1 + fabs(x[4]) + x[2] * x[2] + x[3] * x[3]));
        else CHECK(status < 0 && status != SFDAE_INTERNAL && memcmp(x, before, sizeof x) == 0);
        exact(0, x);
        CHECK_STATUS(sfdae_make_consistent(solver, 0, x, NULL), SFDAE_OK);
        CHECK(accurate(0, x, 1e-12));
        sfdae_destroy(&solver);
      }
}

static void calls_too_early_are_refused(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver = CREATE(&problem, NULL);
  sfdae_characteristics c;
  sfdae_initial_report report;
  double t = unset, x[N];
  size_t length = 7;
  int count = -3;
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_initial_report_init(&report, sizeof report);
  guard(x, sizeof x);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_step(solver, 1, &t, x, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_characteristics(solver, &c), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_num_decisions(solver, &count), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_initial_report(solver, &report), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_NOT_STARTED);
  CHECK(t == unset && guarded(x, sizeof x) && count == -3 && length == 7);
  sfdae_destroy(&solver);
}

/* Linear problems alone have arrays that depend on t alone: of others the only point known is that of the analysis. */
static void arrays_are_those_of_points_that_are_known(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver = CREATE(&problem, NULL);
  sfdae_derivative_check check;
  double array[M * N], x[N];
  int vhat = -3;
  sfdae_derivative_check_init(&check, sizeof check);
  guard(array, sizeof array);
  exact(0, x);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0, 0, array, NULL, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, array, NULL, NULL, NULL, &vhat), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0, array, NULL, NULL, NULL, NULL, NULL), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_analyze_at(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 1, 0, array, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_projectors(solver, 1, array, NULL, NULL, NULL, &vhat), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 1, array, NULL, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_derivatives(solver, 0, 1, &check), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strlen(sfdae_message(solver)) > 10);
  CHECK(guarded(array, sizeof array) && vhat == -3 && check.function == 0);
  sfdae_destroy(&solver);
}

/* ---- Parameters and options --------------------------------------------------------------------- */

/* With g = 0 and no force it goes round: x = (cos t, sin t), x5 = 1/2. */
static int no_push(double t, int order, double* values, void* user) {
  (void)t, (void)order, (void)values, (void)user;
  return 0;
}

static void parameters_can_be_changed(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver;
  double value = unset, t = unset, x[N];
  problem.prescribed_values = no_push;
  solver = CREATE(&problem, NULL);
  CHECK_STATUS(sfdae_get_parameter(solver, "g", &value), SFDAE_OK);
  CHECK(value == gravity);
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);

  CHECK_STATUS(sfdae_set_parameter(solver, "h", 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "\"h\"") != NULL);
  CHECK_STATUS(sfdae_set_parameter(solver, "", 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_parameter(solver, NULL, 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_parameter(solver, "g", NAN), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_set_parameter(solver, "g", INFINITY), SFDAE_ILLEGAL_ARGUMENT);
  value = unset;
  CHECK_STATUS(sfdae_get_parameter(solver, "h", &value), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(sfdae_message(solver), "\"g\"") != NULL); /* that of the last call that was more than a question */
  CHECK_STATUS(sfdae_get_parameter(solver, NULL, &value), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_parameter(solver, "g", NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(value == unset);
  CHECK_STATUS(sfdae_advance(solver, 0.1, &t, x, NULL), SFDAE_OK); /* nothing is lost yet */

  CHECK_STATUS(sfdae_set_parameter(solver, "g", 0), SFDAE_OK);
  CHECK_STATUS(sfdae_get_parameter(solver, "g", &value), SFDAE_OK);
  CHECK(value == 0);
  CHECK_STATUS(sfdae_advance(solver, 0.2, &t, x, NULL), SFDAE_OK); /* it goes on without gravity */
  memset(x, 0, sizeof x);
  x[0] = x[3] = 1;
  x[4] = 0.5;
  CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - cos(2.0)) <= 20 * TOL && fabs(x[1] - sin(2.0)) <= 20 * TOL && fabs(x[4] - 0.5) <= 20 * TOL);
  sfdae_destroy(&solver);

  problem = differentiated_pendulum();
  solver = CREATE(&problem, NULL);
  CHECK_STATUS(sfdae_set_parameter(solver, "g", 1), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
}

static void options_can_be_changed(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver = CREATE(&problem, NULL);
  sfdae_options options = default_options();
  sfdae_statistics before, after;
  double t = unset, x[N];
  sfdae_statistics_init(&before, sizeof before);
  sfdae_statistics_init(&after, sizeof after);
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0.2, &t, x, NULL), SFDAE_OK);
  options.max_step = 1e-3;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  sfdae_get_statistics(solver, &before);
  CHECK_STATUS(sfdae_advance(solver, before.t_internal + 0.05, &t, x, NULL), SFDAE_OK);
  sfdae_get_statistics(solver, &after);
  CHECK(after.steps - before.steps >= 50 && accurate(t, x, TOL));
  options.atol = -1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_ILLEGAL_ARGUMENT);
  options.atol = TOL;
  options.max_step = 0;
  options.use_stop_time = 1;
  options.stop_time = 1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1 && accurate(t, x, TOL));
  sfdae_get_statistics(solver, &after);
  CHECK(after.t_internal <= 1);

  options = default_options();
  options.max_index = 1; /* needs an analysis, which cannot succeed */
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_NOT_STARTED);
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INDEX_TOO_HIGH);
  options.max_index = 2;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  solve_and_check(solver);
  sfdae_destroy(&solver);
}

static void requests_to_stop_are_obeyed(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver = CREATE(&problem, NULL);
  double t = unset, x[N];
  exact(0, x);
  CHECK_STATUS(sfdae_request_stop(solver), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_STOPPED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_request_stop(solver), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_STOPPED);
  CHECK(t >= 0 && t < 1 && accurate(t, x, TOL));
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1 && accurate(t, x, TOL));
  sfdae_destroy(&solver);
}

int main(void) {
  init_writes_no_more_than_its_caller_has();
  wrong_problems_are_refused();
  mistakes_in_equations_are_refused();
  everything_is_copied();
  no_solver_is_refused();
  wrong_points_are_refused();
  absurd_guesses_are_survived();
  calls_too_early_are_refused();
  arrays_are_those_of_points_that_are_known();
  parameters_can_be_changed();
  options_can_be_changed();
  requests_to_stop_are_obeyed();
  return failures != 0;
}
