/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - sensitivities: derivatives S = dx/dp of the solution with respect to parameters of recorded equations and
 * initial values.
 *
 *     create -> sfdae_set_sensitivities -> sfdae_start -> sfdae_advance -> sfdae_get_sensitivities ...
 *
 * Forward sensitivities S are integrated with x: for few parameters, or if S itself is needed. The adjoint stores steps
 * and processes them backward when gradients of functionals of x are requested: for many parameters.
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
  int error_test;       /**< 0 (default): x alone is in the error test. 1: S as well */
  const double* scales; /**< of the error test: NULL (all 1), or one positive number for each parameter, its typical
                             size: S_ij has the tolerance rtol |S_ij| + atol_i / scales[j] */
  int adjoint;          /**< 0 (default): S is integrated with x. 1: steps are stored for sfdae_get_gradient; no S */
  long max_kept_steps; /**< with the adjoint: 0 (default): all steps are stored. 2 ...: at most this number at a time;
                         earlier ones are recomputed, from checkpoints, for each gradient */
} sfdae_sensitivity_options;
/** Sets every member to its default. size: sizeof(sfdae_sensitivity_options). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_sensitivity_options_init(sfdae_sensitivity_options* options, size_t size);

/** Work for the sensitivities of the integration under way, in addition to that for x. */
typedef struct sfdae_sensitivity_statistics {
  size_t size;              /**< set by sfdae_sensitivity_statistics_init */
  int count;                /**< of sensitivities; 0: none are computed */
  long linearizations;      /**< derivative arrays that were linearized along x and eliminated */
  long factorizations;      /**< matrices of steps, each for all parameters */
  long error_test_failures; /**< steps repeated for the errors of S */
  long outputs;             /**< points at which they were requested */
  long kept_steps;          /**< with the adjoint: steps that are stored, */
  double kept_bytes;        /**< and how much memory that and checkpoints take, about */
  long checkpoints;         /**< with max_kept_steps: of earlier pieces of the integration, */
  long repeated_steps;      /**< and steps recomputed for gradients; not counted in sfdae_statistics */
} sfdae_sensitivity_statistics;
/** Prepares a result. size: sizeof(sfdae_sensitivity_statistics). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_sensitivity_statistics_init(sfdae_sensitivity_statistics* statistics, size_t size);

/** Requests `count` sensitivities S_j = dx/dp_j, 0 (none) ... 10000, from the next sfdae_start on. An integration under
 * way ends; the analysis is reused if possible.
 *
 * parameters: `count` names of parameters of the recorded equations (sfdae_parameter), or NULL for those p_j that are
 * in initial values only; NULL for all of them. directions: NULL (zero), or n x count numbers, column j the derivative
 * with respect to p_j of the initial guess of x passed to sfdae_start. Thus S = dx/dx0_i has no name, and the i-th unit
 * vector as direction. options: NULL for the defaults. Everything is copied.
 *
 *  - Initial values: S(t0) is the derivative of the nearest consistent point by the option initial_values, with fixed
 *    components and weights, else in units of the tolerances, for guesses near the consistent x of the start. (Changes
 *    in the sixth digit or below behave differently: finite differences of starts have to be larger.) So S satisfies
 *    the linearized constraints, hidden ones too, there and at all outputs.
 *  - The equations of S have the strangeness index, the matrices and the strangeness-free form of the linearized
 *    equations; they are discretized like x (BDF and Radau) after each step, with exact derivatives F_x', F_x and F_p.
 *    Their relative errors are about those of x; they are tested only with the option error_test.
 *  - Matrices are sparse if they would be for x alone (option structure), except for the adjoint, mechanical systems
 *    and equations replaced for structural analysis: these have dense ones, at most 5000 unknowns, and the analysis
 *    refuses SFDAE_STRUCTURE_REQUIRED. Linear recorded equations are solved as nonlinear ones, mechanical systems
 *    (sfdae_multibody_problem) by their first-order equations: x takes more time then. S(t0) of these is nearest with
 *    the weights of the options, not in kinetic energy; directions that satisfy the linearized constraints do not
 *    change.
 *  - If an event only ends a call, S continues. If x, its equations or parameters change there, restart with the
 *    directions of the new branch: see sfdae_get_event_sensitivities.
 *  - Checkpoints contain sensitivities: before restoring, request the same parameters in the same order; the restoring
 *    solver keeps its own directions and options. With the adjoint checkpoints are refused. Ensembles and recorded
 *    solutions (sfdae_solution) contain no sensitivities.
 *
 * SFDAE_ILLEGAL_ARGUMENT: equations that are not recorded, unknown parameter names, numbers that are not finite.
 * sfdae_start fails with SFDAE_ILLEGAL_ARGUMENT if components are prescribed or u > 0 (redundant constraints of
 * mechanical systems), with SFDAE_FIXED_VALUES if fixed components or directions cannot be satisfied, with
 * SFDAE_INCONSISTENT_EQUATIONS if redundant equations contradict each other once a parameter changes. */
