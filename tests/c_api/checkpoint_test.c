/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Checkpoints through the C API: what is saved, destroyed, created anew and restored goes on in every bit as if nothing
 * had happened; what is not a checkpoint is refused.
 *
 *     s x1' = s x2,   x2' = -x1,   x3' = x4,   0 = x3 - x1 - cos(t / 2),   s = 2 + sin t        mu = 1, d = 2, a = 2
 *     x = (cos t, -sin t, cos t + cos(t/2), -sin t - sin(t/2) / 2)
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
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

/* ---- Problem ---------------------------------------------------------------------------------------- */

enum { N = 4 };
#define TOL 1e-6

typedef struct {
  long calls;
  int no_orders;  /* 1: order 0 only */
  double ends_at; /* no values beyond */
  long stop_at;   /* the call that asks `solver` to stop */
  long last_step; /* that the monitor lets go on */
  sfdae_solver* solver;
} record;

static int seen(record* r, double t, int order) {
  if (++r->calls == r->stop_at) CHECK_STATUS(sfdae_request_stop(r->solver), SFDAE_OK);
  if (t > r->ends_at) return 1;
  return order > 0 && r->no_orders ? SFDAE_ORDER_NOT_AVAILABLE : 0;
}

static double s(double t, int order) { return (order == 0 ? 2 : 0) + sin(t + order * acos(0.0)); }

static int E(double t, int order, double* matrix, void* user) {
  matrix[0] = s(t, order);
  if (order == 0) matrix[5] = matrix[10] = 1;
  return seen((record*)user, t, order);
}

static int A(double t, int order, double* matrix, void* user) {
  matrix[0 + N * 1] = s(t, order);
  if (order == 0) matrix[1 + N * 0] = matrix[3 + N * 0] = -1, matrix[2 + N * 3] = matrix[3 + N * 2] = 1;
  return seen((record*)user, t, order);
}

static int f(double t, int order, double* vector, void* user) {
  vector[3] = -pow(0.5, order) * cos(t / 2 + order * acos(0.0));
  return seen((record*)user, t, order);
}

/* Constant: s = 1. */
static int E_constant(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = matrix[5] = matrix[10] = 1;
  return seen((record*)user, t, order);
}

static int A_constant(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[N] = matrix[2 + N * 3] = matrix[3 + N * 2] = 1, matrix[1] = matrix[3] = -1;
  return seen((record*)user, t, order);
}

/* A change of the characteristic values: the second equation becomes (t - 3/2) x2' = x2 + ..., x as before, so that
 * errors behave like t - 3/2. */
static int E_changing(double t, int order, double* matrix, void* user) {
  const int status = E(t, order, matrix, user);
  matrix[5] = order == 0 ? t - 1.5 : order == 1;
  return status;
}

static int A_changing(double t, int order, double* matrix, void* user) {
  const int status = A(t, order, matrix, user);
  matrix[1] = 0, matrix[5] = order == 0;
  return status;
}

static int f_changing(double t, int order, double* vector, void* user) {
  /* sin t - (t - 3/2) cos t and its derivatives */
  vector[1] =
      sin(t + order * acos(0.0)) - (t - 1.5) * cos(t + order * acos(0.0)) - order * cos(t + (order - 1) * acos(0.0));
  return f(t, order, vector, user);
}

/* Without x4' and with a prescribed x4: three equations, u = 1. */
static int E_free(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[0] = matrix[4] = matrix[8] = 1;
  return seen((record*)user, t, order);
}

static int A_free(double t, int order, double* matrix, void* user) {
  if (order == 0) matrix[3] = matrix[2 + 3 * 3] = 1, matrix[1] = -1;
  return seen((record*)user, t, order);
}

static int prescribed_x4(double t, int order, double* values, void* user) {
  values[0] = -sin(t) - sin(t / 2) / 2;
  return seen((record*)user, t, order);
}

