/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - events: zeros of switching functions of t, x and x' along the solution.
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_EVENTS_H
#define SFDAE_EVENTS_H

#ifdef __cplusplus
extern "C" {
#endif

/** Writes the event functions g_i(t, x, x') to g (num_events entries, zero before). Returns 0 (ok), a positive value
 * (cannot evaluate here: SFDAE_CALLBACK_FAILED) or a negative value (stop at once: SFDAE_CALLBACK_STOPPED). */
typedef int (*sfdae_event_function)(double t, const double* x, const double* xdot, double* g, void* user);

/** Sets the event functions. An event happens when a g_i becomes zero or changes its sign. sfdae_advance and sfdae_step
 * then return SFDAE_EVENT with t, x, xdot there: the zero itself or, within rounding errors of t, the first point after
 * it; x satisfies all constraints, and g_i is zero to roundoff. The next call continues; to change x, call sfdae_start
 * at t.
 *
 * num_events: 1 ... 10000, or 0 to remove all events. directions: NULL or num_events numbers, +1 if only rising zeros
 * count (from - to + in the direction of integration), -1 if only falling ones, 0 both. `user` is passed to `function`.
 * Events are located from the point returned last or the next start on. They survive sfdae_start, sfdae_analyze and
 * sfdae_set_options. SFDAE_ILLEGAL_ARGUMENT, also for the solver of a mode of a hybrid system, leaves the events
 * unchanged.
 *
 *  - Events are returned in order of time; events that coincide to roundoff are returned together. Only events up to
 *    tout count, tout included.
 *  - No event is returned twice: after its event a g_i is armed again once it has left zero. A g_i that is zero at the
 *    start (or within rounding errors of it), or after sfdae_start at the point of its event, is armed by its first
 *    nonzero values; a g_i that stays zero, or is dominated by roundoff, has no events.
 *  - Two zeros of one g_i within a step are found if the values of g_i at a few points of the step show a curvature
 *    toward zero in between. A zero without change of sign is found only if g_i is exactly zero at one of these points.
 *    Sign changes of g_i by a jump count as zeros. Changes smaller than the tolerances are not significant. Linear
 *    problems without differential equations (d = 0) go to tout at once: at least 33 points are examined, each with one
 *    reduction. If algebraic variables vary much faster than the others, steps are searched at more points, with one
 *    reduction each; if that is not visible at the examined points, events are missed: limit max_step.
 *  - g_i is evaluated at interpolated values, which may violate constraints slightly; failures there are ignored.
 *    Failures on the solution itself end the call (SFDAE_NOT_FINITE for NaN or Inf).
 *  - If it does not succeed, with SFDAE_STOPPED for example, sfdae_advance returns the point up to which events have
 *    been located. If the monitor stops a step with an event in it, the event is returned instead.
 *  - Checkpoints contain the signs of all g_i, not the functions: set the same number of events before
 *    restoring. */
SFDAE_API int sfdae_set_events(sfdae_solver* solver, int num_events, sfdae_event_function function,
                               const int* directions, void* user);

/** The events at the point that was returned with SFDAE_EVENT: num_events entries, +1 if g_i was rising, -1 if it was
 * falling, else 0. All 0 before the first event and after the integration has continued. */
SFDAE_API int sfdae_get_events(const sfdae_solver* solver, int* which);

/** A switch of recorded equations: a condition became true or false (choose, comparisons, abs, min, max, sign), or a
 * floor, remainder or table of t changed its branch. Switches of recorded equations need no declaration: see
 * expression.h. Floors, remainders and tables of x are not listed. */
typedef struct sfdae_switch {
  size_t size;
  double t;      /**< the zero of the condition: located, or by linear interpolation within the step */
  double before; /**< branch: 1: condition met, 0: not met; integer of a floor or remainder; number of knots passed */
  double after;  /**< the branch after the switch */
  int jumps;     /**< 1: E x jumps there, by impulses (modes.h) */
  int condition; /**< number of the condition, 0, 1, ... in the order of their first switches */
} sfdae_switch;
/** Prepares a result of sfdae_get_switch. size: sizeof(sfdae_switch). */
SFDAE_API int sfdae_switch_init(sfdae_switch* result, size_t size);

/** Number of switches that the integration has passed since sfdae_start, or since a checkpoint was restored. If both
 * branches of a condition lead toward its zero, it switches a few times; then x slides along the surface (see
 * sfdae_report). SFDAE_NOT_STARTED if there is no integration. */
SFDAE_API int sfdae_get_num_switches(const sfdae_solver* solver, long* count);

/** Switch number `index`, 0 ... count - 1, in the order of time, and its condition as text of C in the names t, x, xdot
 * and p (parameters), "sin(t) - x[0] > 0", of at most length characters, final zero included (condition NULL with
 * length 0 is allowed). *needed (may be NULL): length of the whole text + 1. Its cost is proportional to the formulas:
 * request it once for each result->condition. SFDAE_ILLEGAL_ARGUMENT if there is no such switch. */
SFDAE_API int sfdae_get_switch(const sfdae_solver* solver, long index, sfdae_switch* result, char* condition,
                               size_t length, size_t* needed);

#ifdef __cplusplus
}
#endif

#endif
