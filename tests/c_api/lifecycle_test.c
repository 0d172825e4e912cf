/* SPDX-License-Identifier: BSD-3-Clause
 *
 * From init to destroy: every function with right and with wrong arguments. A call that fails says why and
 * leaves its outputs as they were.
 *
 *     x1' = x2,   x2' = -x1,   x3' = x4,   0 = x3 - x1        mu = 1, d = 2, a = 2
 *     x = (cos t, -sin t, cos t, -sin t)
 */
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

/* Bytes that no call that fails may change. */
static void guard(void* bytes, size_t length) { memset(bytes, 0xA5, length); }

static int guarded(const void* bytes, size_t length) {
  const unsigned char* byte = (const unsigned char*)bytes;
  size_t i;
  for (i = 0; i < length; i++)
    if (byte[i] != 0xA5) return 0;
  return 1;
}

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[5] = matrix[10] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) {
    matrix[0 + 4 * 1] = 1;
    matrix[1 + 4 * 0] = -1;
    matrix[2 + 4 * 3] = 1;
    matrix[3 + 4 * 2] = 1;
    matrix[3 + 4 * 0] = -1;
  }
  return 0;
}

static int prescribe_zero(double t, int order, double* values, void* user) {
  (void)t, (void)order, (void)values, (void)user;
  return 0;
}

static sfdae_linear_problem oscillator(void) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 4;
  problem.E = E;
  problem.A = A;
  return problem;
}

static sfdae_options default_options(void) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  return options;
}

/* The error stays below 10 times the tolerance. */
static int accurate(const double* x, double t, double rtol, double atol) {
  const double exact[4] = {cos(t), -sin(t), cos(t), -sin(t)};
  int i;
  for (i = 0; i < 4; i++)
    if (!(fabs(x[i] - exact[i]) <= 10 * (rtol * fabs(exact[i]) + atol))) return 0;
  return 1;
}

static void solve_and_check(sfdae_solver* solver) {
  double t = 0, x[4] = {1, 0, 1, 0};
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1.0);
  CHECK(accurate(x, 1, 1e-6, 1e-6));
}

/* ---- Names and version ------------------------------------------------------------------------ */