static void exact(double t, double* x) {
  x[0] = cos(t), x[1] = -sin(t), x[2] = cos(t) + cos(t / 2), x[3] = -sin(t) - sin(t / 2) / 2;
}

static int accurate(double t, const double* x) {
  double xe[N];
  int i;
  exact(t, xe);
  for (i = 0; i < N; i++)
    if (!(fabs(x[i] - xe[i]) <= 10 * (TOL * fabs(xe[i]) + TOL))) return 0;
  return 1;
}

/* ---- Settings: what a solver is created with ------------------------------------------------------------- */

typedef struct {
  sfdae_linear_problem problem;
  sfdae_options options;
  record r;
} setting;

static int stop_after_steps(const sfdae_progress* progress, void* user) {
  return progress->steps == ((const setting*)user)->r.last_step;
}

static void initialize(setting* s_, int method) {
  const record r = {0, 0, HUGE_VAL, 0, 0, NULL};
  s_->r = r;
  sfdae_linear_problem_init(&s_->problem, sizeof s_->problem);
  sfdae_options_init(&s_->options, sizeof s_->options);
  s_->problem.num_equations = s_->problem.num_unknowns = N;
  s_->problem.E = E, s_->problem.A = A, s_->problem.f = f;
  s_->problem.user = &s_->r;
  s_->options.rtol = s_->options.atol = TOL;
  s_->options.method = method;
}

static sfdae_solver* create(setting* s_) {
  CHECK_STATUS(sfdae_create_linear(&s_->r.solver, &s_->problem, &s_->options), SFDAE_OK);
  return s_->r.solver;
}

static sfdae_solver* create_and_start(setting* s_, double t, double toward) {
  double x[N];
  sfdae_solver* solver = create(s_);
  exact(t, x);
  CHECK_STATUS(sfdae_start(solver, t, toward, x, NULL), SFDAE_OK);
  return solver;
}

typedef struct {
  double* values;
  size_t length;
} checkpoint;

static checkpoint save(sfdae_solver* solver) {
  checkpoint c = {NULL, 0};
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &c.length), SFDAE_OK);
  CHECK(c.length > 0);
  c.values = (double*)malloc((c.length + 1) * sizeof(double));
  if (!c.values) abort();
  guard(c.values, (c.length + 1) * sizeof(double));
  CHECK_STATUS(sfdae_save_checkpoint(solver, c.values, c.length), SFDAE_OK);
  CHECK(guarded(c.values + c.length, sizeof(double)));
  return c;
}

/* Nothing but the numbers survives. No callback is called. */
static void interrupt(setting* s_, sfdae_solver** solver) {
  checkpoint c = save(*solver);
  const long calls = s_->r.calls;
  CHECK_STATUS(sfdae_destroy(solver), SFDAE_OK);
  *solver = create(s_);
  CHECK_STATUS(sfdae_restore_checkpoint(*solver, c.values, c.length), SFDAE_OK);
  CHECK(sfdae_message(*solver)[0] == 0);
  CHECK(s_->r.calls == calls);
  free(c.values);
}

static sfdae_statistics statistics(const sfdae_solver* solver) {
  sfdae_statistics result;
  sfdae_statistics_init(&result, sizeof result);
  CHECK_STATUS(sfdae_get_statistics(solver, &result), SFDAE_OK);
  /* since creation */
  result.evaluations_E = result.evaluations_A = result.evaluations_f = 0;
  return result;
}

static int same_statistics(const sfdae_solver* one, const sfdae_solver* other) {
  const sfdae_statistics a = statistics(one), b = statistics(other);
  return a.steps == b.steps && a.error_failures == b.error_failures && a.other_failures == b.other_failures &&
         a.last_order == b.last_order && a.next_order == b.next_order && a.last_step == b.last_step &&
         a.next_step == b.next_step && a.t_internal == b.t_internal && a.smallest_kept == b.smallest_kept &&
         a.consistency == b.consistency && a.first_step == b.first_step;
}

