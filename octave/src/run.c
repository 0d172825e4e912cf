/* SPDX-License-Identifier: BSD-3-Clause
 *
 * One integration from start to end, with the collection of its results. The points reached are kept after any end:
 * normal, an event, a failure, Ctrl-C. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sfdae_mex.h"

/* Points (t, x, x', S), or events; arrays grow. */
typedef struct points {
  size_t n, sensitivities; /* values of x, of S */
  size_t count, capacity;
  double *t, *x, *xdot, *S;
} points;

typedef struct run {
  problem* p;
  sfdae_options* options;
  sfdae_solver* solver;
  sfdae_solution* dense;
  size_t n;
  int num_parameters; /* of sensitivities */
  double t0, t1, direction;
  const double* tout; /* NULL: ends of steps */
  size_t num_tout;
  int wants_xdot, wants_dense;
  const double* limits; /* of events: the integration ends after that many, 0: never */
  double* counts;
  const mxArray* action;
  points outputs, happened;
  double* which; /* event of each point of `happened` */
  double* rising;
  double t, *x, *xdot, *S; /* the point reached */
  long attempts_left;
  char notes[2000];
  mxArray* switches; /* of runs before a restart */
  int is_restarted;  /* by the action of the last event */
  int status;
  char message[1200]; /* "": that of the solver */
} run;

static void add_point(points* to, double t, const double* x, const double* xdot, const double* S) {
  if (to->count == to->capacity) {
    to->capacity = 2 * to->capacity + 128;
    to->t = (double*)mxRealloc(to->t, to->capacity * sizeof(double));
    to->x = (double*)mxRealloc(to->x, to->capacity * to->n * sizeof(double));
    to->xdot = (double*)mxRealloc(to->xdot, to->capacity * to->n * sizeof(double));
    if (to->sensitivities > 0) to->S = (double*)mxRealloc(to->S, to->capacity * to->sensitivities * sizeof(double));
  }
  to->t[to->count] = t;
  memcpy(to->x + to->count * to->n, x, to->n * sizeof(double));
  if (xdot != NULL) memcpy(to->xdot + to->count * to->n, xdot, to->n * sizeof(double));
  else memset(to->xdot + to->count * to->n, 0, to->n * sizeof(double));
  if (to->sensitivities > 0) memcpy(to->S + to->count * to->sensitivities, S, to->sensitivities * sizeof(double));
  ++to->count;
}

/* Adds the point reached to the outputs. */
static void add_output(run* r) {
  if (r->num_parameters > 0 && sfdae_get_sensitivities(r->solver, r->t, r->S, NULL) < 0) {
    memset(r->S, 0, r->n * (size_t)r->num_parameters * sizeof(double));
  }
  add_point(&r->outputs, r->t, r->x, r->wants_xdot ? r->xdot : NULL, r->S);
}

/* A message that does not end the run. */
static void note(run* r, const char* message) {
  const size_t used = strlen(r->notes);
  if (strstr(r->notes, message) != NULL) return;
  snprintf(r->notes + used, sizeof r->notes - used, "%s%s", used > 0 ? "\n" : "", message);
}

static int fails(int status) { return status < 0 || status == SFDAE_STOPPED; }

/* ---- Start ------------------------------------------------------------------------------------ */

static int set_up(run* r, const mxArray* from) {
  const mxArray* names = field_of(from, "sensitivities");
  int count = 0, status = SFDAE_OK, num_breakpoints = (int)length_of(from, "breakpoints");
  const char** parameters = texts_in(from, "sensitivities", &count);
  const double* directions = numbers_in(from, "sensitivity_directions", r->n * (size_t)count);
  const double* times = numbers_in(from, "breakpoints", (size_t)num_breakpoints);
  const int* kinds = integers_in(from, "breakpoint_kinds", (size_t)num_breakpoints, 0);
  const int* event_directions = integers_in(from, "event_directions", (size_t)r->p->num_events, 0);
  r->num_parameters = count;
  r->outputs.sensitivities = r->n * (size_t)count;
  r->S = (double*)mxCalloc(r->n * (size_t)count + 1, sizeof(double));
  status = open_solver(r->p, r->options, &r->solver);
  if (status >= 0 && names != NULL) {
    int i, all_directions = 1;
    for (i = 0; i < count; ++i) all_directions = all_directions && parameters[i][0] == 0;
    for (i = 0; i < count; ++i) {
      if (parameters[i][0] == 0) parameters[i] = NULL;
    }
    status = sfdae_set_sensitivities(r->solver, count, all_directions ? NULL : parameters, directions, NULL);
  }
  if (status >= 0 && num_breakpoints > 0) status = sfdae_set_breakpoints(r->solver, num_breakpoints, times, kinds);
  if (status >= 0 && r->p->num_events > 0) {
    status = sfdae_set_events(r->solver, r->p->num_events, call_events, event_directions, r->p);
  }
  if (status >= 0 && r->wants_dense) {
    status = sfdae_create_solution(&r->dense);
    if (status >= 0) status = sfdae_record_solution(r->solver, r->dense);
  }
  return status;
}