static void every_status_has_its_name(void) {
#define NAMED(status) \
  { status, #status }
  static const struct {
    int status;
    const char* name;
  } table[] = {
      NAMED(SFDAE_OK),
      NAMED(SFDAE_STEP_TAKEN),
      NAMED(SFDAE_STOPPED),
      NAMED(SFDAE_NOT_UNIQUE),
      NAMED(SFDAE_INCONSISTENCY_IGNORED),
      NAMED(SFDAE_VALUES_CHANGED),
      NAMED(SFDAE_INSTANCES_FAILED),
      NAMED(SFDAE_ILLEGAL_ARGUMENT),
      NAMED(SFDAE_OUT_OF_MEMORY),
      NAMED(SFDAE_BUSY),
      NAMED(SFDAE_EMPTY_PROBLEM),
      NAMED(SFDAE_NOT_STARTED),
      NAMED(SFDAE_CALLBACK_STOPPED),
      NAMED(SFDAE_CALLBACK_FAILED),
      NAMED(SFDAE_NOT_FINITE),
      NAMED(SFDAE_ORDER_MISSING),
      NAMED(SFDAE_WRONG_DERIVATIVES),
      NAMED(SFDAE_INDEX_TOO_HIGH),
      NAMED(SFDAE_RANK_UNCLEAR),
      NAMED(SFDAE_CHARACTERISTICS_CHANGED),
      NAMED(SFDAE_PRESCRIPTION_SINGULAR),
      NAMED(SFDAE_INCONSISTENT_VALUES),
      NAMED(SFDAE_INCONSISTENT_EQUATIONS),
      NAMED(SFDAE_FIXED_VALUES),
      NAMED(SFDAE_MAX_STEPS),
      NAMED(SFDAE_STEP_TOO_SMALL),
      NAMED(SFDAE_SINGULAR),
      NAMED(SFDAE_TOLERANCE_TOO_SMALL),
      NAMED(SFDAE_INTERNAL),
  };
  size_t i;
  for (i = 0; i < sizeof table / sizeof table[0]; i++)
    CHECK(strcmp(sfdae_status_name(table[i].status), table[i].name) == 0);
  CHECK(strcmp(sfdae_status_name(8), "unknown status") == 0);
  CHECK(strcmp(sfdae_status_name(INT_MIN), "unknown status") == 0);
  CHECK(strcmp(sfdae_status_name(INT_MAX), "unknown status") == 0);
}

static void version_is_that_of_the_header(void) {
  char text[64];
  sprintf(text, "%d.%d.%d", SFDAE_VERSION_MAJOR, SFDAE_VERSION_MINOR, SFDAE_VERSION_PATCH);
  CHECK(strcmp(sfdae_version(), text) == 0);
}

/* ---- Structs of other sizes ------------------------------------------------------------------- */

typedef union {
  unsigned char bytes[1024];
  double alignment;
  size_t size;
} any_struct;

typedef int (*any_init)(any_struct*, size_t);

static int init_problem(any_struct* s, size_t size) {
  return sfdae_linear_problem_init((sfdae_linear_problem*)s, size);
}
static int init_options(any_struct* s, size_t size) { return sfdae_options_init((sfdae_options*)s, size); }
static int init_characteristics(any_struct* s, size_t size) {
  return sfdae_characteristics_init((sfdae_characteristics*)s, size);
}
static int init_decision(any_struct* s, size_t size) { return sfdae_decision_init((sfdae_decision*)s, size); }
static int init_change(any_struct* s, size_t size) { return sfdae_change_init((sfdae_change*)s, size); }
static int init_report(any_struct* s, size_t size) {
  return sfdae_initial_report_init((sfdae_initial_report*)s, size);
}
static int init_statistics(any_struct* s, size_t size) { return sfdae_statistics_init((sfdae_statistics*)s, size); }
static int init_check(any_struct* s, size_t size) {
  return sfdae_derivative_check_init((sfdae_derivative_check*)s, size);
}

static void init_writes_no_more_than_its_caller_has(void) {
  static const struct {
    any_init init;
    size_t size;
  } table[] = {
      {init_problem, sizeof(sfdae_linear_problem)},
      {init_options, sizeof(sfdae_options)},
      {init_characteristics, sizeof(sfdae_characteristics)},
      {init_decision, sizeof(sfdae_decision)},
      {init_change, sizeof(sfdae_change)},
      {init_report, sizeof(sfdae_initial_report)},
      {init_statistics, sizeof(sfdae_statistics)},
      {init_check, sizeof(sfdae_derivative_check)},
  };
  size_t i, size;
  for (i = 0; i < sizeof table / sizeof table[0]; i++) {
    any_struct s;
    CHECK(table[i].init(NULL, table[i].size) == SFDAE_ILLEGAL_ARGUMENT);

    guard(&s, sizeof s);
    CHECK(table[i].init(&s, 0) == SFDAE_ILLEGAL_ARGUMENT);
    CHECK(table[i].init(&s, sizeof(size_t) - 1) == SFDAE_ILLEGAL_ARGUMENT);
    CHECK(guarded(&s, sizeof s));

    /* Any size from an older to a newer caller: either refused and untouched, or within bounds. */
    for (size = 1; size <= sizeof s; size++) {
      int status;
      guard(&s, sizeof s);
      status = table[i].init(&s, size);
      CHECK(guarded(s.bytes + size, sizeof s - size));
      CHECK(status == SFDAE_OK ? s.size == size : status == SFDAE_ILLEGAL_ARGUMENT && guarded(&s, size));
    }
    guard(&s, sizeof s);
    CHECK(table[i].init(&s, table[i].size) == SFDAE_OK);
    CHECK(s.size == table[i].size);
    guard(&s, sizeof s);
    CHECK(table[i].init(&s, table[i].size + 64) == SFDAE_OK);
    CHECK(s.size == table[i].size + 64);
  }
}

static void options_have_the_documented_defaults(void) {
  const sfdae_options o = default_options();
  CHECK(o.rtol == 1e-6 && o.atol == 1e-6 && o.rtol_vector == NULL && o.atol_vector == NULL);
  CHECK(o.max_index == 5 && o.reduction == SFDAE_REDUCTION_STAGED && o.rank_tol == 0 && o.time_scale == 0);
  CHECK(o.difference_derivatives == 0 && o.difference_step == 0);
  CHECK(o.initial_values == SFDAE_INITIAL_NEAREST && o.fixed == NULL && o.initial_weights == NULL);
  CHECK(o.ignore_inconsistency == 0 && o.consistency_tol == 1e-8);
  CHECK(o.max_order == 5 && o.initial_step == 0 && o.max_step == 0 && o.use_stop_time == 0);
  CHECK(o.max_steps == 100000 && o.leading_term == SFDAE_LEADING_AUTOMATIC && o.monitor == NULL);
  CHECK(o.method == SFDAE_METHOD_BDF && o.min_stages == 1 && o.max_stages == 7 && o.xdot_is_guess == 0);
  CHECK(o.output == SFDAE_OUTPUT_CONSISTENT && o.check_derivatives == 1);
}

/* An older caller knows fewer members: those that it does not know keep their defaults. A newer caller has more. */
static void problems_and_options_of_other_sizes_work(void) {
  union {
    sfdae_options options;
    unsigned char bytes[sizeof(sfdae_options) + 64];
  } o;
  union {
    sfdae_linear_problem problem;
    unsigned char bytes[sizeof(sfdae_linear_problem) + 64];
  } p;
  const size_t older = offsetof(sfdae_options, initial_values);
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;

  guard(&o, sizeof o);
  CHECK_STATUS(sfdae_options_init(&o.options, older), SFDAE_OK);
  CHECK(guarded(o.bytes + older, sizeof o - older));
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &o.options), SFDAE_OK);
  solve_and_check(solver);
  CHECK_STATUS(sfdae_set_options(solver, &o.options), SFDAE_OK);
  sfdae_destroy(&solver);

  memset(&o, 0, sizeof o);
  memset(&p, 0, sizeof p);
  sfdae_options_init(&o.options, sizeof o);
  sfdae_linear_problem_init(&p.problem, sizeof p);
  p.problem.num_equations = p.problem.num_unknowns = 4;
  p.problem.E = E;
  p.problem.A = A;
  CHECK_STATUS(sfdae_create_linear(&solver, &p.problem, &o.options), SFDAE_OK);
  solve_and_check(solver);
  sfdae_destroy(&solver);
}