/* One call on both: status, t, x, x' and counts agree in every bit. Returns the status. */
static int advance_both(sfdae_solver* plain, sfdae_solver* broken, double tout, int one_step, double* t) {
  double t_plain = -7, t_broken = -7, x[N] = {0}, y[N] = {0}, xdot[N] = {0}, ydot[N] = {0};
  int (*const call)(sfdae_solver*, double, double*, double*, double*) = one_step ? sfdae_step : sfdae_advance;
  const int status = call(plain, tout, &t_plain, x, xdot);
  CHECK_STATUS(call(broken, tout, &t_broken, y, ydot), status);
  CHECK(t_plain == t_broken);
  CHECK(memcmp(x, y, sizeof x) == 0);
  CHECK(memcmp(xdot, ydot, sizeof xdot) == 0);
  CHECK(same_statistics(plain, broken));
  CHECK(strcmp(sfdae_message(plain), sfdae_message(broken)) == 0);
  CHECK(t_plain == -7 || accurate(t_plain, x));
  *t = t_plain;
  return status;
}

/* ---- Every kind of solver, interrupted between all calls --------------------------------------------------- */

static const int fourth[1] = {3};
static const double rtol_vector[N] = {1e-6, 1e-7, 0, 1e-6}, atol_vector[N] = {1e-6, 1e-7, 1e-6, 1e-8};

static const char* vary(setting* s_, int variant) {
  sfdae_linear_problem* p = &s_->problem;
  sfdae_options* o = &s_->options;
  switch (variant) {
    case 0: return "defaults";
    case 1: o->reduction = SFDAE_REDUCTION_SVD; return "SVD";
    case 2: o->leading_term = SFDAE_LEADING_MATRIX; return "W = E";
    case 3: o->leading_term = SFDAE_LEADING_IDENTITY; return "W = I";
    case 4: o->rtol_vector = rtol_vector, o->atol_vector = atol_vector; return "tolerances";
    case 5: o->min_stages = o->max_stages = 3, o->max_order = 4; return "three stages, BDF up to 4";
    case 6: o->time_scale = 0.125, o->rank_tol = 1e-10; return "time scale, rank tolerance";
    case 7: o->max_step = 0.05, o->initial_step = 1e-3; return "limited steps";
    case 8: o->difference_derivatives = 1, s_->r.no_orders = 1; return "differences";
    case 9:
      o->difference_derivatives = 1, o->difference_step = 1e-2, s_->r.no_orders = 1;
      return "differences, step given";
    case 10: p->E = E_constant, p->A = A_constant, p->constant_E = p->constant_A = 1; return "constant matrices";
    case 11: p->E = E_constant, p->constant_E = 1, p->A = A_constant; return "constant E";
    case 12:
      p->num_equations = 3, p->E = E_free, p->A = A_free, p->f = NULL;
      p->num_prescribed = 1, p->prescribed = fourth, p->prescribed_values = prescribed_x4;
      return "prescribed x4";
    default: return NULL;
  }
}

static void interrupted_runs_go_on_in_every_bit(void) {
  int method, variant, direction;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++)
    for (variant = 0;; variant++) {
      const char* name = NULL;
      for (direction = -1; direction <= 1; direction += 2) {
        const double t0 = direction > 0 ? 0 : 4;
        const int failures_before = failures;
        setting one, two;
        sfdae_solver *plain, *broken;
        double t = t0;
        int i;
        initialize(&one, method), initialize(&two, method);
        name = vary(&one, variant);
        if (!name) break;
        vary(&two, variant);
        plain = create_and_start(&one, t0, t0 + 4 * direction);
        broken = create_and_start(&two, t0, t0 + 4 * direction);
        for (i = 1; i <= 60 && failures < failures_before + 3; i++) {
          const double grid = t0 + direction * i / 15.0, tout = direction * (grid - t) > 0 ? grid : t;
          interrupt(&two, &broken);
          advance_both(plain, broken, tout, i % 3 == 1, &t);
        }
        CHECK(direction * (t - (t0 + 3.9 * direction)) > 0);
        sfdae_destroy(&plain);
        sfdae_destroy(&broken);
        if (failures > failures_before)
          fprintf(stderr, "  ... %s, method %d, direction %d, call %d\n", name, method, direction, i);
      }
      if (!name) break;
    }
}

