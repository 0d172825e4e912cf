/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - ensembles: many instances of one recorded problem with different parameters and initial values.
 *
 *     one solver -> sfdae_solve_ensemble: N instances on k threads, outputs of all at the same times
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_ENSEMBLE_H
#define SFDAE_ENSEMBLE_H

#ifdef __cplusplus
extern "C" {
#endif

/** Progress data passed to the monitor of an ensemble. */
typedef struct sfdae_ensemble_progress {
  size_t size;       /**< size of this struct in the calling library */
  int instance;      /**< the instance that has ended, 0 <= instance < num_instances; its results are written */
  int status;        /**< its status */
  int num_ended;     /**< instances that have ended, this one included */
  int num_instances; /**< N */
} sfdae_ensemble_progress;

/** Called when an instance has ended, successfully or not, in the order in which they end, which depends on the
 * threads. The solving threads make the calls, never two at a time. Any value but 0 stops all. */
typedef int (*sfdae_ensemble_monitor_function)(const sfdae_ensemble_progress* progress, void* user);

/** Input of an ensemble of N instances. Call sfdae_ensemble_init first, then set members. Nothing is copied: arrays
 * must live until sfdae_solve_ensemble returns. n: number of unknowns. */
typedef struct sfdae_ensemble {
  size_t size;       /**< set by sfdae_ensemble_init */
  int num_instances; /**< N >= 0 */

  /** Parameters of the recorded equations (sfdae_parameter) that differ between instances. All others have the values
   * of the solver. */
  int num_parameters;                 /**< P >= 0, default 0 */
  const char* const* parameter_names; /**< P names, no two equal */
  const double* parameters;           /**< P x N: column i is for instance i */

  /** Initial values: guesses, made consistent by the options of the solver. */
  double t0;
  const double* x0;    /**< n x N */
  const double* xdot0; /**< NULL (default) or n x N guesses of x', for the option xdot_is_guess */

  /** Output times, strictly increasing or decreasing in the direction of integration. The first one may be t0, where x
   * is the consistent initial value; the last one must not be t0. */
  int num_times; /**< K >= 1 */
  const double* times;

  int num_threads; /**< 1 ... 1024, at most N are used; default 0: the number of processors */

  sfdae_ensemble_monitor_function monitor; /**< NULL: none */
  void* monitor_user;                      /**< passed to the monitor */
} sfdae_ensemble;
/** Sets every member to its default. size: sizeof(sfdae_ensemble). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_ensemble_init(sfdae_ensemble* ensemble, size_t size);

/** Results of an ensemble: arrays that the caller owns, and a summary. Call sfdae_ensemble_results_init first, then set
 * arrays. */
typedef struct sfdae_ensemble_results {
  size_t size;      /**< set by sfdae_ensemble_results_init */
  double* x;        /**< n x K x N: x at times[k] of instance i begins at x[(k + i * K) * n] */
  double* xdot;     /**< NULL (default: x' is not computed), or n x K x N like x */
  int* statuses;    /**< N */
  int* num_outputs; /**< NULL, or N: number of outputs reached, of K; the others are not written */
  char* messages;   /**< NULL, or N texts, each in message_length characters with its final zero: what sfdae_message
                             would say about the status, "" for SFDAE_OK */
  size_t message_length; /**< at least 1 with messages; 1536 are always enough */

  /** Written by the library. */
  int num_failed;   /**< instances with status < 0 */
  int num_analyses; /**< complete index analyses */
  int num_threads;  /**< threads in use, the calling one included */
} sfdae_ensemble_results;
/** Sets every member to its default. size: sizeof(sfdae_ensemble_results). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_ensemble_results_init(sfdae_ensemble_results* results, size_t size);

/** Solves N instances of the problem of a solver, which must be recorded (no callbacks for E, A, f, total derivatives
 * or mechanical systems). Each instance is started at t0 toward the last time and advanced to all times. Its results
 * agree to the last bit with those of a separate solver with the same options and parameters, whatever the number of
 * threads and the other instances. The solver itself is unchanged: its parameters, its analysis, an integration under
 * way.
 *
 *  - Options are those of the solver: tolerances, method, limits (max_steps for each output), initial values with
 *    fixed components and weights. Only its monitor is not called.
 *  - Status of an instance: SFDAE_OK, its first warning, or the failure that ended it, of sfdae_start or
 *    sfdae_advance; SFDAE_ILLEGAL_ARGUMENT for parameters or start values that are not finite. Outputs before a failure
 *    remain valid. A failed instance does not affect the others.
 *  - Events are not supported: SFDAE_ILLEGAL_ARGUMENT if the solver has any.
 *  - Prescribed values (sfdae_nonlinear_problem.prescribed_values) are requested by several threads at once, with the
 *    same `user`. A nonzero return value ends its instance only.
 *  - sfdae_request_stop(solver) and the monitor stop all: SFDAE_STOPPED. Instances under way keep their outputs, those
 *    not started have none; both have the status SFDAE_STOPPED.
 *  - The recording is shared. The index analysis of the solver, or else of the first analyzed instance, is reused for
 *    an instance if its ranks at the start are clearly the same; else the instance is analyzed completely.
 *  - If threads cannot be created, fewer are used; the calling thread is one of them.
 *  - BLAS should use one thread: set OPENBLAS_NUM_THREADS=1 (or the equivalent of your BLAS) before the program starts.
 *    Otherwise each of the k threads starts BLAS threads, which is slower, and results of large problems may depend on
 *    their number.
 *
 * Warnings: SFDAE_INSTANCES_FAILED; sfdae_message then names the first one that failed, and why. Failures:
 * SFDAE_ILLEGAL_ARGUMENT; SFDAE_OUT_OF_MEMORY if no instance could be started. After these nothing is written. */
SFDAE_API int sfdae_solve_ensemble(sfdae_solver* solver, const sfdae_ensemble* ensemble,
                                   sfdae_ensemble_results* results);

#ifdef __cplusplus
}
#endif

#endif