static void forgotten_init_is_noticed(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_options options = default_options();
  sfdae_solver* solver = NULL;
  problem.size = 0;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_ILLEGAL_ARGUMENT);
  problem = oscillator();
  options.size = 0;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_ILLEGAL_ARGUMENT);
  options.size = sizeof(size_t) - 1;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(solver == NULL);
}

static void results_are_written_as_far_as_the_caller_knows_them(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  sfdae_characteristics c;
  sfdae_statistics s;
  const size_t older_c = offsetof(sfdae_characteristics, undetermined);
  const size_t older_s = offsetof(sfdae_statistics, reductions);
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);

  guard(&c, sizeof c);
  CHECK_STATUS(sfdae_characteristics_init(&c, older_c), SFDAE_OK);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_OK);
  CHECK(c.size == older_c && c.strangeness_index == 1 && c.differential == 2 && c.algebraic == 2);
  CHECK(guarded((unsigned char*)&c + older_c, sizeof c - older_c));

  guard(&s, sizeof s);
  CHECK_STATUS(sfdae_statistics_init(&s, older_s), SFDAE_OK);
  CHECK_STATUS(sfdae_get_statistics(solver, &s), SFDAE_OK);
  CHECK(s.size == older_s);
  CHECK(guarded((unsigned char*)&s + older_s, sizeof s - older_s));

  c.size = 0;
  CHECK_STATUS(sfdae_get_characteristics(solver, &c), SFDAE_ILLEGAL_ARGUMENT);
  c.size = 1;
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, &c), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(c.size == 1);
  sfdae_destroy(&solver);
}

/* ---- Creating --------------------------------------------------------------------------------- */