static int start(run* r, double t) {
  int status;
  r->t = t;
  status = sfdae_start(r->solver, t, r->t1, r->x, r->xdot);
  if (status > 0 && status != SFDAE_STOPPED) note(r, sfdae_message(r->solver));
  return status;
}

/* ---- Events ----------------------------------------------------------------------------------- */

/* Calls the action of an event; *changed: whether x is to be changed. Returns a status. */
static int call_action(run* r, const int* which, int* changed) {
  mxArray *in[4], *out = NULL;
  double* numbers;
  int i, k = 0, status;
  *changed = 0;
  if (r->action == NULL) return SFDAE_OK;
  in[0] = mxCreateDoubleScalar(r->t);
  in[1] = column_of(r->x, r->n);
  in[2] = column_of(r->xdot, r->n);
  for (i = 0; i < r->p->num_events; ++i) k += which[i] != 0;
  in[3] = mxCreateDoubleMatrix((mwSize)k, 1, mxREAL);
  numbers = mxGetPr(in[3]);
  for (i = 0, k = 0; i < r->p->num_events; ++i) {
    if (which[i] != 0) numbers[k++] = i + 1;
  }
  status = call_function(r->p->calls, r->action, 1, &out, 4, in);
  if (status != 0) return SFDAE_CALLBACK_STOPPED;
  if (mxIsEmpty(out)) {
    mxDestroyArray(out);
    return SFDAE_OK;
  }
  *changed = 1;
  return take_numbers(r->p->calls, out, r->n, 1, "event_action", r->x) == 0 ? SFDAE_OK : SFDAE_CALLBACK_STOPPED;
}

/* The steps of the integration so far, rejected ones included, since its start. */
static long attempts(const sfdae_solver* solver) {
  sfdae_statistics s;
  sfdae_statistics_init(&s, sizeof s);
  if (sfdae_get_statistics(solver, &s) < 0) return 0;
  return s.steps + s.error_failures + s.other_failures;
}

/* Notes the events at the point reached and restarts if their action changes x. Returns the status with which the run
 * ends, or SFDAE_OK. */
static int handle_event(run* r) {
  int* which = (int*)mxCalloc((size_t)r->p->num_events + 1, sizeof(int));
  int i, ends = 0, changed, status;
  sfdae_get_events(r->solver, which);
  for (i = 0; i < r->p->num_events; ++i) {
    const size_t place = r->happened.count;
    if (which[i] == 0) continue;
    add_point(&r->happened, r->t, r->x, r->xdot, NULL);
    r->which = (double*)mxRealloc(r->which, (place + 1) * sizeof(double));
    r->rising = (double*)mxRealloc(r->rising, (place + 1) * sizeof(double));
    r->which[place] = i + 1;
    r->rising[place] = which[i];
    r->counts[i] += 1.0;
    if (r->limits != NULL && r->limits[i] > 0.0 && r->counts[i] >= r->limits[i]) ends = 1;
  }
  r->is_restarted = 0;
  status = call_action(r, which, &changed);
  mxFree(which);
  if (status < 0) return status;
  if (changed && r->num_parameters > 0) {
    snprintf(r->message, sizeof r->message,
             "event_action changes x at t = %.9g, and the derivatives of this change, which "
             "the sensitivities need, are unknown; return [] or solve without sensitivities",
             r->t);
    return SFDAE_ILLEGAL_ARGUMENT;
  }
  if (changed && !ends && r->t != r->t1) {
    r->attempts_left -= attempts(r->solver);
    r->switches = switches_of(r->solver, r->switches);
    status = start(r, r->t);
    if (fails(status)) return status;
    r->is_restarted = 1;
  }
  return ends ? SFDAE_EVENT : SFDAE_OK;
}

/* ---- Integration ------------------------------------------------------------------------------ */

/* One call: to `target`, or one step toward it. The limit of attempts holds for the whole run; single steps, which have
 * few attempts, are counted between calls. */
