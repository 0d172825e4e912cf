/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - recorded solution of a whole run (dense output), to be evaluated anywhere, saved and loaded.
 *
 *     sfdae_create_solution(&solution);
 *     sfdae_record_solution(solver, solution);        before or after sfdae_start
 *     sfdae_advance(solver, 10.0, &t, x, NULL);
 *     sfdae_evaluate_solution(solution, 3.5, x, xdot);
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_SOLUTION_H
#define SFDAE_SOLUTION_H

#ifdef __cplusplus
extern "C" {
#endif

/** Polynomials of x, one or more for every step. They agree with what sfdae_interpolate returns for the option output =
 * SFDAE_OUTPUT_INTERPOLATED to a third of the tolerances, about, where the solution is smooth within steps. About 5 n
 * doubles are stored for a step, 9 n or 17 n for long ones; memory is allocated as it grows. */
typedef struct sfdae_solution sfdae_solution;

/** Creates an empty solution. On failure *solution is NULL. */
SFDAE_API int sfdae_create_solution(sfdae_solution** solution);

/** Destroys the solution and sets *solution to NULL; a solver that records it stops recording. NULL is allowed. */
SFDAE_API int sfdae_destroy_solution(sfdae_solution** solution);

/** Records all accepted steps of the solver from now on; NULL: stops recording. The integration itself does not change.
 * Steps that follow those recorded are added. A start within the recorded interval, as after an event, replaces the
 * recording after it: the solution may jump there, and has the value after the jump. Any other start, for example in
 * the other direction, clears the recording first. A solution is recorded by one solver at a time, and is not to be
 * used while that solver is within a call. */
SFDAE_API int sfdae_record_solution(sfdae_solver* solver, sfdae_solution* solution);

/** The recorded range: n, and the times of start and end (end of the last step, which may lie after the last output).
 * Any pointer may be NULL. SFDAE_NOT_STARTED if nothing was recorded. */
SFDAE_API int sfdae_get_solution_range(const sfdae_solution* solution, int* num_unknowns, double* start, double* end);

/** x and x' (NULL: not requested) at any t between start and end: n values each. Constraints hold within the
 * tolerances. x' is the derivative of the polynomial, its error about that of x over the step size. Any number of
 * threads may call it. SFDAE_ILLEGAL_ARGUMENT for other t; SFDAE_NOT_STARTED if nothing was recorded. */
SFDAE_API int sfdae_evaluate_solution(const sfdae_solution* solution, double t, double* x, double* xdot);

/** The largest expected difference from the values of sfdae_interpolate, in tolerances (rtol |x_i| + atol), and the
 * start of its part of a step. Above 1 only if a step has a jump or a kink; 1e300 if a function failed. Either pointer
 * may be NULL. SFDAE_NOT_STARTED if nothing was recorded. */
SFDAE_API int sfdae_get_solution_accuracy(const sfdae_solution* solution, double* accuracy, double* t);

/** Discards the recording after t, for example if an event ended a run within its last step; t = start leaves nothing.
 * Steps recorded later that begin elsewhere clear the recording first. SFDAE_ILLEGAL_ARGUMENT for t that do not lie
 * between start and end; SFDAE_NOT_STARTED if nothing was recorded. */
SFDAE_API int sfdae_cut_solution(sfdae_solution* solution, double t);

/** Number of doubles that sfdae_save_solution writes. */
SFDAE_API int sfdae_get_solution_length(const sfdae_solution* solution, size_t* length);

/** Writes all of the solution to an array of `length` doubles, at least as many as are needed: plain numbers, to be
 * written to a file as they are, or printed with 17 digits. */
SFDAE_API int sfdae_save_solution(const sfdae_solution* solution, double* values, size_t length);

/** Replaces the solution by one that sfdae_save_solution wrote. The numbers are checked, also by a checksum:
 * SFDAE_ILLEGAL_ARGUMENT if they are damaged, truncated or no solution; the solution is then unchanged. */
SFDAE_API int sfdae_load_solution(sfdae_solution* solution, const double* values, size_t length);

#ifdef __cplusplus
}
#endif

#endif
