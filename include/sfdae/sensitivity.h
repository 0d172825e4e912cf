/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - sensitivities: derivatives S = dx/dp of the solution by parameters of recorded equations and by start values.
 *
 *     create -> sfdae_set_sensitivities -> sfdae_start -> sfdae_advance -> sfdae_get_sensitivities ...
 *
 * Forward, S goes along with x: for few parameters, or where S itself is wanted. With the adjoint, steps are kept,
 * and read backward when gradients of functionals of x are asked for: for many parameters.
 *
 *     create -> sfdae_set_sensitivities (adjoint = 1) -> sfdae_start -> sfdae_advance ... -> sfdae_get_gradient
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_SENSITIVITY_H
#define SFDAE_SENSITIVITY_H

#ifdef __cplusplus
extern "C" {
#endif

/** How sensitivities are computed. Call sfdae_sensitivity_options_init first. */
typedef struct sfdae_sensitivity_options {
  size_t size;          /**< set by sfdae_sensitivity_options_init */
  int error_test;       /**< 0 (default): steps are chosen for x alone. 1: for S as well */
  const double* scales; /**< of the error test: NULL (all 1), or one positive number for each parameter, its typical
                             size: S_ij has the tolerance rtol |S_ij| + atol_i / scales[j] */
  int adjoint; /**< 0 (default): S goes along with x. 1: steps are kept for sfdae_get_gradient, and S is not computed */
  long
      max_kept_steps; /**< with the adjoint: 0 (default): all steps are kept. 2 ...: at most so many at a time; earlier
                            ones are computed again, from checkpoints, for each gradient */
} sfdae_sensitivity_options;
/** Sets every member to its default. size: sizeof(sfdae_sensitivity_options). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_sensitivity_options_init(sfdae_sensitivity_options* options, size_t size);

/** Work for the sensitivities of the integration under way, beside that for x. */
typedef struct sfdae_sensitivity_statistics {
  size_t size;              /**< set by sfdae_sensitivity_statistics_init */
  int count;                /**< of sensitivities; 0: none are computed */
  long linearizations;      /**< derivative arrays that were linearized along x and eliminated */
  long factorizations;      /**< matrices of steps, each for all parameters */
  long error_test_failures; /**< steps repeated for the errors of S */
  long outputs;             /**< points for which they were asked */
  long kept_steps;          /**< with the adjoint: steps that are kept, */
  double kept_bytes;        /**< and how much memory that and checkpoints take, about */
  long checkpoints;         /**< with max_kept_steps: of earlier pieces of the integration, */
  long repeated_steps; /**< and steps that were computed again for gradients; in sfdae_statistics they do not count */
} sfdae_sensitivity_statistics;
/** Prepares a result. size: sizeof(sfdae_sensitivity_statistics). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_sensitivity_statistics_init(sfdae_sensitivity_statistics* statistics, size_t size);

/** Asks for `count` sensitivities S_j = dx/dp_j, 0 (none any more) ... 10000, from the next sfdae_start on. An
 * integration under way ends; the analysis is kept where it serves.
 *
 * parameters: `count` names of parameters of the recorded equations (sfdae_parameter), or NULL for those p_j that are
 * in start values only; NULL for all of them. directions: NULL (zero), or n x count numbers, column j the derivative
 * by p_j of the guess of x that sfdae_start is given. Thus S = dx/dx0_i has no name, and the i-th unit vector as
 * direction. options: NULL for the defaults. Everything is copied.
 *
 *  - Start values: S(t0) is the derivative of the consistent point that is nearest as the option initial_values says,
 *    with fixed components and weights, else in units of the tolerances, for guesses near the consistent x that the
 *    start has found. (Changes as small as the last of six digits follow values instead: differences of starts have
 *    to be larger.) So S fulfils the linearized constraints, hidden ones too, there and at all outputs.
 *  - The equations of S have the strangeness index, the matrices and the strangeness-free form of the linearized
 *    equations; they are discretized as x is (BDF and Radau) after each step, with exact derivatives F_x', F_x and F_p.
 *    Their errors are about those of x, relative, without a test of their own unless the options ask for one.
 *  - Matrices are sparse where they would be for x alone, as the option structure says, but for the adjoint,
 *    mechanical systems and equations that are replaced where structure misleads: these have dense ones, of at most
 *    5000 unknowns, and SFDAE_STRUCTURE_REQUIRED is refused by the analysis. Linear recorded equations are solved as
 *    nonlinear ones, mechanical systems (sfdae_multibody_problem) by their first-order equations: x takes more time
 *    then. S(t0) of these is nearest with the weights of the options, not in kinetic energy; directions that fulfil
 *    the linearized constraints stay.
 *  - Where an event only ends a call, S goes on. Where x, its equations or parameters change there, start anew with the
 *    directions of the new branch: see sfdae_get_event_sensitivities.
 *  - They are in checkpoints: ask a solver that is to restore one for the same parameters in the same order first;
 *    directions and options are its own. With the adjoint checkpoints are refused. They are in no ensembles and
 *    recorded solutions (sfdae_solution).
 *
 * SFDAE_ILLEGAL_ARGUMENT: equations that are not recorded, names that no parameter has, numbers that are not finite.
 * sfdae_start fails with SFDAE_ILLEGAL_ARGUMENT where components are prescribed or u > 0 (redundant constraints of
 * mechanical systems), with SFDAE_FIXED_VALUES where fixed components or directions cannot follow, with
 * SFDAE_INCONSISTENT_EQUATIONS where redundant equations contradict each other once a parameter changes. */
SFDAE_API int sfdae_set_sensitivities(sfdae_solver* solver, int count, const char* const* parameters,
                                      const double* directions, const sfdae_sensitivity_options* options);

/** S and S' at t, which is the start, where the last call has returned, or any other point within the last step. S: n x
 * count, column j for p_j. Sdot: NULL, or n x count, from the derivative array as x' is. S fulfils the constraints,
 * hidden ones included, to rounding. With Radau, points within a step cost about as much as the step.
 * SFDAE_NOT_STARTED: there is no integration, or none with sensitivities. */
SFDAE_API int sfdae_get_sensitivities(sfdae_solver* solver, double t, double* S, double* Sdot);

/** dt[j] = dt_e/dp_j of an event g(t, x, p) = 0 at t, where sfdae_advance has returned SFDAE_EVENT:
 *
 *     dt_e/dp_j = -(g_x S_j + g_pj) / (g_t + g_x x')
 *
 * g_t: the partial derivative by t; g_x: n numbers; g_p: NULL (zero) or `count` numbers. Where x then jumps to h(t,
 * x, p), the directions for the new start are (h_x S_j + h_pj) + (h_t + h_x x'_before - x'_after) dt_e/dp_j. Failures:
 * SFDAE_NOT_STARTED; SFDAE_SINGULAR if g does not move through zero with t. */
SFDAE_API int sfdae_get_event_sensitivities(sfdae_solver* solver, double t, double g_t, const double* g_x,
                                            const double* g_p, double* dt);

/** Gradients of functionals of the solution, with the option adjoint. A functional is a function of the values of x
 * at `num_times` points in time; its weights there, the derivatives by x(t_k), n numbers w_k for each point, give its
 * gradient
 *
 *     gradient[j] = sum_k w_k^T dx(t_k)/dp_j,   j = 0 ... count - 1,
 *
 * to which derivatives by p_j at fixed x are to be added. An integral is the value at the end of an unknown whose
 * derivative is the integrand: append it to the equations.
 *
 * t: `num_times` points (1 ...), in any order, from the start to the end of the last step, which may lie behind the
 * point returned last: those that sfdae_advance has gone to, where steps end, and any others. weights: n x num_times
 * for each of `num_functionals` functionals (1 ...), one after the other. gradient: count x num_functionals.
 *
 * It is the exact gradient of what the steps have computed, hidden constraints and consistent start values included
 * (sfdae_set_sensitivities says which), for the steps as they are. All of them are kept: about 8 n (mu + 3) bytes
 * each, with Radau for each stage. A gradient costs one elimination of the derivative array and one transposed
 * solution for each point kept, whatever the number of parameters, and can be asked for again with other weights.
 *
 * Points within a step, events among them, are what S is there, as sfdae_get_sensitivities has it: with BDF the
 * polynomial through the last points, made consistent; with Radau the end of a shorter step, whose stages are solved
 * for once more. Such a point costs about as much as three steps of BDF, or one of Radau. (With Radau x there is the
 * end of that step, not that of the output: both are the same within the tolerances.)
 *
 * With the option max_kept_steps steps are kept of the end of the integration alone, at most two thirds of that
 * number; of earlier pieces of it, a third long, there is a checkpoint each, about as large as ten steps, and some 30
 * bytes for each step. (Pieces are not shorter than those ten steps.) sfdae_get_gradient makes their steps again, one
 * piece at a time, without events, monitor and outputs, on a copy of the equations: the gradient is the same to the
 * last bit, and costs one more integration at most. Memory is least with about five times the square root of the
 * number of steps. Functions that the equations call (sfdae_external) are called again, and have to return what they
 * have returned.
 *
 * SFDAE_NOT_STARTED: there is no integration, or none with the adjoint. SFDAE_ILLEGAL_ARGUMENT names a time that no
 * step has led to, SFDAE_NO_CONSISTENT_VALUES one within a step whose equations have no solution,
 * SFDAE_CHARACTERISTICS_CHANGED or SFDAE_SINGULAR one where the characteristic values do not hold, an isolated point.
 * SFDAE_CALLBACK_FAILED: such functions return other values than before. */
SFDAE_API int sfdae_get_gradient(sfdae_solver* solver, int num_times, const double* t, int num_functionals,
                                 const double* weights, double* gradient);

/** Fills the struct, which was prepared with its init function. */
SFDAE_API int sfdae_get_sensitivity_statistics(const sfdae_solver* solver, sfdae_sensitivity_statistics* statistics);

#ifdef __cplusplus
}
#endif

#endif