/* ... also when output is so frequent that the automatic choice changes its mind, as it does with steps of one stage.
 * */
static void the_automatic_choice_is_the_same(void) {
  setting one, two;
  sfdae_solver *plain, *broken;
  double t = 0;
  const int failures_before = failures;
  int i;
  char text[8000];
  initialize(&one, SFDAE_METHOD_AUTOMATIC), initialize(&two, SFDAE_METHOD_AUTOMATIC);
  one.options.max_stages = two.options.max_stages = 1;
  plain = create_and_start(&one, 0, 4), broken = create_and_start(&two, 0, 4);
  for (i = 1; i <= 400 && failures == failures_before; i++) {
    interrupt(&two, &broken);
    CHECK_STATUS(advance_both(plain, broken, 5e-5 * i, 0, &t), SFDAE_OK);
  }
  CHECK_STATUS(sfdae_report(broken, text, sizeof text, NULL), SFDAE_OK);
  CHECK(strstr(text, "by BDF (chosen automatically)") != NULL && strstr(text, "restored from a checkpoint") != NULL);
  sfdae_destroy(&plain);
  sfdae_destroy(&broken);
}

/* ---- Calls that end early ------------------------------------------------------------------------------------ */

enum early { MONITOR, REQUEST, MAX_STEPS, NO_VALUES, CHANGE, EARLY };
static const int early_status[EARLY] = {SFDAE_STOPPED, SFDAE_STOPPED, SFDAE_MAX_STEPS, SFDAE_CALLBACK_FAILED,
                                        SFDAE_CHARACTERISTICS_CHANGED};

static void ends_early(setting* s_, int method, enum early early) {
  initialize(s_, method);
  if (early == MONITOR) s_->options.monitor = stop_after_steps, s_->options.monitor_user = s_;
  if (early == MAX_STEPS) s_->options.max_steps = 2;
  if (early == CHANGE) s_->problem.E = E_changing, s_->problem.A = A_changing, s_->problem.f = f_changing;
}

static void calls_that_end_early_can_be_saved(void) {
  int method, early;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++)
    for (early = 0; early < EARLY; early++) {
      const int failures_before = failures;
      setting one, two;
      sfdae_solver *plain, *broken;
      sfdae_change change, restored_change;
      double t = 0;
      int status, calls = 0;
      ends_early(&one, method, (enum early)early), ends_early(&two, method, (enum early)early);
      plain = create_and_start(&one, 0, 4), broken = create_and_start(&two, 0, 4);
      one.r.calls = two.r.calls = 0;
      if (early == MONITOR) one.r.last_step = two.r.last_step = 2;
      if (early == REQUEST) one.r.stop_at = two.r.stop_at = 30;
      if (early == NO_VALUES) one.r.ends_at = two.r.ends_at = 1.5;
      CHECK_STATUS(advance_both(plain, broken, 4, 0, &t), early_status[early]);
      interrupt(&two, &broken);
      sfdae_change_init(&change, sizeof change), sfdae_change_init(&restored_change, sizeof change);
      CHECK_STATUS(sfdae_get_change(plain, &change), early == CHANGE ? SFDAE_OK : SFDAE_NOT_STARTED);
      CHECK_STATUS(sfdae_get_change(broken, &restored_change), early == CHANGE ? SFDAE_OK : SFDAE_NOT_STARTED);
      CHECK(memcmp(&change, &restored_change, sizeof change) == 0);
      one.r.ends_at = two.r.ends_at = HUGE_VAL;
      do {
        interrupt(&two, &broken);
        status = advance_both(plain, broken, fmax(4, t), 0, &t);
      } while (status == SFDAE_MAX_STEPS && ++calls < 1000);
      CHECK_STATUS(status, early == CHANGE ? SFDAE_CHARACTERISTICS_CHANGED : SFDAE_OK);
      sfdae_destroy(&plain);
      sfdae_destroy(&broken);
      if (failures > failures_before) fprintf(stderr, "  ... method %d, end %d\n", method, early);
    }
}