SFDAE_API int sfdae_set_sensitivities(sfdae_solver* solver, int count, const char* const* parameters,
                                      const double* directions, const sfdae_sensitivity_options* options);

/** S and S' at t: the start, the point returned last, or any other point within the last step. S: n x count, column j
 * for p_j. Sdot: NULL, or n x count, from the derivative array like x'. S satisfies the linearized constraints, hidden
 * ones included, to roundoff. With Radau, points within a step cost about as much as the step. SFDAE_NOT_STARTED: there
 * is no integration, or none with sensitivities. */
SFDAE_API int sfdae_get_sensitivities(sfdae_solver* solver, double t, double* S, double* Sdot);

/** dt[j] = dt_e/dp_j of an event g(t, x, p) = 0 at t, where sfdae_advance has returned SFDAE_EVENT:
 *
 *     dt_e/dp_j = -(g_x S_j + g_pj) / (g_t + g_x x')
 *
 * g_t: the partial derivative with respect to t; g_x: n numbers; g_p: NULL (zero) or `count` numbers. If x then jumps
 * to h(t, x, p), the directions for the new start are (h_x S_j + h_pj) + (h_t + h_x x'_before - x'_after) dt_e/dp_j.
 * Failures: SFDAE_NOT_STARTED; SFDAE_SINGULAR if g does not pass through zero with t. */
SFDAE_API int sfdae_get_event_sensitivities(sfdae_solver* solver, double t, double g_t, const double* g_x,
                                            const double* g_p, double* dt);

/** Gradients of functionals of the solution, with the option adjoint. A functional is a function of the values of x
 * at `num_times` points in time; its weights there, the derivatives with respect to x(t_k), n numbers w_k for each
 * point, give its gradient
 *
 *     gradient[j] = sum_k w_k^T dx(t_k)/dp_j,   j = 0 ... count - 1,
 *
 * to which derivatives with respect to p_j at fixed x are to be added. An integral is the value at the end of an
 * unknown whose derivative is the integrand: append it to the equations.
 *
 * t: `num_times` points (1 ...), in any order, from the start to the end of the last step, which may lie after the
 * point returned last: outputs of sfdae_advance, ends of steps, and any others. weights: n x num_times for each of
 * `num_functionals` functionals (1 ...), one after the other. gradient: count x num_functionals.
 *
 * It is the exact (discrete adjoint) gradient of the computed solution, hidden constraints and consistent initial
 * values included (see sfdae_set_sensitivities), for fixed steps. All steps are stored: about 8 n (mu + 3) bytes each,
 * with Radau for each stage. A gradient costs one elimination of the derivative array and one transposed solution for
 * each stored point, whatever the number of parameters, and can be requested again with other weights.
 *
 * Within a step, also at events, the gradient is that of S of sfdae_get_sensitivities: with BDF the polynomial through
 * the last points, made consistent; with Radau the end of a shorter step, whose stages are solved again. Such a point
 * costs about as much as three steps of BDF, or one of Radau. (With Radau x there is the end of that step, not that of
 * the output: both are the same within the tolerances.)
 *
 * With the option max_kept_steps only the steps at the end of the integration are stored, at most two thirds of that
 * number; each earlier piece, a third long, has a checkpoint, about as large as ten steps, and some 30 bytes for each
 * step. (Pieces are not shorter than ten steps.) sfdae_get_gradient recomputes their steps, one piece at a time,
 * without events, monitor and outputs, on a copy of the equations: the gradient is the same to the last bit, and costs
 * one more integration at most. Memory is smallest with about five times the square root of the number of steps.
 * Functions that the equations call (sfdae_external) are called again, and have to return the same values.
 *
 * SFDAE_NOT_STARTED: there is no integration, or none with the adjoint. The message names the time:
 * SFDAE_ILLEGAL_ARGUMENT for one outside of all steps, SFDAE_NO_CONSISTENT_VALUES for one within a step whose equations
 * have no solution, SFDAE_CHARACTERISTICS_CHANGED or SFDAE_SINGULAR for an isolated one at which the characteristic
 * values do not hold. SFDAE_CALLBACK_FAILED: such functions return other values than before. */
SFDAE_API int sfdae_get_gradient(sfdae_solver* solver, int num_times, const double* t, int num_functionals,
                                 const double* weights, double* gradient);

/** Fills the struct, which was prepared with its init function. */
SFDAE_API int sfdae_get_sensitivity_statistics(const sfdae_solver* solver, sfdae_sensitivity_statistics* statistics);

#ifdef __cplusplus
}
#endif

#endif
