/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The part of the module sfdae._binding that is written in C, because it runs at every step or output. Included by the
 * source that build_binding.py writes, after sfdae.h. */
#include <stdlib.h>
#include <time.h>

/* Steps of an integration. Python is called after every one, or else now and then, which is where it notices Ctrl-C. */
typedef struct python_recorder {
  double* steps; /* t, signed size and order of each */
  size_t count, capacity;
  int records;      /* 1: steps are kept */
  int calls_python; /* 1: after every step */
  double next_call; /* seconds */
  void* user;       /* of Python's monitor */
} python_recorder;

/* Seconds between two looks at Ctrl-C, much less than a person notices. */
#define PYTHON_CALL_INTERVAL 0.05

static int python_options_monitor(sfdae_progress* progress, void* user); /* written by cffi, which knows no const */

/* Seconds since some time in the past. */
static double python_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The monitor of all solvers: keeps the step, calls Python's. */
static int python_record_step(const sfdae_progress* progress, void* user) {
  python_recorder* recorder = (python_recorder*)user;
  double now;
  if (recorder->records) {
    double* step;
    if (recorder->count == recorder->capacity) {
      const size_t capacity = 2 * recorder->capacity + 256;
      double* steps = (double*)realloc(recorder->steps, 3 * capacity * sizeof(double));
      if (steps == NULL) return 1; /* stops: better than steps that are missing */
      recorder->steps = steps;
      recorder->capacity = capacity;
    }
    step = recorder->steps + 3 * recorder->count++;
    step[0] = progress->t;
    step[1] = progress->step;
    step[2] = progress->order;
  }
  if (recorder->calls_python) return python_options_monitor((sfdae_progress*)progress, recorder->user);
  now = python_seconds();
  if (now < recorder->next_call) return 0;
  recorder->next_call = now + PYTHON_CALL_INTERVAL;
  return python_options_monitor((sfdae_progress*)progress, recorder->user);
}

static void python_free_steps(python_recorder* recorder) {
  free(recorder->steps);
  recorder->steps = NULL;
  recorder->count = recorder->capacity = 0;
}

/* x at `count` times, n values each, and x' (NULL: not wanted). Returns the status of the first call that fails. */
static int python_evaluate_solution(const sfdae_solution* solution, const double* times, long count, double* x,
                                    double* xdot, size_t n) {
  long k;
  for (k = 0; k < count; ++k) {
    const size_t place = (size_t)k * n;
    const int status = sfdae_evaluate_solution(solution, times[k], x + place, xdot == NULL ? NULL : xdot + place);
    if (status < 0) return status;
  }
  return SFDAE_OK;
}

/* Limits the steps that are attempted in several calls together, and their time. */
typedef struct python_limit {
  sfdae_options* options; /* of the solver, whose max_steps and max_seconds are set before calls; NULL: no limit */
  long attempts;          /* since the last start, at most */
  long each;              /* in one call, at most */
  double direction;       /* of the integration: +1 or -1 */
  double end;             /* when the calls have to end, by python_seconds(); 0: there is no limit */
} python_limit;

/* Calls sfdae_step or sfdae_advance, as far as the limit allows: SFDAE_MAX_STEPS with the end of the last step else. */
static int python_advance(sfdae_solver* solver, const python_limit* limit, int one_step, double tout, double* t,
                          double* x, double* xdot) {
  if (limit->options != NULL) {
    sfdae_statistics s;
    long rest;
    int status;
    sfdae_statistics_init(&s, sizeof s);
    status = sfdae_get_statistics(solver, &s);
    if (status < 0) return status;
    rest = limit->attempts - (s.steps + s.error_failures + s.other_failures);
    if (rest <= 0 && (tout - s.t_internal) * limit->direction > 0.0) {
      status = sfdae_advance(solver, s.t_internal, t, x, xdot);
      return status == SFDAE_OK || status == SFDAE_INCONSISTENCY_IGNORED ? SFDAE_MAX_STEPS : status;
    }
    if (rest > limit->each) rest = limit->each;
    if (rest <= 0) rest = 1; /* tout lies within the last step: none is attempted */
    if (rest != limit->options->max_steps || limit->end > 0.0) {
      const double left = limit->end - python_seconds();
      limit->options->max_steps = rest;
      if (limit->end > 0.0) limit->options->max_seconds = left > 1e-9 ? left : 1e-9;
      status = sfdae_set_options(solver, limit->options);
      if (status < 0) return status;
    }
  }
  return one_step ? sfdae_step(solver, tout, t, x, xdot) : sfdae_advance(solver, tout, t, x, xdot);
}

/* Calls python_advance for times[*done] ... times[count - 1] and writes t, x and xdot of each. *done: the number of
 * times that have been reached; if these are not all, entry *done is the point where the last call ended. Returns the
 * status of the last call, or a warning of one before. */
static int python_advance_through(sfdae_solver* solver, const python_limit* limit, const double* times, long count,
                                  long* done, double* t, double* x, double* xdot, size_t n) {
  int status = SFDAE_OK, warning = SFDAE_OK;
  for (; *done < count; ++*done) {
    const size_t k = (size_t)*done;
    status = python_advance(solver, limit, 0, times[k], t + k, x + k * n, xdot + k * n);
    if (status != SFDAE_OK && status != SFDAE_INCONSISTENCY_IGNORED) return status;
    if (status != SFDAE_OK) warning = status;
  }
  return warning;
}