/* Creation, check and, for options, replacement refuse with the status and a reason. */
static void refused(int line, const sfdae_linear_problem* problem, const sfdae_options* options, int expected) {
  static int nothing;
  sfdae_solver* solver = (sfdae_solver*)(void*)&nothing;
  char text[512], tiny[4];
  check_status(__FILE__, line, "sfdae_create_linear", sfdae_create_linear(&solver, problem, options), expected);
  CHECK(solver == NULL);
  if (solver) sfdae_destroy(&solver);

  guard(text, sizeof text);
  check_status(__FILE__, line, "sfdae_check_linear", sfdae_check_linear(problem, options, text, sizeof text),
               expected);
  CHECK(memchr(text, 0, sizeof text) != NULL && text[0] != 0);

  guard(tiny, sizeof tiny);
  CHECK(sfdae_check_linear(problem, options, tiny, 3) == expected);
  CHECK(tiny[2] == 0 && memcmp(tiny, text, 2) == 0 && guarded(tiny + 3, 1));
  guard(tiny, sizeof tiny);
  CHECK(sfdae_check_linear(problem, options, tiny, 1) == expected);
  CHECK(tiny[0] == 0 && guarded(tiny + 1, 3));
  CHECK(sfdae_check_linear(problem, options, NULL, 0) == expected);
}
#define REFUSED(problem, options, expected) refused(__LINE__, (problem), (options), (expected))

static void wrong_problems_are_refused(void) {
  static const int twice[2] = {1, 1}, outside[2] = {0, 4}, negative[2] = {-1, 0}, fine[2] = {0, 1};
  sfdae_linear_problem problem = oscillator();
  char text[16];
  REFUSED(NULL, NULL, SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_create_linear(NULL, &problem, NULL), SFDAE_ILLEGAL_ARGUMENT);
  guard(text, sizeof text);
  CHECK_STATUS(sfdae_check_linear(&problem, NULL, text, sizeof text), SFDAE_OK);
  CHECK(text[0] == 0);

  problem.num_equations = 0;
  REFUSED(&problem, NULL, SFDAE_EMPTY_PROBLEM);
  problem = oscillator();
  problem.num_unknowns = 0;
  REFUSED(&problem, NULL, SFDAE_EMPTY_PROBLEM);
  problem.num_equations = 0;
  REFUSED(&problem, NULL, SFDAE_EMPTY_PROBLEM);
  problem = oscillator();
  problem.E = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem = oscillator();
  problem.A = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);

  problem = oscillator();
  problem.num_prescribed = -1;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.num_prescribed = 2;
  problem.prescribed_values = prescribe_zero;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT); /* no indices */
  problem.prescribed = twice;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.prescribed = outside;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.prescribed = negative;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
  problem.prescribed = fine;
  problem.prescribed_values = NULL;
  REFUSED(&problem, NULL, SFDAE_ILLEGAL_ARGUMENT);
}

static void negative_sizes_are_refused(void) {
  static const int sizes[][2] = {{-1, 4}, {4, -1}, {-1, -1}, {INT_MIN, 4}, {4, INT_MIN}};
  size_t i;
  for (i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    sfdae_linear_problem problem = oscillator();
    sfdae_solver* solver = NULL;
    int status;
    problem.num_equations = sizes[i][0];
    problem.num_unknowns = sizes[i][1];
    status = sfdae_create_linear(&solver, &problem, NULL);
    CHECK(status == SFDAE_ILLEGAL_ARGUMENT || status == SFDAE_EMPTY_PROBLEM);
    CHECK(solver == NULL);
  }
}

