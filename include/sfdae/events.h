/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - events: zeros of functions of t, x and x' along the solution.
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

/** Sets the event functions. An event happens where a g_i becomes zero or changes its sign. sfdae_advance and
 * sfdae_step then return SFDAE_EVENT with t, x, xdot there: the zero itself or, within rounding errors of t, the
 * first point after it; x satisfies all constraints, and g_i is as small as rounding allows. Called again they go
 * on; to change x, call sfdae_start at t.
 *
 * num_events: 1 ... 10000, or 0 to have no events any more. directions: NULL or num_events numbers, +1 if only
 * rising zeros count (from - to + in the direction of integration), -1 if only falling ones, 0 both. `user` is
 * handed to `function`. Events are searched from the point returned last or the next start on. They survive
 * sfdae_start, sfdae_analyze and sfdae_set_options. SFDAE_ILLEGAL_ARGUMENT, also for the solver of a mode of a hybrid
 * system, leaves the events as they were.
 *
 *  - Events are returned in their order; those that are one but for rounding errors together. Only events up to
 *    tout count, tout included.
 *  - Nothing happens twice: after its event a g_i is armed again once it has left zero. Where it is zero at the
 *    start (a zero within rounding errors of the start counts as such), or after sfdae_start at the point of its
 *    event, it is armed by its first values that are not; where it stays zero, or is nothing but rounding errors,
 *    it is silent.
 *  - Two zeros of one g_i within a step are found where the values of g_i at a few points of the step show that it
 *    bends toward zero in between. A zero without change of sign is found only if g_i is exactly zero at one of
 *    these points. Jumps of g_i count as zeros. Movements smaller than the tolerances mean nothing. Linear
 *    problems without differential equations (d = 0) go to tout at once: at least 33 points are examined, each with
 *    one reduction. Where algebraic components vary much faster than the others, steps are searched at more points,
 *    with one reduction each; where a step hides that at the points looked at, events are missed: limit max_step.
 *  - g_i is evaluated at values with the accuracy of interpolation, which may violate constraints slightly;
 *    failures there do no harm. Failures on the solution itself end the call (SFDAE_NOT_FINITE for NaN or Inf).
 *  - Without success, with SFDAE_STOPPED for example, sfdae_advance returns the point up to which events have been
 *    searched. If the monitor stops a step with an event in it, the event is returned instead.
 *  - Checkpoints contain the signs of all g_i, not the functions: set the same number of events before
 *    restoring. */
SFDAE_API int sfdae_set_events(sfdae_solver* solver, int num_events, sfdae_event_function function,
                               const int* directions, void* user);

/** Which events happened at the point that was returned with SFDAE_EVENT: num_events entries, +1 where g_i was
 * rising, -1 where it was falling, else 0. All 0 before the first event and when the integration has gone on. */
SFDAE_API int sfdae_get_events(const sfdae_solver* solver, int* which);

/** A switch of recorded equations: a condition was met or no longer met (choose, comparisons, abs, min, max, sign), or
 * a floor, remainder or table of t came to another branch. Equations switch without being declared: see expression.h.
 * Floors, remainders and tables of x are not listed. */
typedef struct sfdae_switch {
  size_t size;
  double t;      /**< the zero of the condition: located, or where a line within the step leads through it */
  double before; /**< branch: 1: condition met, 0: not met; integer of a floor or remainder; number of knots passed */
  double after;  /**< the branch after the switch */
  int jumps;     /**< 1: E x jumps there, by impulses (modes.h) */
  int condition; /**< a number of the condition, 0, 1, ... in the order in which they switch first */
} sfdae_switch;
/** Prepares a result of sfdae_get_switch. size: sizeof(sfdae_switch). */
SFDAE_API int sfdae_switch_init(sfdae_switch* result, size_t size);

/** How many switches the integration has passed since sfdae_start, or since a checkpoint was restored. A
 * condition both sides of which lead toward its zero switches a few times; then x moves along the surface, which
 * sfdae_report says. SFDAE_NOT_STARTED if there is no integration. */
SFDAE_API int sfdae_get_num_switches(const sfdae_solver* solver, long* count);

/** Switch number `index`, 0 ... count - 1, in the order of time, and its condition as text of C in the names t, x, xdot
 * and p (parameters), "sin(t) - x[0] > 0", of at most length characters, final zero included (condition NULL with
 * length 0 is allowed). *needed (may be NULL): length of the whole text + 1. The text takes time in proportion
 * to the formulas: ask for it once for each result->condition. SFDAE_ILLEGAL_ARGUMENT if there is no such switch. */
SFDAE_API int sfdae_get_switch(const sfdae_solver* solver, long index, sfdae_switch* result, char* condition,
                               size_t length, size_t* needed);

#ifdef __cplusplus
}
#endif

#endif