/* ---- Text -------------------------------------------------------------------------------------------------------- */

static void checkpoints_survive_a_text_file(void) {
  int method;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++) {
    setting one, two;
    sfdae_solver *plain, *broken;
    double t = 0, x[N];
    int k;
    initialize(&one, method), initialize(&two, method);
    plain = create_and_start(&one, 0, 4);
    for (k = 0; k <= 3; k++) { /* at the start, too, where there are infinities */
      checkpoint c;
      FILE* file = tmpfile();
      size_t i, length = 0;
      double* values;
      if (k > 0) CHECK_STATUS(sfdae_advance(plain, k, &t, x, NULL), SFDAE_OK);
      c = save(plain);
      if (!file) abort();
      fprintf(file, "%zu\n", c.length);
      for (i = 0; i < c.length; i++) fprintf(file, "%.17g\n", c.values[i]);
      rewind(file);
      CHECK(fscanf(file, "%zu", &length) == 1 && length == c.length);
      values = (double*)malloc(c.length * sizeof(double));
      if (!values) abort();
      for (i = 0; i < c.length; i++) CHECK(fscanf(file, "%lf", &values[i]) == 1);
      fclose(file);
      CHECK(memcmp(values, c.values, c.length * sizeof(double)) == 0);
      broken = create(&two);
      CHECK_STATUS(sfdae_restore_checkpoint(broken, values, length), SFDAE_OK);
      CHECK_STATUS(advance_both(plain, broken, k + 0.5, 0, &t), SFDAE_OK);
      sfdae_destroy(&broken);
      free(values);
      free(c.values);
    }
    sfdae_destroy(&plain);
  }
}

/* ---- What is refused ----------------------------------------------------------------------------------------- */

/* Refused with a reason, and nothing changes: an integration under way is where it was, in every bit. */
static void refused(int line, sfdae_solver* solver, const double* values, size_t length) {
  double t, x[N];
  size_t present = 0;
  checkpoint was = {NULL, 0}, is = {NULL, 0};
  const int before = failures, is_started = sfdae_get_checkpoint_length(solver, &present) == SFDAE_OK;
  if (is_started) was = save(solver);
  check_status(__FILE__, line, "sfdae_restore_checkpoint", sfdae_restore_checkpoint(solver, values, length),
               SFDAE_ILLEGAL_ARGUMENT);
  CHECK(sfdae_message(solver)[0] != 0);
  if (is_started) {
    is = save(solver);
    CHECK(is.length == was.length && memcmp(is.values, was.values, is.length * sizeof(double)) == 0);
    free(was.values), free(is.values);
  } else {
    guard(&t, sizeof t), guard(x, sizeof x);
    CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), SFDAE_NOT_STARTED);
    CHECK(guarded(&t, sizeof t) && guarded(x, sizeof x));
  }
  if (failures > before) fprintf(stderr, "  ... from line %d\n", line);
}
#define REFUSED(solver, values, length) refused(__LINE__, (solver), (values), (length))