static int call_solver(run* r, int one_step, double target) {
  const long left = r->attempts_left - attempts(r->solver);
  double t = r->t, *xdot = r->wants_xdot || r->action != NULL ? r->xdot : NULL;
  int status;
  if (!one_step && left < r->options->max_steps) {
    r->options->max_steps = left > 0 ? left : 1;
    status = sfdae_set_options(r->solver, r->options);
    if (status < 0) return status;
  }
  if (left <= 0) {
    sfdae_statistics s;
    sfdae_statistics_init(&s, sizeof s);
    sfdae_get_statistics(r->solver, &s);
    if ((target - s.t_internal) * r->direction > 0.0) return SFDAE_MAX_STEPS;
  }
  status =
      one_step ? sfdae_step(r->solver, target, &t, r->x, xdot) : sfdae_advance(r->solver, target, &t, r->x, xdot);
  if (!isnan(t)) r->t = t;
  if (status == SFDAE_INCONSISTENCY_IGNORED) note(r, sfdae_message(r->solver));
  if (status == SFDAE_STEP_TAKEN || status == SFDAE_INCONSISTENCY_IGNORED) status = SFDAE_OK;
  return status;
}

/* A call and what follows from it. Returns SFDAE_OK, or the status with which the run ends. *at_event: an event ended
 * the call; the values before its action are an output already if the outputs are the ends of steps, or if the event is
 * at `target` or ends the run. */
static int proceed(run* r, int one_step, double target, int* at_event) {
  int status = call_solver(r, one_step, target);
  *at_event = status == SFDAE_EVENT;
  if (!*at_event) return status;
  if (r->tout == NULL ? r->outputs.t[r->outputs.count - 1] != r->t : r->t == target) add_output(r);
  status = handle_event(r);
  if (r->tout == NULL && r->is_restarted) add_output(r); /* the values after the action, at the same time */
  if (r->tout != NULL && status == SFDAE_EVENT && r->t != target) add_output(r);
  return status;
}

/* The outputs are the ends of steps. */
static void integrate_by_steps(run* r) {
  while (r->status == SFDAE_OK && r->t != r->t1) {
    const double before = r->t;
    int at_event;
    r->status = proceed(r, 1, r->t1, &at_event);
    if (!at_event && r->t != before) add_output(r);
  }
}

/* The outputs are at given times, of which the last is the end. */
static void integrate_to_outputs(run* r) {
  size_t k = r->tout[0] == r->t ? 1 : 0;
  while (r->status == SFDAE_OK && k < r->num_tout) {
    int at_event;
    r->status = proceed(r, 0, r->tout[k], &at_event);
    if (at_event) {
      k += r->t == r->tout[k];
    } else if (r->status == SFDAE_OK) {
      add_output(r);
      ++k;
    }
  }
}

static void integrate(run* r) {
  if (r->tout == NULL) integrate_by_steps(r);
  else integrate_to_outputs(r);
  if (r->status == SFDAE_MAX_STEPS && r->message[0] == 0) {
    snprintf(
        r->message, sizeof r->message,
        "%ld steps were attempted in the whole run, the limit max_steps, without "
        "reaching the end t = %.9g. Raise max_steps, or loosen the tolerances. If the steps are very small, look for "
        "their reason first, such as an equation that jumps.",
        r->attempts_left, r->t1);
  }
  if (r->status == SFDAE_EVENT) {
    snprintf(r->message, sizeof r->message, "an event ended the integration at t = %.9g", r->t);
  }
}

/* ---- Results ---------------------------------------------------------------------------------- */

static void finish_dense(run* r, mxArray* result) {
  double first, last, accuracy = 0.0, where = 0.0;
  size_t length = 0;
  mxArray* numbers;
  sfdae_record_solution(r->solver, NULL);
  if (sfdae_get_solution_range(r->dense, NULL, &first, &last) < 0) return;
  if ((r->t - first) * (r->t - last) <= 0.0 && r->t != first) sfdae_cut_solution(r->dense, r->t);
  if (sfdae_get_solution_accuracy(r->dense, &accuracy, &where) >= 0 && accuracy > 10.0) {
    char text[200];
    snprintf(text, sizeof text,
             "dense output differs from the solution by %.0f tolerances near t = %.6g, where it has a "
             "jump or a kink; the outputs themselves are accurate there",
             accuracy < 1e299 ? accuracy : 1e300, where);
    note(r, text);
  }
  if (sfdae_get_solution_length(r->dense, &length) < 0) return;
  numbers = mxCreateDoubleMatrix((mwSize)length, 1, mxREAL);
  sfdae_save_solution(r->dense, mxGetPr(numbers), length);
  set_field(result, "dense", numbers);
}