/* A wrong value refused at creation, at the check and later: the options in use stay. */
static void wrong_option(int line, const sfdae_options* options) {
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  double t = -1, x[4] = {1, 0, 1, 0};
  refused(line, &problem, options, SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  check_status(__FILE__, line, "sfdae_set_options", sfdae_set_options(solver, options), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(t == 1.0 && accurate(x, 1, 1e-6, 1e-6));
  CHECK(sfdae_message(solver)[0] == 0);
  sfdae_destroy(&solver);
}

#define WRONG(member, value)                    \
  do {                                          \
    sfdae_options options_ = default_options(); \
    options_.member = (value);                  \
    wrong_option(__LINE__, &options_);          \
  } while (0)

static void wrong_options_are_refused(void) {
  static const double bad_tolerances[][4] = {
      {1e-6, NAN, 1e-6, 1e-6}, {1e-6, 1e-6, -1e-6, 1e-6}, {1e-6, 1e-6, 1e-6, INFINITY}};
  static const double bad_weights[][4] = {
      {1, 1, 0, 1}, {1, -1, 1, 1}, {NAN, 1, 1, 1}, {1, 1, 1, INFINITY}, {1, 1, 1, -INFINITY}};
  static const double zeros[4] = {0, 0, 0, 0}, one_zero[4] = {1e-6, 0, 1e-6, 1e-6};
  sfdae_options options;
  size_t i;

  WRONG(rtol, NAN);
  WRONG(rtol, INFINITY);
  WRONG(rtol, -1e-6);
  WRONG(rtol, 1.0);
  WRONG(rtol, 2.0);
  WRONG(atol, NAN);
  WRONG(atol, INFINITY);
  WRONG(atol, -INFINITY);
  WRONG(atol, -1e-6);
  for (i = 0; i < 3; i++) {
    WRONG(rtol_vector, bad_tolerances[i]);
    WRONG(atol_vector, bad_tolerances[i]);
  }
  options = default_options();
  options.rtol = options.atol = 0;
  wrong_option(__LINE__, &options);
  options = default_options();
  options.rtol_vector = options.atol_vector = zeros;
  wrong_option(__LINE__, &options);
  options.rtol_vector = options.atol_vector = one_zero;
  wrong_option(__LINE__, &options);

  WRONG(max_index, -1);
  WRONG(max_index, 13);
  WRONG(max_index, INT_MAX);
  WRONG(max_index, INT_MIN);
  WRONG(reduction, -1);
  WRONG(reduction, 2);
  WRONG(rank_tol, NAN);
  WRONG(rank_tol, INFINITY);
  WRONG(rank_tol, -1e-9);
  WRONG(rank_tol, 1.0);
  WRONG(time_scale, NAN);
  WRONG(time_scale, INFINITY);
  WRONG(time_scale, -1.0);
  WRONG(difference_step, NAN);
  WRONG(difference_step, INFINITY);
  WRONG(difference_step, -1e-3);

  WRONG(initial_values, -1);
  WRONG(initial_values, 3);
  WRONG(initial_values, SFDAE_INITIAL_FIXED); /* without flags */
  for (i = 0; i < 5; i++) WRONG(initial_weights, bad_weights[i]);
  WRONG(consistency_tol, NAN);
  WRONG(consistency_tol, 0.0);
  WRONG(consistency_tol, -1e-8);
  WRONG(consistency_tol, 1.0);

  WRONG(max_order, 0);
  WRONG(max_order, 6);
  WRONG(max_order, -1);
  WRONG(initial_step, NAN);
  WRONG(initial_step, INFINITY);
  WRONG(initial_step, -1e-3);
  WRONG(max_step, NAN);
  WRONG(max_step, -1.0);
  WRONG(max_steps, 0);
  WRONG(max_steps, -1);
  WRONG(max_steps, LONG_MIN);
  WRONG(leading_term, -1);
  WRONG(leading_term, 4);
  options = default_options();
  options.use_stop_time = 1;
  options.stop_time = NAN;
  wrong_option(__LINE__, &options);
}

static void unused_members_are_not_judged(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_options options = default_options();
  sfdae_solver* solver = NULL;
  static const double tolerances[4] = {1e-6, 1e-6, 1e-6, 1e-6};
  options.stop_time = NAN; /* use_stop_time = 0 */
  options.rtol_vector = options.atol_vector = tolerances;
  options.rtol = options.atol = 0; /* replaced */
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  solve_and_check(solver);
  sfdae_destroy(&solver);
}

static void everything_is_copied(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_options options = default_options();
  sfdae_solver* solver = NULL;
  double rtol[4] = {1e-6, 1e-6, 1e-6, 1e-6}, atol[4] = {1e-6, 1e-6, 1e-6, 1e-6}, weights[4] = {1, 2, 3, 4};
  int fixed[4] = {0, 0, 0, 0};
  options.rtol_vector = rtol;
  options.atol_vector = atol;
  options.initial_weights = weights;
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = fixed;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  guard(&problem, sizeof problem);
  guard(&options, sizeof options);
  guard(rtol, sizeof rtol);
  guard(atol, sizeof atol);
  guard(weights, sizeof weights);
  guard(fixed, sizeof fixed);
  solve_and_check(solver);
  sfdae_destroy(&solver);
}

static void destroy_allows_nothing(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  CHECK_STATUS(sfdae_destroy(NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK(solver != NULL);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
  CHECK(solver == NULL);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

/* ---- Calls in the wrong order and with wrong arguments ------------------------------------------ */

static void no_solver_is_refused_everywhere(void) {
  sfdae_options options = default_options();
  sfdae_characteristics c;
  sfdae_decision decision;
  sfdae_change change;
  sfdae_initial_report report;
  sfdae_statistics statistics;
  sfdae_derivative_check check;
  double t, x[4], xdot[4], M[64];
  char text[8];
  size_t needed;
  int count;
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_decision_init(&decision, sizeof decision);
  sfdae_change_init(&change, sizeof change);
  sfdae_initial_report_init(&report, sizeof report);
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_derivative_check_init(&check, sizeof check);
  guard(&t, sizeof t), guard(x, sizeof x), guard(xdot, sizeof xdot), guard(M, sizeof M);
  guard(text, sizeof text), guard(&needed, sizeof needed), guard(&count, sizeof count);

  CHECK(strcmp(sfdae_message(NULL), "") == 0);
  CHECK_STATUS(sfdae_set_options(NULL, &options), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_request_stop(NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_analyze(NULL, 0, 1, &c), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_characteristics(NULL, &c), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_num_decisions(NULL, &count), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_decision(NULL, 0, &decision), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_change(NULL, &change), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_initial_report(NULL, &report), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_make_consistent(NULL, 0, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_start(NULL, 0, 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_advance(NULL, 1, &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_step(NULL, 1, &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_checkpoint_length(NULL, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_save_checkpoint(NULL, M, 64), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_restore_checkpoint(NULL, M, 64), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_statistics(NULL, &statistics), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_report(NULL, text, sizeof text, &needed), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_derivative_array(NULL, 0, 1, M, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_projectors(NULL, 0, M, NULL, NULL, NULL, &count), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_strangeness_free(NULL, 0, M, NULL, NULL, NULL, NULL, &t), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_derivatives(NULL, 0, 1, &check), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(guarded(&t, sizeof t) && guarded(x, sizeof x) && guarded(xdot, sizeof xdot) && guarded(M, sizeof M));
  CHECK(guarded(text, sizeof text) && guarded(&needed, sizeof needed) && guarded(&count, sizeof count));
}

/* A call on `solver` that fails as expected and explains itself. */
#define FAILS(call, expected)             \
  do {                                    \
    CHECK_STATUS(call, expected);         \
    CHECK(sfdae_message(solver)[0] != 0); \
  } while (0)

static void calls_too_early_are_refused(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  sfdae_characteristics c, c_before;
  sfdae_change change, change_before;
  double t, x[4], xdot[4], M[64];
  int vhat;
  guard(&c, sizeof c), guard(&change, sizeof change);
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_change_init(&change, sizeof change);
  c_before = c;
  change_before = change;
  guard(&t, sizeof t), guard(x, sizeof x), guard(xdot, sizeof xdot), guard(M, sizeof M), guard(&vhat, sizeof vhat);
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK(strcmp(sfdae_message(solver), "") == 0);

  FAILS(sfdae_get_characteristics(solver, &c), SFDAE_NOT_STARTED);
  CHECK(memcmp(&c, &c_before, sizeof c) == 0);
  FAILS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK(memcmp(&change, &change_before, sizeof change) == 0);
  FAILS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_NOT_STARTED);
  FAILS(sfdae_step(solver, 1, &t, x, xdot), SFDAE_NOT_STARTED);
  FAILS(sfdae_get_projectors(solver, 0, M, NULL, NULL, NULL, &vhat), SFDAE_NOT_STARTED);
  FAILS(sfdae_get_strangeness_free(solver, 0, M, NULL, NULL, NULL, NULL, NULL), SFDAE_NOT_STARTED);

  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK(strcmp(sfdae_message(solver), "") == 0);
  FAILS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_NOT_STARTED);
  FAILS(sfdae_step(solver, 1, &t, x, xdot), SFDAE_NOT_STARTED);
  FAILS(sfdae_get_change(solver, &change), SFDAE_NOT_STARTED);
  CHECK(guarded(&t, sizeof t) && guarded(x, sizeof x) && guarded(xdot, sizeof xdot));
  CHECK(guarded(M, sizeof M) && guarded(&vhat, sizeof vhat));

  /* An analysis forgets the point reached. */
  solve_and_check(solver);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  FAILS(sfdae_advance(solver, 2, &t, x, xdot), SFDAE_NOT_STARTED);
  CHECK(guarded(&t, sizeof t) && guarded(x, sizeof x) && guarded(xdot, sizeof xdot));
  sfdae_destroy(&solver);
}

static void wrong_arguments_are_refused(void) {
  static const double wrong_times[] = {NAN, INFINITY, -INFINITY};
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  sfdae_characteristics c;
  sfdae_derivative_check check, check_before;
  double t, x[4], xdot[4], M[1024], start[4] = {1, 0, 1, 0};
  size_t i, j;
  int vhat;
  sfdae_characteristics_init(&c, sizeof c);
  sfdae_derivative_check_init(&check, sizeof check);
  check_before = check;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  guard(&t, sizeof t), guard(xdot, sizeof xdot), guard(M, sizeof M), guard(&vhat, sizeof vhat);

  for (i = 0; i < 3; i++) {
    const double wrong = wrong_times[i];
    memcpy(x, start, sizeof x);
    FAILS(sfdae_analyze(solver, wrong, 1, NULL), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_analyze(solver, 0, wrong, NULL), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_make_consistent(solver, wrong, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_start(solver, wrong, 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_start(solver, 0, wrong, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_get_derivative_array(solver, wrong, 1, M, M, M), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_check_derivatives(solver, wrong, 1, &check), SFDAE_ILLEGAL_ARGUMENT);
    for (j = 0; j < 4; j++) {
      double bad[4], before[4];
      memcpy(bad, start, sizeof bad);
      bad[j] = wrong;
      memcpy(before, bad, sizeof bad);
      FAILS(sfdae_start(solver, 0, 1, bad, xdot), SFDAE_ILLEGAL_ARGUMENT);
      FAILS(sfdae_make_consistent(solver, 0, bad, xdot), SFDAE_ILLEGAL_ARGUMENT);
      CHECK(memcmp(before, bad, sizeof bad) == 0);
    }
    CHECK(memcmp(x, start, sizeof x) == 0);
  }
  FAILS(sfdae_analyze(solver, 1, 1, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_start(solver, 1, 1, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_start(solver, 0, 1, NULL, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_make_consistent(solver, 0, NULL, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_set_options(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_derivative_array(solver, 0, -1, M, M, M), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_check_derivatives(solver, 0, 0, &check), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_check_derivatives(solver, 0, -1, &check), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_check_derivatives(solver, 0, 1, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(memcmp(&check, &check_before, sizeof check) == 0);
  CHECK(guarded(xdot, sizeof xdot) && guarded(M, sizeof M));

  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  guard(x, sizeof x);
  FAILS(sfdae_get_characteristics(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_num_decisions(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_decision(solver, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_change(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_initial_report(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_get_statistics(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  for (i = 0; i < 3; i++) {
    FAILS(sfdae_advance(solver, wrong_times[i], &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_step(solver, wrong_times[i], &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_get_projectors(solver, wrong_times[i], M, M, M, M, &vhat), SFDAE_ILLEGAL_ARGUMENT);
    FAILS(sfdae_get_strangeness_free(solver, wrong_times[i], M, M, M, M, M, &t), SFDAE_ILLEGAL_ARGUMENT);
  }
  FAILS(sfdae_advance(solver, 1, NULL, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_advance(solver, 1, &t, NULL, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_step(solver, 1, NULL, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_step(solver, 1, &t, NULL, xdot), SFDAE_ILLEGAL_ARGUMENT);
  FAILS(sfdae_advance(solver, -1, &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT); /* against the direction */
  FAILS(sfdae_step(solver, -1, &t, x, xdot), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(guarded(&t, sizeof t) && guarded(x, sizeof x) && guarded(xdot, sizeof xdot));
  CHECK(guarded(M, sizeof M) && guarded(&vhat, sizeof vhat));

  /* After all that the solver still does its work. */
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, xdot), SFDAE_OK);
  CHECK(accurate(x, 1, 1e-6, 1e-6));
  CHECK(strcmp(sfdae_message(solver), "") == 0);
  sfdae_destroy(&solver);
}

/* Regular problems leave nothing to prescribe. */
static void prescribing_what_is_determined_fails(void) {
  static const int first[1] = {0};
  sfdae_linear_problem problem = oscillator();
  sfdae_solver* solver = NULL;
  double x[4] = {1, 0, 1, 0}, before[4];
  int status;
  memcpy(before, x, sizeof x);
  problem.num_prescribed = 1;
  problem.prescribed = first;
  problem.prescribed_values = prescribe_zero;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  status = sfdae_start(solver, 0, 1, x, NULL);
  CHECK_STATUS(status, SFDAE_PRESCRIPTION_SINGULAR);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK(memcmp(x, before, sizeof x) == 0);
  sfdae_destroy(&solver);
}

static void too_small_a_max_index_is_said(void) {
  sfdae_linear_problem problem = oscillator();
  sfdae_options options = default_options();
  sfdae_solver* solver = NULL;
  sfdae_characteristics c, before;
  double x[4] = {1, 0, 1, 0};
  sfdae_characteristics_init(&c, sizeof c);
  before = c;
  options.max_index = 0;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  FAILS(sfdae_analyze(solver, 0, 1, &c), SFDAE_INDEX_TOO_HIGH);
  CHECK(memcmp(&c, &before, sizeof c) == 0);
  FAILS(sfdae_get_characteristics(solver, &c), SFDAE_NOT_STARTED);
  FAILS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_INDEX_TOO_HIGH);
  options.max_index = 1;
  CHECK_STATUS(sfdae_set_options(solver, &options), SFDAE_OK);
  solve_and_check(solver);
  sfdae_destroy(&solver);
}

static void solvers_are_independent(void) {
  enum { COUNT = 8 };
  sfdae_solver* solver[COUNT];
  double t[COUNT], x[COUNT][4];
  int i, k;
  for (i = 0; i < COUNT; i++) {
    const double start[4] = {1, 0, 1, 0};
    sfdae_linear_problem problem = oscillator();
    sfdae_options options = default_options();
    options.rtol = options.atol = pow(10, -3 - i % 4);
    memcpy(x[i], start, sizeof start);
    CHECK_STATUS(sfdae_create_linear(&solver[i], &problem, &options), SFDAE_OK);
    CHECK_STATUS(sfdae_start(solver[i], 0, 4, x[i], NULL), SFDAE_OK);
  }
  for (k = 1; k <= 4; k++)
    for (i = 0; i < COUNT; i++) CHECK_STATUS(sfdae_advance(solver[i], k, &t[i], x[i], NULL), SFDAE_OK);
  for (i = 0; i < COUNT; i++) {
    const double tol = pow(10, -3 - i % 4);
    CHECK(accurate(x[i], 4, tol, tol));
    CHECK(memcmp(x[i], x[i % 4], sizeof x[i]) == 0); /* the same work gives the same result */
    sfdae_destroy(&solver[i]);
  }
}

int main(void) {
  every_status_has_its_name();
  version_is_that_of_the_header();
  init_writes_no_more_than_its_caller_has();
  options_have_the_documented_defaults();
  problems_and_options_of_other_sizes_work();
  forgotten_init_is_noticed();
  results_are_written_as_far_as_the_caller_knows_them();
  wrong_problems_are_refused();
  negative_sizes_are_refused();
  wrong_options_are_refused();
  unused_members_are_not_judged();
  everything_is_copied();
  destroy_allows_nothing();
  no_solver_is_refused_everywhere();
  calls_too_early_are_refused();
  wrong_arguments_are_refused();
  prescribing_what_is_determined_fails();
  too_small_a_max_index_is_said();
  solvers_are_independent();
  return failures != 0;
}
