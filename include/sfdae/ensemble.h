/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - ensembles: many instances of one recorded problem, which differ in parameters and start values.
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

/** What is reported to the monitor of an ensemble. */
typedef struct sfdae_ensemble_progress {
  size_t size;       /**< of this struct in the library that calls */
  int instance;      /**< the one that has ended, 0 <= instance < num_instances; its results are written */
  int status;        /**< its status */
  int num_ended;     /**< instances that have ended, this one included */
  int num_instances; /**< N */
} sfdae_ensemble_progress;

/** Called whenever an instance has ended, with success or without, in the order in which they end, which depends on
 * the threads. Calls come from the threads that solve, but never two at a time. Any value but 0 stops all. */
typedef int (*sfdae_ensemble_monitor_function)(const sfdae_ensemble_progress* progress, void* user);

/** What is to be solved: N instances. Call sfdae_ensemble_init first, then set members. Nothing is copied: arrays must
 * live until sfdae_solve_ensemble returns. n: number of unknowns. */
typedef struct sfdae_ensemble {
  size_t size;       /**< set by sfdae_ensemble_init */
  int num_instances; /**< N >= 0 */

  /** Parameters of the recorded equations (sfdae_parameter) that differ between instances. All others have the values
   * that they have in the solver. */
  int num_parameters;                 /**< P >= 0, default 0 */
  const char* const* parameter_names; /**< P names, no two equal */
  const double* parameters;           /**< P x N: column i is for instance i */

  /** Start values: guesses, made consistent as the options of the solver say. */
  double t0;
  const double* x0;    /**< n x N */
  const double* xdot0; /**< NULL (default) or n x N guesses of x', for the option xdot_is_guess */

  /** Outputs, in the direction of integration: either increasing or decreasing, each beyond the one before. The first
   * one may be t0, where x is the consistent start value; the last one must not. */
  int num_times; /**< K >= 1 */
  const double* times;

  int num_threads; /**< 1 ... 1024, never more than N are used; default 0: as many as there are processors */

  sfdae_ensemble_monitor_function monitor; /**< NULL: none */
  void* monitor_user;                      /**< handed to the monitor */
} sfdae_ensemble;
/** Sets every member to its default. size: sizeof(sfdae_ensemble). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_ensemble_init(sfdae_ensemble* ensemble, size_t size);

/** Where results go, arrays of the user's, and a summary. Call sfdae_ensemble_results_init first, then set arrays. */
typedef struct sfdae_ensemble_results {
  size_t size;      /**< set by sfdae_ensemble_results_init */
  double* x;        /**< n x K x N: x at times[k] of instance i begins at x[(k + i * K) * n] */
  double* xdot;     /**< NULL (default: x' is not computed), or n x K x N like x */
  int* statuses;    /**< N */
  int* num_outputs; /**< NULL, or N: how many of the K outputs were reached; the others are not written */
  char* messages;   /**< NULL, or N texts, each in message_length characters with its final zero: what sfdae_message
                             would say about the status, "" for SFDAE_OK */
  size_t message_length; /**< at least 1 with messages; 1536 are always enough */

  /** Written by the library. */
  int num_failed;   /**< instances with status < 0 */
  int num_analyses; /**< index analyses that were made from the beginning */
  int num_threads;  /**< that were there to take part */
} sfdae_ensemble_results;
/** Sets every member to its default. size: sizeof(sfdae_ensemble_results). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_ensemble_results_init(sfdae_ensemble_results* results, size_t size);

/** Solves N instances of the problem of a solver, which must have been recorded (not callbacks for E, A, f, total
 * derivatives or mechanical systems). Each is started at t0 toward the last time and advanced to all times. The
 * results of an instance are to the last bit those of a solver of its own with the same options and parameters,
 * whatever the number of threads and whatever the others do. The solver itself stays as it is: its parameters, its
 * analysis, an integration under way.
 *
 *  - Options are those of the solver: tolerances, method, limits (max_steps for each output), initial values with
 *    fixed components and weights. Only its monitor, which could not know of instances, is not called.
 *  - Status of an instance: SFDAE_OK, its first warning, or the failure that ended it, of sfdae_start or
 *    sfdae_advance; SFDAE_ILLEGAL_ARGUMENT for parameters or start values that are not finite. Outputs before a
 *    failure are kept. One that fails does not disturb the others.
 *  - Events are not supported: SFDAE_ILLEGAL_ARGUMENT if the solver has some.
 *  - Prescribed values (sfdae_nonlinear_problem.prescribed_values) are asked for by several threads at once, with the
 *    same `user`. What they return ends their instance only.
 *  - sfdae_request_stop(solver) and the monitor stop all: SFDAE_STOPPED. Instances under way keep their outputs,
 *    those that were not begun have none; both have the status SFDAE_STOPPED.
 *  - The recording is shared. The index analysis of the solver, or else of the first instance that has one, is a
 *    precedent: where an instance has the same ranks at its start, clearly, it is not analyzed any further; else its
 *    analysis is made anew.
 *  - Where threads cannot be made, fewer do the work; the calling thread is one of them.
 *  - BLAS should use one thread: set OPENBLAS_NUM_THREADS=1 (or what your BLAS has for that) before the program
 *    starts. Else k threads start as many each, which is slower, and results of large problems may depend on their
 *    number.
 *
 * Warnings: SFDAE_INSTANCES_FAILED; sfdae_message then names the first one that failed, and why. Failures:
 * SFDAE_ILLEGAL_ARGUMENT; SFDAE_OUT_OF_MEMORY if no instance could be begun. After these nothing is written. */
SFDAE_API int sfdae_solve_ensemble(sfdae_solver* solver, const sfdae_ensemble* ensemble,
                                   sfdae_ensemble_results* results);

#ifdef __cplusplus
}
#endif

#endif
