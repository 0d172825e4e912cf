/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Radau IIA and the automatic choice where things are not smooth, unique or possible: characteristic values that
 * change, functions that end, u > 0, v > 0, d = 0, constant matrices. With BDF for comparison. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* ---- Methods and problems ------------------------------------------------------------------------- */

static const struct {
  int method, min_stages, max_stages;
} choices[] = {{SFDAE_METHOD_BDF, 1, 7},      {SFDAE_METHOD_RADAU, 1, 7}, {SFDAE_METHOD_RADAU, 1, 1},
               {SFDAE_METHOD_RADAU, 3, 3},    {SFDAE_METHOD_RADAU, 5, 5}, {SFDAE_METHOD_RADAU, 7, 7},
               {SFDAE_METHOD_AUTOMATIC, 1, 7}};
enum { CHOICES = sizeof choices / sizeof choices[0] };
static int choice; /* of all solvers at present */

static const double pi_half = 1.57079632679489661923;
static double sine(double t, int order) { return sin(t + order * pi_half); }
static double cosine(double t, int order) { return cos(t + order * pi_half); }

static sfdae_options options_with_tolerance(double tol) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = choices[choice].method;
  options.min_stages = choices[choice].min_stages, options.max_stages = choices[choice].max_stages;
  return options;
}

static sfdae_linear_problem problem_of_size(int m, int n) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = m, problem.num_unknowns = n;
  return problem;
}

static sfdae_solver* create(const sfdae_linear_problem* problem, const sfdae_options* options) {
  sfdae_solver* solver = NULL;
  CHECK_STATUS(sfdae_create_linear(&solver, problem, options), SFDAE_OK);
  return solver;
}

static sfdae_statistics statistics(const sfdae_solver* solver) {
  sfdae_statistics result;
  sfdae_statistics_init(&result, sizeof result);
  CHECK_STATUS(sfdae_get_statistics(solver, &result), SFDAE_OK);
  return result;
}

/* Within 10 tolerances; errors of one stage, of order 1, add up over hundreds of steps. */
static int near(double found, double exact, double tol) {
  const double limit = choices[choice].max_stages == 1 ? 1000 : 10;
  return fabs(found - exact) <= limit * (tol * fabs(exact) + tol);
}

/* ---- Changes of the characteristic values ------------------------------------------------------------ */

/* x1' = -x1; the second row changes at t = at:
 *   VANISHING_E   (t - at) x2' = x2 - 1          (0; 2, 0), at one point (0; 1, 1)
 *   DECAYING_E    (t - at) x2' = -(x2 - 1)       likewise; errors grow toward the point, and behind it they decay
 *   VANISHING_A   0 = (t - at) (x2 - 1)          (0; 1, 1), at one point (0; 1, 0) with u = v = 1
 *   NEW_EQUATION  x2' = 1 - x2 before `at`, 0 = 1 - x2 from then on
 * x = (e^-t, 1) always. */
enum kind { VANISHING_E, DECAYING_E, VANISHING_A, NEW_EQUATION, KINDS };
typedef struct {
  enum kind kind;
  double at;
} change_data;

static int E_changing(double t, int order, double* matrix, void* user) {
  const change_data* c = (const change_data*)user;
  if (order == 0) matrix[0] = 1;
  if (c->kind <= DECAYING_E) matrix[3] = order == 0 ? t - c->at : order == 1;
  if (c->kind == NEW_EQUATION && order == 0) matrix[3] = t < c->at;
  return 0;
}

static double A_22(double t, int order, const change_data* c) {
  if (c->kind == VANISHING_A) return order == 0 ? t - c->at : order == 1;
  return order > 0 ? 0 : c->kind == VANISHING_E ? 1 : -1;
}

static int A_changing(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = -1;
  matrix[3] = A_22(t, order, (const change_data*)user);
  return 0;
}

static int f_changing(double t, int order, double* vector, void* user) {
  vector[1] = -A_22(t, order, (const change_data*)user);
  return 0;
}

static sfdae_linear_problem changing(change_data* data) {
  sfdae_linear_problem problem = problem_of_size(2, 2);
  problem.E = E_changing, problem.A = A_changing, problem.f = f_changing;
  problem.user = data;
  return problem;
}