static void damage_is_noticed(void) {
  int method;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++) {
    setting one;
    sfdae_solver* solver;
    checkpoint c;
    double t, x[N], zeros[500] = {0};
    size_t i;
    int bit;
    initialize(&one, method);
    solver = create_and_start(&one, 0, 4);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
    c = save(solver);
    for (i = 0; i < c.length; i++) {
      const double intact = c.values[i], wrong[] = {NAN, INFINITY, -1, 0.5, 1e300, -intact};
      for (bit = 0; bit < 64; bit++) { /* every single bit */
        unsigned char* byte = (unsigned char*)&c.values[i] + bit / 8;
        *byte = (unsigned char)(*byte ^ (1u << bit % 8));
        REFUSED(solver, c.values, c.length);
        c.values[i] = intact;
      }
      for (bit = 0; bit < 6; bit++) {
        c.values[i] = wrong[bit];
        if (memcmp(&intact, &c.values[i], sizeof intact) != 0) REFUSED(solver, c.values, c.length);
        c.values[i] = intact;
      }
      if (i > 0) { /* two exchanged */
        c.values[i] = c.values[i - 1], c.values[i - 1] = intact;
        if (memcmp(&c.values[i], &c.values[i - 1], sizeof intact) != 0) REFUSED(solver, c.values, c.length);
        c.values[i - 1] = c.values[i], c.values[i] = intact;
      }
    }
    for (i = 0; i < c.length; i++) REFUSED(solver, c.values, i); /* truncated */
    REFUSED(solver, zeros, 500);
    REFUSED(solver, zeros, 1);
    REFUSED(solver, c.values + 1, c.length - 1);

    /* The intact one is accepted after all, in a longer array, too; so is a new start. */
    CHECK_STATUS(sfdae_restore_checkpoint(solver, c.values, c.length + 1), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, 3, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(3, x));
    REFUSED(solver, c.values, c.length - 1);
    exact(0, x);
    CHECK_STATUS(sfdae_start(solver, 0, 4, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, 4, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(4, x));
    free(c.values);
    sfdae_destroy(&solver);
  }
}

/* Other sizes are noticed always. Other options may be noticed; in any case nothing is read or written out of bounds,
 * and no call crashes. */
static void foreign_checkpoints_do_no_harm(void) {
  int method, other, variant, k;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++)
    for (k = 0; k < 4; k++) {
      static const int stages[4][2] = {{1, 7}, {7, 7}, {1, 1}, {3, 5}};
      setting one, two;
      sfdae_solver* solver;
      checkpoint c;
      double t, x[N];
      int l;
      initialize(&one, method);
      one.options.min_stages = stages[k][0], one.options.max_stages = stages[k][1];
      one.options.rtol = one.options.atol = k == 2 ? 1e-3 : 1e-9;
      solver = create_and_start(&one, 0, 4);
      CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
      c = save(solver);
      sfdae_destroy(&solver);

      initialize(&two, method);
      two.problem.num_equations = 3;
      solver = create(&two);
      REFUSED(solver, c.values, c.length);
      sfdae_destroy(&solver);
      initialize(&two, method);
      two.problem.num_unknowns = 5;
      solver = create(&two);
      REFUSED(solver, c.values, c.length);
      sfdae_destroy(&solver);

      for (other = SFDAE_METHOD_BDF; other <= SFDAE_METHOD_AUTOMATIC; other++)
        for (l = 0; l < 4; l++)
          for (variant = 0; variant <= 11; variant++) {
            int status;
            initialize(&two, other);
            vary(&two, variant);
            two.options.min_stages = stages[l][0], two.options.max_stages = stages[l][1];
            solver = create(&two);
            status = sfdae_restore_checkpoint(solver, c.values, c.length);
            CHECK(status == SFDAE_OK || status == SFDAE_ILLEGAL_ARGUMENT);
            status = sfdae_step(solver, 4, &t, x, NULL);
            if (status == SFDAE_STEP_TAKEN) status = sfdae_advance(solver, 4, &t, x, NULL);
            CHECK(status <= SFDAE_OK && status != SFDAE_INTERNAL);
            sfdae_destroy(&solver);
          }
      free(c.values);
    }
}