static void set_points(const run* r, mxArray* result) {
  const points *o = &r->outputs, *e = &r->happened;
  set_field(result, "t", matrix_of(o->t, 1, o->count));
  set_field(result, "x", matrix_of(o->x, r->n, o->count));
  set_field(result, "xdot", matrix_of(o->xdot, r->n, r->wants_xdot ? o->count : 0));
  set_field(result, "te", matrix_of(e->t, 1, e->count));
  set_field(result, "xe", matrix_of(e->x, r->n, e->count));
  set_field(result, "ie", matrix_of(r->which, 1, e->count));
  set_field(result, "rising", matrix_of(r->rising, 1, e->count));
  set_field(result, "S", matrix_of(o->S, o->sensitivities, r->num_parameters > 0 ? o->count : 0));
}

static mxArray* results_of(run* r, int has_started) {
  mxArray* result = new_struct();
  set_status(result, r->p, r->solver, r->status, r->message[0] != 0 ? r->message : NULL);
  set_number(result, "has_started", has_started);
  set_number(result, "last_t", r->t);
  set_points(r, result);
  if (r->solver == NULL) return result;
  set_field(result, "characteristics", characteristics_of(r->solver));
  set_field(result, "statistics", statistics_of(r->solver));
  set_field(result, "initial", initial_report_of(r->solver));
  set_field(result, "report", report_of(r->solver));
  set_field(result, "switches", switches_of(r->solver, r->switches));
  if (r->dense != NULL && has_started) finish_dense(r, result);
  set_field(result, "notes", mxCreateString(r->notes));
  return result;
}

static void read_run(run* r, const mxArray* from) {
  const double* x0;
  const double* xdot0;
  r->t0 = number_in(from, "t0", 0.0);
  r->t1 = number_in(from, "t1", 0.0);
  r->direction = r->t1 > r->t0 ? 1.0 : -1.0;
  r->num_tout = length_of(from, "tout");
  r->tout = numbers_in(from, "tout", r->num_tout);
  r->wants_dense = number_in(from, "dense", 0.0) != 0.0;
  r->wants_xdot = number_in(from, "wants_xdot", 1.0) != 0.0;
  r->p->events = handle_in(from, "events");
  r->p->num_events = r->p->events == NULL ? 0 : (int)integer_in(from, "num_events", 0);
  r->p->event_outputs = number_in(from, "event_outputs", 1.0) == 3.0 ? 3 : 1;
  r->p->monitor = handle_in(from, "monitor");
  r->action = handle_in(from, "event_action");
  r->limits = numbers_in(from, "event_limits", (size_t)r->p->num_events);
  r->counts = (double*)mxCalloc((size_t)r->p->num_events + 1, sizeof(double));
  x0 = numbers_in(from, "x0", r->n);
  xdot0 = numbers_in(from, "xdot0", r->n);
  if (x0 == NULL) refuse("x0 is missing");
  r->x = (double*)mxMalloc((r->n + 1) * sizeof(double));
  r->xdot = (double*)mxCalloc(r->n + 1, sizeof(double));
  memcpy(r->x, x0, r->n * sizeof(double));
  if (xdot0 != NULL) memcpy(r->xdot, xdot0, r->n * sizeof(double));
  r->outputs.n = r->happened.n = r->n;
  r->options->monitor = call_monitor;
  r->options->monitor_user = r->p;
  r->attempts_left = r->options->max_steps;
  if (field_of(from, "limit_is_default") != NULL) r->attempts_left *= 100; /* 100000 between two outputs */
}

mxArray* solve_command(const mxArray* from, const mxArray* options, const mxArray* how) {
  run r;
  mxArray* result;
  int has_started = 0;
  memset(&r, 0, sizeof r);
  r.p = read_problem(from);
  r.n = (size_t)r.p->num_unknowns;
  r.options = read_options(options, r.p->num_unknowns);
  read_run(&r, how);
  r.status = set_up(&r, how);
  if (r.status >= 0) r.status = start(&r, r.t0);
  if (!fails(r.status)) {
    has_started = 1;
    r.status = SFDAE_OK;
    if (r.tout == NULL || r.tout[0] == r.t) add_output(&r);
    integrate(&r);
  }
  result = results_of(&r, has_started);
  close_solver(&r.solver);
  if (r.dense != NULL) sfdae_destroy_solution(&r.dense);
  return result;
}