/* From t0 across `at`; a step never is longer than the way. */
static void change_is_located(change_data* data, double t0, double end) {
  const double way = end - t0, sign = way > 0 ? 1 : -1;
  const sfdae_linear_problem problem = changing(data);
  const sfdae_options options = options_with_tolerance(1e-6);
  sfdae_solver* solver = create(&problem, &options);
  sfdae_change change;
  double t = t0, x[2], growth;
  x[0] = exp(-t0), x[1] = 1;
  sfdae_change_init(&change, sizeof change);
  CHECK_STATUS(sfdae_start(solver, t0, end, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance(solver, end, &t, x, NULL), SFDAE_CHARACTERISTICS_CHANGED);
  CHECK(sign * (t - t0) >= 0 && sign * (t - data->at) <= 0);
  /* Errors of x2 grow like 1 / |t - at| where E decays. */
  growth = data->kind == DECAYING_E ? fmax(1, fabs(way / (t - data->at))) : 1;
  CHECK(near(x[0], exp(-t), 1e-6) && near(x[1], 1, 1e-6 * growth));
  if (sfdae_get_change(solver, &change) == SFDAE_OK) {
    CHECK(fabs(change.t - data->at) <= 1e-6 * fabs(way));
    CHECK(fabs(t - data->at) <= 1e-2 * fabs(way)); /* as far as it is possible, nearly */
    CHECK(change.old_strangeness_index == 0);
    CHECK(change.new_differential != change.old_differential || change.new_algebraic != change.old_algebraic);
  } else {
    CHECK(0);
  }
  /* Behind the change a new analysis goes on. */
  t = data->at + 0.1 * way;
  x[0] = exp(-t), x[1] = 1;
  CHECK_STATUS(sfdae_analyze(solver, t, end, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, t, end, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_advance(solver, end, &t, x, NULL), SFDAE_OK);
  CHECK(t == end && near(x[0], exp(-end), 1e-6) && near(x[1], 1, 1e-6));
  sfdae_destroy(&solver);
}

static void changes_are_located(void) {
  static const double points[] = {0.5, 0.3, 0.7318, 0.1};
  int kind, i;
  for (kind = 0; kind < KINDS; kind++)
    for (i = 0; i < 4; i++) {
      change_data data;
      const int before = failures;
      data.kind = (enum kind)kind, data.at = points[i];
      change_is_located(&data, 0, 1);
      if (failures > before) fprintf(stderr, "  ... forward, kind %d at %g, choice %d\n", kind, data.at, choice);
    }
}

static void changes_are_located_backward(void) {
  int kind;
  for (kind = VANISHING_E; kind <= VANISHING_A; kind++) {
    change_data data;
    const int before = failures;
    data.kind = (enum kind)kind, data.at = 0.4;
    change_is_located(&data, 1, 0);
    if (failures > before) fprintf(stderr, "  ... backward, kind %d, choice %d\n", kind, choice);
  }
}

/* Outputs shortly before, single steps and a stop time change nothing in it. */
static void changes_are_located_in_single_steps(void) {
  int kind;
  for (kind = 0; kind < KINDS; kind++) {
    change_data data;
    sfdae_options options = options_with_tolerance(1e-6);
    sfdae_linear_problem problem;
    sfdae_solver* solver;
    sfdae_change change;
    double t = 0, x[2] = {1, 1};
    int status = SFDAE_STEP_TAKEN, i;
    data.kind = (enum kind)kind, data.at = 0.5;
    problem = changing(&data);
    options.use_stop_time = 1, options.stop_time = 1;
    solver = create(&problem, &options);
    sfdae_change_init(&change, sizeof change);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
    for (i = 0; i < 10000 && status == SFDAE_STEP_TAKEN; i++) status = sfdae_step(solver, 1, &t, x, NULL);
    CHECK_STATUS(status, SFDAE_CHARACTERISTICS_CHANGED);
    CHECK(t <= 0.5 && near(x[0], exp(-t), 1e-6));
    CHECK_STATUS(sfdae_get_change(solver, &change), SFDAE_OK);
    CHECK(fabs(change.t - 0.5) <= 1e-6);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_CHARACTERISTICS_CHANGED); /* again */
    sfdae_destroy(&solver);
  }
}

/* ---- Functions that end ---------------------------------------------------------------------------------- */

/* x1' = -x1 + cos t + sin t, 0 = x2 - x1:  x = sin t twice, plus e^-t. Beyond `after` a function has no value. */
typedef struct {
  char function;
  int status; /* > 0, < 0; 0: NaN */
  double after;
  long times; /* failures after which all is well again; < 0: never */
  long calls_behind;
} ending;

static int value_at(ending* e, char function, double t, double* values) {
  if (e->function != function || !(t > e->after) || e->times == 0) return 0;
  e->calls_behind++;
  if (e->times > 0) e->times--;
  if (e->status == 0) values[0] = NAN;
  return e->status;
}

static int E_ending(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = 1;
  return value_at((ending*)user, 'E', t, matrix);
}

static int A_ending(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = matrix[1] = -1, matrix[3] = 1;
  return value_at((ending*)user, 'A', t, matrix);
}

static int f_ending(double t, int order, double* vector, void* user) {
  vector[0] = cosine(t, order) + sine(t, order);
  return value_at((ending*)user, 'f', t, vector);
}

static sfdae_linear_problem problem_that_ends(ending* e) {
  sfdae_linear_problem problem = problem_of_size(2, 2);
  problem.E = E_ending, problem.A = A_ending, problem.f = f_ending;
  problem.user = e;
  return problem;
}

static int is_ending_solution(double t, const double* x, double tol) {
  return near(x[0], sin(t) + exp(-t), tol) && fabs(x[0] - x[1]) <= 100 * DBL_EPSILON;
}

static void functions_may_end(void) {
  static const int statuses[][2] = {{1, SFDAE_CALLBACK_FAILED}, {0, SFDAE_NOT_FINITE}, {-1, SFDAE_CALLBACK_STOPPED}};
  static const char functions[] = {'E', 'A', 'f'};
  static const double tol = 1e-5;
  int i, k;
  for (i = 0; i < 3; i++)
    for (k = 0; k < 3; k++) {
      ending e = {0, 0, HUGE_VAL, -1, 0};
      const sfdae_linear_problem problem = problem_that_ends(&e);
      const sfdae_options options = options_with_tolerance(tol);
      sfdae_solver* solver = create(&problem, &options);
      const int before = failures;
      double t = 0, x[2] = {1, 1}, reached;
      CHECK_STATUS(sfdae_start(solver, 0, 4, x, NULL), SFDAE_OK);
      e.function = functions[k], e.status = statuses[i][0], e.after = 2.71;
      CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), statuses[i][1]);
      CHECK(sfdae_message(solver)[0] != 0);
      CHECK(t <= e.after && is_ending_solution(t, x, tol));
      /* It comes close, unless it was told to stop at once. */
      CHECK(statuses[i][0] < 0 || e.after - t <= 1e-3);
      reached = t;
      CHECK_STATUS(sfdae_advance(solver, t, &t, x, NULL), SFDAE_OK);
      CHECK(t == reached && is_ending_solution(t, x, tol));
      e.function = 0; /* the function is there again: the call may be repeated */
      CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), SFDAE_OK);
      CHECK(t == 4 && is_ending_solution(t, x, tol));
      if (failures > before)
        fprintf(stderr, "  ... %c, status %d, choice %d, t = %.17g\n", functions[k], statuses[i][0], choice, reached);
      sfdae_destroy(&solver);
    }
}