static void wrong_arguments_are_refused(void) {
  setting one;
  sfdae_solver* solver;
  checkpoint c;
  double values[1000], t, x[N];
  size_t length, i;
  initialize(&one, SFDAE_METHOD_RADAU);
  solver = create(&one);
  guard(&length, sizeof length), guard(values, sizeof values);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_save_checkpoint(solver, values, 1000), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, &length), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_save_checkpoint(solver, values, 1000), SFDAE_NOT_STARTED);
  CHECK(sfdae_message(solver)[0] != 0);
  CHECK(guarded(&length, sizeof length) && guarded(values, sizeof values));
  sfdae_destroy(&solver);

  solver = create_and_start(&one, 0, 4);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  c = save(solver);
  CHECK(c.length <= 1000);
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_save_checkpoint(solver, NULL, c.length), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_restore_checkpoint(solver, NULL, c.length), SFDAE_ILLEGAL_ARGUMENT);
  for (i = 0; i < c.length; i++) { /* too short */
    CHECK_STATUS(sfdae_save_checkpoint(solver, values, i), SFDAE_ILLEGAL_ARGUMENT);
    CHECK(guarded(values, sizeof values) && sfdae_message(solver)[0] != 0);
  }
  CHECK_STATUS(sfdae_save_checkpoint(solver, values, 1000), SFDAE_OK); /* longer than needed */
  CHECK(memcmp(values, c.values, c.length * sizeof(double)) == 0);
  CHECK(guarded(values + c.length, (1000 - c.length) * sizeof(double)));
  free(c.values);
  sfdae_destroy(&solver);
}

/* ---- After a restoration --------------------------------------------------------------------------------------- */

static void options_may_change_after_a_restoration(void) {
  int method;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++) {
    setting one, two;
    sfdae_solver *plain, *broken;
    double t, x[N];
    initialize(&one, method), initialize(&two, method);
    plain = create_and_start(&one, 0, 4), broken = create_and_start(&two, 0, 4);
    CHECK_STATUS(advance_both(plain, broken, 1, 0, &t), SFDAE_OK);
    interrupt(&two, &broken);
    one.options.rtol = one.options.atol = 1e-8;
    one.options.max_step = 0.1;
    one.options.use_stop_time = 1, one.options.stop_time = 2.5;
    CHECK_STATUS(sfdae_set_options(plain, &one.options), SFDAE_OK);
    CHECK_STATUS(sfdae_set_options(broken, &one.options), SFDAE_OK);
    CHECK_STATUS(advance_both(plain, broken, 2, 0, &t), SFDAE_OK);
    CHECK_STATUS(advance_both(plain, broken, 2.5, 0, &t), SFDAE_OK);
    CHECK(statistics(broken).t_internal == 2.5 && fabs(statistics(broken).last_step) <= 0.1 * (1 + 4 * DBL_EPSILON));
    one.options.max_index = 3; /* needs a new analysis */
    CHECK_STATUS(sfdae_set_options(broken, &one.options), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(broken, 2.5, &t, x, NULL), SFDAE_NOT_STARTED);
    sfdae_destroy(&plain);
    sfdae_destroy(&broken);
  }
}