static void a_few_failures_are_survived(void) {
  int status;
  for (status = 0; status <= 1; status++) {
    ending e = {0, 0, HUGE_VAL, -1, 0};
    const sfdae_linear_problem problem = problem_that_ends(&e);
    const sfdae_options options = options_with_tolerance(1e-5);
    sfdae_solver* solver = create(&problem, &options);
    double t = 0, x[2] = {1, 1};
    CHECK_STATUS(sfdae_start(solver, 0, 4, x, NULL), SFDAE_OK);
    e.function = 'f', e.status = status, e.after = 2.71, e.times = 4;
    CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), SFDAE_OK);
    CHECK(t == 4 && is_ending_solution(t, x, 1e-5) && e.calls_behind == 4);
    CHECK(statistics(solver).other_failures >= 1 && statistics(solver).other_failures <= 4);
    sfdae_destroy(&solver);
  }
}

/* ---- u > 0 -------------------------------------------------------------------------------------------------- */

/* x1' = x2, x2' = -x2 + (1 + t/2) x3: x3 is free, or prescribed such that x2 = sin t. */
static int E_cart(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[3] = 1;
  return 0;
}

static int A_cart(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[2] = 1, matrix[3] = -1;
  matrix[5] = order == 0 ? 1 + t / 2 : order == 1 ? 0.5 : 0;
  return 0;
}

static int prescribed_force(double t, int order, double* values, void* user) {
  (void)user;
  CHECK(order == 0);
  values[0] = (cos(t) + sin(t)) / (1 + t / 2);
  return 0;
}