/* Looking inside, new starts and everything else work as after sfdae_start. */
static void the_solver_is_whole_after_a_restoration(void) {
  setting one, two;
  sfdae_solver *plain, *broken;
  sfdae_characteristics a, b;
  sfdae_initial_report report;
  double t, x[N], xdot[N], Z2[2 * N * 2], Z2_plain[2 * N * 2];
  int count = -1, vhat;
  initialize(&one, SFDAE_METHOD_RADAU), initialize(&two, SFDAE_METHOD_RADAU);
  plain = create_and_start(&one, 0, 4), broken = create_and_start(&two, 0, 4);
  CHECK_STATUS(advance_both(plain, broken, 1, 0, &t), SFDAE_OK);
  interrupt(&two, &broken);
  CHECK(same_statistics(plain, broken));
  sfdae_characteristics_init(&a, sizeof a), sfdae_characteristics_init(&b, sizeof b);
  sfdae_initial_report_init(&report, sizeof report);
  CHECK_STATUS(sfdae_get_characteristics(plain, &a), SFDAE_OK);
  CHECK_STATUS(sfdae_get_characteristics(broken, &b), SFDAE_OK);
  CHECK(a.t == b.t && a.strangeness_index == b.strangeness_index && a.differential == b.differential);
  CHECK(a.algebraic == b.algebraic && a.undetermined == b.undetermined && a.redundant == b.redundant);
  CHECK(a.rank_E == b.rank_E && a.leading_term == b.leading_term && a.time_scale == b.time_scale);
  CHECK_STATUS(sfdae_get_num_decisions(broken, &count), SFDAE_NOT_STARTED); /* they are not in it */
  CHECK(count == -1);
  CHECK_STATUS(sfdae_get_initial_report(broken, &report), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_projectors(plain, 1.5, NULL, Z2_plain, NULL, NULL, &vhat), SFDAE_OK);
  CHECK_STATUS(sfdae_get_projectors(broken, 1.5, NULL, Z2, NULL, NULL, &vhat), SFDAE_OK);
  CHECK(memcmp(Z2, Z2_plain, sizeof Z2) == 0);
  exact(1.5, x);
  CHECK_STATUS(sfdae_make_consistent(broken, 1.5, x, xdot), SFDAE_OK);
  CHECK(accurate(1.5, x));
  CHECK_STATUS(advance_both(plain, broken, 2, 0, &t), SFDAE_OK); /* undisturbed */
  CHECK_STATUS(sfdae_start(broken, 1.5, 4, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(broken, 4, &t, x, NULL), SFDAE_OK);
  CHECK(accurate(4, x));
  CHECK_STATUS(sfdae_start(broken, 4, 0, x, NULL), SFDAE_OK); /* backward */
  CHECK_STATUS(sfdae_advance(broken, 0, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - 1) <= 20 * (TOL + TOL));
  sfdae_destroy(&plain);
  sfdae_destroy(&broken);
}

/* One checkpoint for two solvers, into a solver that is on its way elsewhere, and again. */
static void a_checkpoint_can_be_restored_again_and_again(void) {
  int method;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_AUTOMATIC; method++) {
    setting one, two;
    sfdae_solver *first, *second;
    checkpoint c, again;
    double t, x[N], y[N];
    int k;
    initialize(&one, method), initialize(&two, method);
    first = create_and_start(&one, 0, 4);
    CHECK_STATUS(sfdae_advance(first, 1, &t, x, NULL), SFDAE_OK);
    c = save(first), again = save(first);
    CHECK(c.length == again.length && memcmp(c.values, again.values, c.length * sizeof(double)) == 0);
    free(again.values);
    CHECK_STATUS(sfdae_advance(first, 3, &t, x, NULL), SFDAE_OK);
    second = create_and_start(&two, 4, 0); /* backward */
    CHECK_STATUS(sfdae_advance(second, 3.5, &t, y, NULL), SFDAE_OK);
    for (k = 0; k < 3; k++) {
      CHECK_STATUS(sfdae_restore_checkpoint(second, c.values, c.length), SFDAE_OK);
      CHECK_STATUS(sfdae_advance(second, 0.5, &t, y, NULL), SFDAE_ILLEGAL_ARGUMENT); /* behind the last output */
      CHECK_STATUS(sfdae_advance(second, 3, &t, y, NULL), SFDAE_OK);
      CHECK(memcmp(x, y, sizeof x) == 0 && same_statistics(first, second));
    }
    free(c.values);
    sfdae_destroy(&first);
    sfdae_destroy(&second);
  }
}

int main(void) {
  interrupted_runs_go_on_in_every_bit();
  the_automatic_choice_is_the_same();
  calls_that_end_early_can_be_saved();
  checkpoints_survive_a_text_file();
  damage_is_noticed();
  foreign_checkpoints_do_no_harm();
  wrong_arguments_are_refused();
  options_may_change_after_a_restoration();
  the_solver_is_whole_after_a_restoration();
  a_checkpoint_can_be_restored_again_and_again();
  return failures != 0;
}