static void free_components_are_held_or_prescribed(void) {
  static const int third[1] = {2};
  static const double tol = 1e-6;
  sfdae_linear_problem problem = problem_of_size(2, 3);
  const sfdae_options options = options_with_tolerance(tol);
  sfdae_solver* solver;
  double t, x[3] = {0, 1, 0.25};
  int i;
  problem.E = E_cart, problem.A = A_cart;
  solver = create(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_NOT_UNIQUE);
  for (i = 1; i <= 30; i++) { /* x2' = -x2 + c + c t / 2, so x2 = c / 2 + c t / 2 + C e^-t */
    CHECK_STATUS(sfdae_advance(solver, 0.1 * i, &t, x, NULL), SFDAE_OK);
    CHECK(near(x[2], 0.25, tol));
    CHECK(near(x[1], 0.125 + 0.125 * t + 0.875 * exp(-t), tol));
    CHECK(near(x[0], 0.125 * t + 0.0625 * t * t + 0.875 * (1 - exp(-t)), tol));
  }
  sfdae_destroy(&solver);

  problem.num_prescribed = 1, problem.prescribed = third, problem.prescribed_values = prescribed_force;
  solver = create(&problem, &options);
  x[0] = x[1] = x[2] = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  for (i = 1; i <= 30; i++) {
    CHECK_STATUS(sfdae_advance(solver, 0.1 * i, &t, x, NULL), SFDAE_OK);
    CHECK(near(x[0], 1 - cos(t), tol) && near(x[1], sin(t), tol));
    CHECK(fabs(x[2] - (cos(t) + sin(t)) / (1 + t / 2)) <= 100 * DBL_EPSILON);
  }
  sfdae_destroy(&solver);
}

/* ---- v > 0 -------------------------------------------------------------------------------------------------- */

/* x1' = -x1, x2' = x1, 0 = x1 + x2 - 1 - leak max(t - from, 0)^3. */
typedef struct {
  double leak, from;
} leaking;

static int E_leaking(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[4] = 1;
  return 0;
}

static int A_leaking(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = -1, matrix[1] = matrix[2] = matrix[5] = 1;
  return 0;
}

static int f_leaking(double t, int order, double* vector, void* user) {
  const leaking* l = (const leaking*)user;
  const double s = fmax(t - l->from, 0), falling[4] = {s * s * s, 3 * s * s, 6 * s, 6};
  vector[2] = -(order == 0) - l->leak * (order > 3 || s == 0 ? 0 : falling[order]);
  return 0;
}

static void contradictions_are_detected(void) {
  static const double tol = 1e-6;
  leaking l = {0, 1.5};
  sfdae_linear_problem problem = problem_of_size(3, 2);
  sfdae_options options = options_with_tolerance(tol);
  sfdae_solver* solver;
  double t, x[2] = {0.9, 0.1};
  problem.E = E_leaking, problem.A = A_leaking, problem.f = f_leaking;
  problem.user = &l;
  options.max_step = 0.25; /* so that the start knows nothing of the leak */
  solver = create(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
  CHECK(near(x[0], 0.9 * exp(-3), tol) && fabs(x[0] + x[1] - 1) <= 100 * DBL_EPSILON);
  CHECK(statistics(solver).consistency <= 1e-8);

  l.leak = 1;
  x[0] = 0.9, x[1] = 0.1;
  CHECK_STATUS(sfdae_start(solver, 0, 3, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_INCONSISTENT_EQUATIONS);
  CHECK(t <= 1.6 && near(x[0], 0.9 * exp(-t), tol) && near(x[1], 1 - 0.9 * exp(-t), tol));

  options.ignore_inconsistency = 1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_INCONSISTENCY_IGNORED);
  CHECK(t == 3 && statistics(solver).consistency > 1e-3);
  sfdae_destroy(&solver);
}

/* ---- d = 0, constant matrices ---------------------------------------------------------------------------------- */

/* 0 = -x1 + t x2 + e^-t, x1' - t x2' = 0:  d = 0; x1 = t x2 + e^-t, x2 = e^-t. */
static int E_document(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1, matrix[3] = -t;
  if (order == 1) matrix[3] = -1;
  return 0;
}

static int A_document(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = -1, matrix[2] = t;
  if (order == 1) matrix[2] = 1;
  return 0;
}

static int f_document(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

static void without_dynamics_every_point_is_exact(void) {
  sfdae_linear_problem problem = problem_of_size(2, 2);
  const sfdae_options options = options_with_tolerance(1e-3);
  sfdae_solver* solver;
  double t, x[2] = {3, 3}, xdot[2];
  int i;
  problem.E = E_document, problem.A = A_document, problem.f = f_document;
  solver = create(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 5, x, NULL), SFDAE_VALUES_CHANGED);
  for (i = 1; i <= 20; i++) {
    CHECK_STATUS(sfdae_advance(solver, 0.25 * i, &t, x, xdot), SFDAE_OK);
    CHECK(t == 0.25 * i && fabs(x[0] - (1 + t) * exp(-t)) <= 100 * DBL_EPSILON);
    CHECK(fabs(x[1] - exp(-t)) <= 100 * DBL_EPSILON);
    CHECK(fabs(xdot[0] + t * exp(-t)) <= 1000 * DBL_EPSILON && fabs(xdot[1] + exp(-t)) <= 1000 * DBL_EPSILON);
  }
  CHECK(statistics(solver).last_order == 1 && statistics(solver).error_failures == 0);
  sfdae_destroy(&solver);
}

/* x1' = x2, x2' = -x1, x3' = x4, 0 = x3 - x1 - cos(t / 2), E and A constant. */
typedef struct {
  long calls_E, calls_A;
} counter;

static int E_constant(double t, int order, double* matrix, void* user) {
  (void)t;
  CHECK(order == 0);
  ((counter*)user)->calls_E++;
  matrix[0] = matrix[5] = matrix[10] = 1;
  return 0;
}

static int A_constant(double t, int order, double* matrix, void* user) {
  (void)t;
  CHECK(order == 0);
  ((counter*)user)->calls_A++;
  matrix[0 + 4 * 1] = matrix[2 + 4 * 3] = matrix[3 + 4 * 2] = 1;
  matrix[1 + 4 * 0] = matrix[3 + 4 * 0] = -1;
  return 0;
}

static int f_constant(double t, int order, double* vector, void* user) {
  (void)user;
  vector[3] = -pow(0.5, order) * cosine(t / 2, order);
  return 0;
}

static void constant_matrices_are_asked_for_once(void) {
  static const double tol = 1e-6;
  counter calls = {0, 0};
  sfdae_linear_problem problem = problem_of_size(4, 4);
  sfdae_options options = options_with_tolerance(tol);
  sfdae_solver* solver;
  sfdae_statistics s;
  double t, x[4] = {1, 0, 2, 0};
  int i;
  if (choices[choice].max_stages == 1) return; /* thousands of steps */
  problem.E = E_constant, problem.A = A_constant, problem.f = f_constant;
  problem.constant_E = problem.constant_A = 1;
  problem.user = &calls;
  solver = create(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  for (i = 1; i <= 100; i++) {
    CHECK_STATUS(sfdae_advance(solver, 0.1 * i, &t, x, NULL), SFDAE_OK);
    CHECK(near(x[0], cos(t), tol) && near(x[1], -sin(t), tol) && near(x[3], -sin(t) - sin(t / 2) / 2, tol));
    CHECK(fabs(x[2] - x[0] - cos(t / 2)) <= 100 * DBL_EPSILON);
  }
  s = statistics(solver);
  CHECK(calls.calls_E == 1 && calls.calls_A == 1 && s.evaluations_E == 1 && s.evaluations_A == 1);
  sfdae_destroy(&solver);

  /* Steps of the same size share a factorization. */
  options.max_step = options.initial_step = 0.01;
  solver = create(&problem, &options);
  x[0] = 1, x[1] = 0, x[2] = 2, x[3] = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 10, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 10, &t, x, NULL), SFDAE_OK);
  s = statistics(solver);
  CHECK(near(x[0], cos(t), tol) && s.steps >= 1000);
  if (choices[choice].min_stages == choices[choice].max_stages) CHECK(10 * s.factorizations <= s.steps);
  sfdae_destroy(&solver);
}

int main(void) {
  for (choice = 0; choice < CHOICES; choice++) {
    const int before = failures;
    changes_are_located();
    changes_are_located_backward();
    changes_are_located_in_single_steps();
    functions_may_end();
    a_few_failures_are_survived();
    free_components_are_held_or_prescribed();
    contradictions_are_detected();
    without_dynamics_every_point_is_exact();
    constant_matrices_are_asked_for_once();
    if (failures > before)
      fprintf(stderr, "... with method %d, %d to %d stages\n", choices[choice].method, choices[choice].min_stages,
              choices[choice].max_stages);
  }
  return failures != 0;
}
