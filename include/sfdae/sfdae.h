/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - initial value problems for differential-algebraic equations of arbitrary index.
 *
 *     F(t, x(t), x'(t)) = 0   or   E(t) x'(t) = A(t) x(t) + f(t),   m equations, n unknowns, any index.
 *
 * Life cycle:   fill a problem -> create -> (analyze) -> start -> advance ... advance -> destroy
 *
 * The library finds the strangeness index mu (differentiation index mu + 1) and the characteristic values d, a, u, v
 * from the derivative array, replaces the problem at every point by an equivalent strangeness-free (index-reduced)
 * system, makes the initial values consistent, and integrates with BDF of orders 1 to 5 or Radau IIA of orders 1 to 13.
 * Theory: P. Kunkel, V. Mehrmann, Differential-Algebraic Equations: Analysis and Numerical Solution, EMS, 2006. The
 * notation follows that book: E, A, f, mu, d, a, u, v, M, N, g, Z1, Z2, Z3, T2.
 *
 * This header has the life cycle, options, linear problems, integration and inspection. It includes: sfdae/events.h,
 * sfdae/expression.h for equations written as formulas and nonlinear problems, sfdae/multibody.h for mechanical
 * systems, sfdae/ensemble.h for many instances of a problem, sfdae/sensitivity.h for derivatives of the solution with
 * respect to parameters, sfdae/solution.h for the solution over a whole run, sfdae/linearization.h for poles, zeros and
 * transfer functions at a point.
 *
 * Conventions
 *  - Matrices are column-major without padding: entry (i, j) of an m x n matrix is a[i + j * m]. Indices count from
 *    0. Vectors of unknowns have n entries. Times and values have the user's units.
 *  - Functions return a status: SFDAE_OK, a warning (> 0) or a failure (< 0). sfdae_message() explains it in words.
 *    The documentation names failures by group: callbacks, structure, values, integration. Any function may also return
 *    SFDAE_ILLEGAL_ARGUMENT, SFDAE_OUT_OF_MEMORY, SFDAE_BUSY or SFDAE_INTERNAL, and any that calls callbacks
 *    SFDAE_STOPPED, after which outputs and solver are as after a failure.
 *  - After a failure outputs are untouched, except where stated (sfdae_advance, sfdae_step). A call refused with
 *    SFDAE_ILLEGAL_ARGUMENT changes nothing: an integration under way continues. After SFDAE_OUT_OF_MEMORY the solver
 *    is still usable: the call may be repeated, and so may any other.
 *  - Structs begin with their size. Call the init function of a struct before anything else, with sizeof(struct) in
 *    your program: later versions of the library may have more members.
 *  - The library copies all data that it stores. Only the callbacks and the object that `user` points to must live as
 *    long as the solver.
 *  - The library never prints, exits, installs signal handlers or changes the number of BLAS threads. Small
 *    matrices run fastest with one BLAS thread (OPENBLAS_NUM_THREADS=1): parallelize over problems.
 *  - Different solvers are independent. One solver belongs to one thread at a time; only sfdae_request_stop() may
 *    be called from anywhere. A call on a solver from its own callbacks returns SFDAE_BUSY, except sfdae_request_stop
 *    and the functions that only read (those with a const solver).
 */
#ifndef SFDAE_SFDAE_H
#define SFDAE_SFDAE_H

#include <stddef.h>

#define SFDAE_VERSION_MAJOR 0
#define SFDAE_VERSION_MINOR 2
#define SFDAE_VERSION_PATCH 0

#if defined(_WIN32) || !defined(__GNUC__)
#define SFDAE_API
#else
#define SFDAE_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Status ---------------------------------------------------------------------------------- */

#define SFDAE_OK 0

/* Warnings: the call completed with a restriction. */
#define SFDAE_STEP_TAKEN 1            /**< sfdae_step: one step taken, tout not reached yet */
#define SFDAE_STOPPED 2               /**< the monitor or sfdae_request_stop stopped the call; it can be repeated */
#define SFDAE_NOT_UNIQUE 3            /**< u > 0: the free part of the solution is held constant */
#define SFDAE_INCONSISTENCY_IGNORED 4 /**< redundant equations contradict each other; ignored by option */
#define SFDAE_EVENT 5                 /**< an event: sfdae_get_events reports which */
#define SFDAE_VALUES_CHANGED 6   /**< initial values of differential variables were adjusted, beyond tolerances */
#define SFDAE_INSTANCES_FAILED 7 /**< sfdae_solve_ensemble: some instances failed, see their statuses */

/* Failures: wrong use. */
#define SFDAE_ILLEGAL_ARGUMENT (-1)
#define SFDAE_OUT_OF_MEMORY (-2)
#define SFDAE_BUSY (-3)          /**< called from within a callback of the same solver */
#define SFDAE_EMPTY_PROBLEM (-4) /**< no equations or no unknowns */
#define SFDAE_NOT_STARTED (-5)   /**< sfdae_start (or sfdae_analyze) has to come first */

/* Failures: callbacks. */
#define SFDAE_CALLBACK_STOPPED (-10) /**< a callback returned a negative value */
#define SFDAE_CALLBACK_FAILED (-11)  /**< a callback returned a positive value and a smaller step did not help */
#define SFDAE_NOT_FINITE (-12)       /**< a callback returned NaN or Inf and a smaller step did not help */
#define SFDAE_ORDER_MISSING (-13)    /**< a derivative that is needed is not available */
/** A derivative contradicts its function (option check_derivatives), or others in a derivative array. */
#define SFDAE_WRONG_DERIVATIVES (-14)
#define SFDAE_WRONG_PATTERN (-15) /**< an entry of a matrix is not zero, and not in its sparsity pattern */

/* Failures: structure of the problem. */
#define SFDAE_INDEX_TOO_HIGH (-20)          /**< the hypothesis holds at no level up to max_index */
#define SFDAE_RANK_UNCLEAR (-21)            /**< a rank decision is not clear: the data do not determine the index */
#define SFDAE_CHARACTERISTICS_CHANGED (-22) /**< characteristic values change: sfdae_get_change */
#define SFDAE_PRESCRIPTION_SINGULAR (-23)   /**< the prescribed components do not fit the free part of the solution */

/* Failures: values. */
#define SFDAE_INCONSISTENT_VALUES (-30)    /**< initial values violate the constraints (SFDAE_INITIAL_ACCEPT) */
#define SFDAE_INCONSISTENT_EQUATIONS (-31) /**< redundant equations contradict each other: no solution */
#define SFDAE_FIXED_VALUES (-32)           /**< the fixed components contradict the constraints */
#define SFDAE_NO_CONSISTENT_VALUES (-33)   /**< nonlinear: no consistent values were found near the guess */

/* Failures: integration. The point reached is returned, sfdae_advance may be called again. */
#define SFDAE_MAX_STEPS (-40)           /**< max_steps taken in this call */
#define SFDAE_STEP_TOO_SMALL (-41)      /**< the error test fails at the smallest step */
#define SFDAE_SINGULAR (-42)            /**< the iteration matrix stays singular */
#define SFDAE_TOLERANCE_TOO_SMALL (-43) /**< tolerances below the errors of roundoff or of finite differences */
#define SFDAE_ZENO (-44)                /**< conditions, or transitions of a hybrid system, accumulate at one time */

#define SFDAE_INTERNAL (-99) /**< a defect of the library: please report it */

/** Name of a status, for example "SFDAE_STEP_TOO_SMALL"; "unknown status" for any other number. */
SFDAE_API const char* sfdae_status_name(int status);

/** Version of the library that is running, for example "0.2.0". */
SFDAE_API const char* sfdae_version(void);

/* ---- Linear problems ------------------------------------------------------------------------- */

/* Callbacks return 0 (ok), a positive value (cannot evaluate here: a smaller step is tried) or a negative value
 * (stop at once). All arrays are filled with zeros before the call: write the nonzeros only. */

/** A callback may return this if it cannot provide the requested derivative order. */
#define SFDAE_ORDER_NOT_AVAILABLE 1001

/** Writes the derivative of the given order (0: the matrix itself) of E or A at t to `matrix`, m x n, plain, without
 * factorials. Requested orders: 0 ... max_index in the analysis, 0 ... max(mu, 1) later, and mu + 1 for x' at initial
 * values and at outputs within Radau steps unless that exceeds max_index. */
typedef int (*sfdae_matrix_function)(double t, int order, double* matrix, void* user);

/** Writes the derivative of the given order (0: the vector itself) of f at t to `vector`, m entries, plain, without
 * factorials. Requested orders: 0 ... max_index in the analysis, 0 ... max(mu, 1) later, and mu + 1 for x' at initial
 * values and at outputs within Radau steps unless that exceeds max_index. Functions of this type also write prescribed
 * values, with order 0. */
typedef int (*sfdae_vector_function)(double t, int order, double* vector, void* user);

/* Callbacks that contain an `if` should declare its condition. Declared conditions are events, as in recorded
 * equations. A problem has num_conditions of them: condition k holds where g_k(t, x, x') > 0. The callbacks of the
 * problem compare nothing themselves: they read `branches`, an array of num_conditions numbers that the caller owns, to
 * which the library writes 1 (the condition holds) or 0 before each call. The array must live as long as the solver;
 * solvers that run at the same time need separate arrays. A branch may be held beyond the zero of g within a step, so
 * its formulas must be defined slightly beyond it.
 *  - If E x has to jump at a zero, or a step fails because of it, the step ends there and x jumps by impulses of the
 *    new equations (modes.h). sfdae_get_switch lists the zeros.
 *  - Conditions that switch twice within one step are detected if they differ at one of seven places in between (limit
 *    max_step). If both branches lead back to the zero, the call ends with SFDAE_ZENO. Recorded equations have neither
 *    limitation. */

/** Writes the switching functions g(t, x, x') of all conditions, num_conditions entries, zeros before the call. x and
 * xdot have n entries each. Zeros of g should not depend on whether the condition holds. Return values are those of the
 * other callbacks. */
typedef int (*sfdae_conditions_function)(double t, const double* x, const double* xdot, double* g, void* user);

/* Callbacks write matrices with all entries, or the entries of sparsity patterns. A pattern is in compressed sparse
 * column format: rows of the entries of column j, 0 <= j < n, are row_index[col_start[j]], ..., row_index[col_start[j +
 * 1] - 1], in any order and none twice; col_start has n + 1 numbers, the first 0 and the last the number of entries.
 * All are copied. */
#define SFDAE_MATRICES_DENSE 0 /**< all m x n entries; those beyond the pattern have to be zero, which is checked */
#define SFDAE_MATRICES_COMPRESSED 1 /**< the entries alone, in the order of row_index */
#define SFDAE_MATRICES_DIFFERENCES \
  2 /**< nonlinear: none. F_x and F_x' are finite differences of F, by columns or by groups of columns of a pattern */

/** Linear problem E(t) x' = A(t) x + f(t), mass matrix E, possibly singular. Call sfdae_linear_problem_init first,
 * then set members. */
typedef struct sfdae_linear_problem {
  size_t size;       /**< set by sfdae_linear_problem_init */
  int num_equations; /**< m, 1 ... 5000, or 50000 where compressed matrices are square and nothing is prescribed */
  int num_unknowns;  /**< n, as m; m and n may differ */
  sfdae_matrix_function E;
  sfdae_matrix_function A;
  sfdae_vector_function f; /**< NULL: f = 0 */
  int constant_E;          /**< 1: E does not depend on t; only order 0 is requested, once. 0 (default): it may */
  int constant_A;          /**< 1: A does not depend on t; both 1: a single reduction is used */

  /** u > 0 only: components x_j that are prescribed as functions of time, for example inputs of a controlled system.
   * At most u of them, and they must determine the part of the solution that is free. */
  int num_prescribed;                      /**< default 0 */
  const int* prescribed;                   /**< their indices j, 0 <= j < n, no two equal */
  sfdae_vector_function prescribed_values; /**< writes their values at t, num_prescribed entries; order is 0 */

  void* user; /**< passed to every callback */

  /** Names of the equations for messages, copied: NULL (default), or m names, NULL or "" for those without one.
   * Messages then include the name, as in "equation 7 (balance of mass)". */
  const char* const* equation_names;

  /** Sparsity patterns of both matrices or of neither (default: NULL). Square problems without prescribed components
   * then use structural analysis and sparse matrices, as recorded equations do (sfdae_options.structure). A nonzero
   * entry of a dense matrix outside its pattern ends the call with SFDAE_WRONG_PATTERN, whenever it occurs. */
  int E_entries;          /**< default 0 */
  const int* E_col_start; /**< n + 1 numbers */
  const int* E_row_index; /**< E_entries rows, 0 ... m - 1 */
  int A_entries;
  const int* A_col_start;
  const int* A_row_index;
  int matrices; /**< SFDAE_MATRICES_DENSE (default) or _COMPRESSED */

  /** Conditions on which E, A and f depend (see above). A problem with conditions is solved as a nonlinear one: its
   * matrices are dense and not constant, and no components are prescribed. */
  int num_conditions;                   /**< 0 (default) ... 1000 */
  sfdae_conditions_function conditions; /**< must be set if num_conditions > 0 */
  int* branches;                        /**< the same; written before each call */
} sfdae_linear_problem;
/** Sets every member to its default. size: sizeof(sfdae_linear_problem). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_linear_problem_init(sfdae_linear_problem* problem, size_t size);

/* ---- Options --------------------------------------------------------------------------------- */

/* How the derivative array is reduced. */
#define SFDAE_REDUCTION_STAGED 0 /**< staged orthogonal elimination: fast, clearest rank decisions */
#define SFDAE_REDUCTION_SVD 1    /**< singular value decompositions of the full derivative array */

/* Computation of consistent initial values. */
#define SFDAE_INITIAL_NEAREST 0 /**< nearest consistent point; differential variables stay if possible */
#define SFDAE_INITIAL_FIXED 1   /**< nearest one with the components marked in `fixed` unchanged */
#define SFDAE_INITIAL_ACCEPT 2  /**< unchanged but checked: violations above the tolerances are refused */

/* The quantity w = W x that is differentiated by the integrator in E x' = A x + f. */
#define SFDAE_LEADING_AUTOMATIC 0 /**< projector if rank E is constant, else matrix, else identity */
#define SFDAE_LEADING_PROJECTOR 1 /**< W = E^+ E */
#define SFDAE_LEADING_MATRIX 2    /**< W = E */
#define SFDAE_LEADING_IDENTITY 3  /**< W = I; needs no derivative of E, but may be unstable where ker E rotates */

/* Integration methods. Radau takes fewer and longer steps than BDF if the problem is smooth, above all at tight
 * tolerances. */
#define SFDAE_METHOD_BDF 0       /**< orders 1 to 5 */
#define SFDAE_METHOD_RADAU 1     /**< Radau IIA with 1, 3, 5 or 7 stages, orders 1, 5, 9, 13 */
#define SFDAE_METHOD_AUTOMATIC 2 /**< Radau; BDF if steps fail, or are too rough for frequent output, too often */

/* Dense output: accuracy of x at outputs within steps. At the ends of steps x satisfies the constraints to the accuracy
 * of the Newton iteration. */
#define SFDAE_OUTPUT_CONSISTENT 0   /**< all constraints, hidden ones included, hold to roundoff */
#define SFDAE_OUTPUT_INTERPOLATED 1 /**< the method's polynomial alone, for curves; constraints within tolerances */

/* Use of structural analysis to select the rows of the derivative array. */
#define SFDAE_STRUCTURE_OFF 0       /**< all rows of the derivative array are used */
#define SFDAE_STRUCTURE_AUTOMATIC 1 /**< rows that are not needed are left out, large ones are sparse */
#define SFDAE_STRUCTURE_REQUIRED 2  /**< minimal extension with sparse matrices, or a failure */

/* Conditions on which equations depend. */
#define SFDAE_CONDITIONS_SMOOTH 0 /**< zeros are not located: the error test alone chooses the steps */
#define SFDAE_CONDITIONS_EVENTS 1 /**< steps end at zeros where something jumps, or that depend on t alone */

/** Progress data passed to the monitor. */
typedef struct sfdae_progress {
  size_t size;      /**< size of this struct in the calling library */
  double t;         /**< point reached */
  double step;      /**< size of the step to t, negative when integrating backward */
  int order;        /**< order of that step */
  long steps;       /**< accepted steps since sfdae_start */
  int num_unknowns; /**< n */
  const double* x;  /**< n values at t, valid during the call */
} sfdae_progress;

/** Called after every accepted step. Any value but 0 stops the call with SFDAE_STOPPED. */
typedef int (*sfdae_monitor_function)(const sfdae_progress* progress, void* user);

/** Call sfdae_options_init first, then set members. */
typedef struct sfdae_options {
  size_t size; /**< set by sfdae_options_init */

  /** Accuracy: the error of component i is kept near rtol |x_i| + atol. */
  double rtol;               /**< default 1e-6; 0 <= rtol < 1, not both zero */
  double atol;               /**< default 1e-6; >= 0 */
  const double* rtol_vector; /**< NULL or n values that replace rtol, one for each component */
  const double* atol_vector; /**< NULL or n values that replace atol */

  /** Index analysis. Derivatives that callbacks do not provide (SFDAE_ORDER_NOT_AVAILABLE) can be computed from order 0
   * by finite differences, up to order 6, each entry to the accuracy that its own values allow. If that is not enough
   * for the tolerances (above all for mu >= 3 and tolerances below 1e-8), the start, steps and outputs fail with
   * SFDAE_TOLERANCE_TOO_SMALL; the message names the component and its error. */
  int max_index;              /**< highest strangeness index tried, default 5; 0 ... 12 */
  int reduction;              /**< SFDAE_REDUCTION_STAGED (default) or _SVD */
  double rank_tol;            /**< in (0, 1): values below rank_tol * norm of the data, in balanced units, count as
                                 zero. Default 0: decided by propagated rounding errors and, if norms are not clear in
                                 two systems of units, by a certificate (sfdae_certify) */
  double time_scale;          /**< unit of time of derivatives (> 0), rounded to a power of two. Default 0: chosen */
  int difference_derivatives; /**< 1: finite differences are allowed. Default 0: SFDAE_ORDER_MISSING */
  double difference_step;     /**< largest spacing of their points (> 0): eight of these are the whole interval of 13
                                 Chebyshev points; default 0: chosen */

  /** Consistent initial values. If x violates the constraints, the algebraic variables (multipliers, currents; the
   * kernel of E or F_x') are adjusted first. Only a remaining violation changes the differential variables, and as
   * little as possible: sum (change_i / (rtol |x_i| + atol))^2 is smallest; SFDAE_VALUES_CHANGED if that is beyond the
   * tolerances (_NEAREST). With weights, sum (change_i / w_i)^2 of all unknowns is smallest instead (a local minimum if
   * constraints are nonlinear), without that warning; for multibody systems first that of positions, then that of
   * velocities. If _NEAREST would change the differential variables, or the analysis fails because the equations are
   * singular at the initial guess of the algebraic variables, nearby guesses are tried. */
  int initial_values;            /**< SFDAE_INITIAL_NEAREST (default), _FIXED or _ACCEPT */
  const int* fixed;              /**< for _FIXED: n flags, 1 if x_i must not change */
  const double* initial_weights; /**< NULL or n positive numbers w_i */

  /** Redundant equations, v > 0. */
  int ignore_inconsistency; /**< 1: ignore contradictions (SFDAE_INCONSISTENCY_IGNORED). Default 0: stop */
  double consistency_tol;   /**< relative size of a contradiction that counts, default 1e-8; > 0, < 1 */

  /** Integration. */
  int max_order;       /**< highest BDF order, 1 ... 5 (default) */
  double initial_step; /**< size of the first step; default 0: chosen */
  /** Largest step size; default 0: no limit. For recorded equations the solver detects how inputs vary within a step.
   * Callbacks are known only at the points of their calls: a step that has grown may skip the next pulse of a source,
   * unless max_step is smaller than the duration of the pulse. */
  double max_step;
  int use_stop_time; /**< 1: no evaluations beyond stop_time. Default 0 */
  double stop_time;
  long max_steps;   /**< attempted steps in one call, default 100000; >= 1 */
  int leading_term; /**< SFDAE_LEADING_AUTOMATIC (default), ... */

  sfdae_monitor_function monitor; /**< NULL: none */
  void* monitor_user;             /**< passed to the monitor */

  /** The method, and the numbers of stages that Radau may use: 1, 3, 5 or 7, min_stages <= max_stages; the number is
   * fixed if they are equal (1 alone is for rough problems: errors accumulate). Changes take effect with the next
   * sfdae_start. */
  int method;                 /**< SFDAE_METHOD_BDF (default), ... */
  int min_stages, max_stages; /**< defaults 1 and 7 */

  /** 1: xdot is in/out for sfdae_start and sfdae_make_consistent: an initial guess of x' that selects among several
   * solutions x' of F(t, x, x') = 0 of a nonlinear problem (zeros: none; linear and multibody problems determine x' and
   * ignore it). Default 0: xdot is out. */
  int xdot_is_guess;

  /** SFDAE_OUTPUT_CONSISTENT (default): an output costs one reduction of a linear problem, or an iteration with a
   * reused factorization of others, and more if x' is requested. _INTERPOLATED: it costs almost nothing; x' is the
   * slope of the polynomial. Outputs are nevertheless consistent if the polynomial of x is not accurate to within the
   * tolerances, if there are no differential equations, and at events. */
  int output;

  /** 1 (default): every analysis compares the derivatives that callbacks supply with finite differences, by a few
   * evaluations on the side of t in the direction of integration. SFDAE_WRONG_DERIVATIVES if one contradicts its
   * function clearly, on two scales of time or space and by 1 % at least; the message names function, order, row,
   * column and both values. 0: no comparison.
   *  - Linear problems: E, A, f, orders 1 ... mu + 1, as far as available. Total derivatives of nonlinear problems: F
   *    along the solution and F_x, F_x' in one random direction. Multibody systems: g_q and g_t in one random
   *    direction, gamma and eta along consistent velocities, at the consistent start values.
   *  - Not detected: errors of less than 1 % or hidden by noise (of single precision, of tables), in entries that vary
   *    on scales below 1e-8 of the interval to `toward`, in derivatives that are right near t, or in values that are
   *    themselves wrong; E and A wrongly declared constant; M, f, H, S of multibody systems, whose derivatives
   *    callbacks do not supply. sfdae_check_derivatives and related functions compare on both sides of any point, more
   *    closely.
   *  - Failures of evaluations made only for this check are ignored, except negative return values. */
  int check_derivatives;

  /** Structural analysis of square recorded systems: the unknowns and derivatives in each equation predict how often it
   * must be differentiated (J. D. Pryce, BIT 41, 2001), barring cancellation; see sfdae_get_structure.
   * SFDAE_STRUCTURE_AUTOMATIC (default): if the analysis is confirmed numerically at the start, unneeded rows of the
   * derivative array are left out, and all matrices are sparse from about 100 columns of the array on (20 if nothing
   * has to be differentiated); otherwise the full derivative array is used or, with more than 5000 unknowns, the
   * failure is reported. Results are the same within the tolerances. With sparse matrices, equations that depend on
   * others everywhere, such as those of the nodes on both sides of a capacitor, are replaced by sums in which terms
   * cancel, if constant factors suffice. If terms cancel only at a later time, the reduced array ends with
   * SFDAE_CHARACTERISTICS_CHANGED where the full array may continue. SFDAE_STRUCTURE_REQUIRED: always the reduced array
   * with sparse matrices; SFDAE_RANK_UNCLEAR if the structure is not confirmed numerically, SFDAE_ILLEGAL_ARGUMENT for
   * problems without a structural analysis: callbacks without patterns, prescribed components, differentiations,
   * systems that are not square. SFDAE_STRUCTURE_OFF: always the full array, as for these problems.
   * Recorded multibody systems: local coordinates with dense matrices, or first-order equations with sparse ones.
   * SFDAE_STRUCTURE_AUTOMATIC chooses the latter from 200 unknowns (q, v, lambda, kappa) on, if an equation contains at
   * most a tenth of them on average, no constraint is redundant and the structure is confirmed numerically;
   * `coordinates` then has no effect. A singular configuration ends the integration as otherwise; the values after it
   * are not determined. */
  int structure;

  /** Conditions of recorded equations (choose, comparisons, abs, min, max, sign, floor, remainders, tables), and those
   * that callbacks declare. SFDAE_CONDITIONS_EVENTS (default): steps end at the zeros of conditions on t alone, and at
   * zeros of others if E x has to jump; x jumps by impulses there, or slides along the surface of the zeros (modes.h).
   * SFDAE_CONDITIONS_SMOOTH: the equations are treated as smooth, and the error test alone chooses the steps. Use it
   * only if all conditions are kinks that no equation differentiates: otherwise results are wrong without a warning.
   * Breakpoints remain in effect. */
  int conditions;

  /** Wall-clock time of one call in seconds, default 0: no limit. A call that takes longer returns SFDAE_STOPPED at the
   * next evaluation of the equations, with the point reached, and can be repeated; each call has the whole time. For
   * hybrid systems: of each stay in a mode, with the options of its solver. A function of the user's that does not
   * return is not interrupted. */
  double max_seconds;
} sfdae_options;
/** Sets every member to its default. size: sizeof(sfdae_options). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_options_init(sfdae_options* options, size_t size);

/* ---- Solver ---------------------------------------------------------------------------------- */

/** A problem with its options, its analysis and its integration. */
typedef struct sfdae_solver sfdae_solver;

/** Creates a solver of a linear problem. problem and options (NULL: defaults) are copied. On failure *solver is
 * NULL.
 * Failures: SFDAE_ILLEGAL_ARGUMENT, SFDAE_EMPTY_PROBLEM; sfdae_message(NULL) explains the failure. */
SFDAE_API int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem,
                                  const sfdae_options* options);

/** Checks a linear problem and its options (NULL: defaults) without creating a solver. Returns the status of
 * sfdae_create_linear and writes an explanation of the error, "" if there is none, to `text`, at most `length`
 * characters with the final zero (text NULL with length 0 is allowed). */
SFDAE_API int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text,
                                 size_t length);

/** Frees the solver and sets *solver to NULL. NULL and *solver == NULL are allowed. SFDAE_BUSY from a callback and for
 * a mode of a hybrid system that still exists, which changes nothing. */
SFDAE_API int sfdae_destroy(sfdae_solver** solver);

/** Replaces the options; the point reached stays. Changing max_index, reduction, rank_tol, time_scale,
 * difference_derivatives, difference_step, leading_term or structure ends the integration and requires a new analysis:
 * sfdae_start has to follow. SFDAE_ILLEGAL_ARGUMENT for options out of range; the old ones then stay. */
SFDAE_API int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options);

/** The message of the last call on this solver: what happened, where, by which numbers, what to do. "" after SFDAE_OK.
 * Functions that only read (a const solver, sfdae_get_...) keep the message of an earlier failure; otherwise they set
 * it if they fail. The text is valid until the next call.
 *
 * NULL: the message of the last sfdae_create_... function that this thread called, "" if it succeeded; it is valid
 * until the thread calls one of them again. So status and message can be printed in the same way after any call. */
SFDAE_API const char* sfdae_message(const sfdae_solver* solver);

/** Stops the call that is running, or else the next one, at its next callback or step: it returns SFDAE_STOPPED,
 * which clears the request. Lock-free: may be called from signal handlers and other threads. */
SFDAE_API int sfdae_request_stop(sfdae_solver* solver);

/* ---- Index analysis -------------------------------------------------------------------------- */

/** Characteristic values: d + a + v = m, d + a + u = n. */
typedef struct sfdae_characteristics {
  size_t size;
  double t;              /**< where they were determined */
  int strangeness_index; /**< mu; the differentiation index of a regular problem is mu + 1, or 0 if a = 0 */
  int differential;      /**< d */
  int algebraic;         /**< a */
  int undetermined;      /**< u: free components of the solution, before any are prescribed */
  int redundant;         /**< v: equations that follow from the others */
  int rank_E;            /**< rank of E(t) */
  int leading_term;      /**< SFDAE_LEADING_ ... in use */
  double time_scale;     /**< in use */
  double smallest_gap;   /**< smallest ratio of kept to dropped values of all rank decisions; >= 1e3 is clear */
} sfdae_characteristics;
/** Prepares a result of the index analysis. size: sizeof(sfdae_characteristics). */
SFDAE_API int sfdae_characteristics_init(sfdae_characteristics* characteristics, size_t size);

/** Determines the strangeness index of a linear problem at t and at a nearby point in the direction of `toward` (the
 * end of the interval of interest, toward != t). The larger one is used until the next analysis. `result` may be NULL.
 * The point reached is discarded: sfdae_start has to follow.
 * Warnings: SFDAE_NOT_UNIQUE. Failures: callbacks, structure; SFDAE_ILLEGAL_ARGUMENT for nonlinear problems, which need
 * sfdae_analyze_at. After a failure there is no analysis, but its rank decisions can be read; a refused argument
 * changes nothing. */
SFDAE_API int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result);

/** Determines the strangeness index of any problem along the solution through a point near x (n values, which need not
 * be consistent and are not changed; linear problems ignore them), at t and at a nearby point in the direction of
 * `toward`, toward != t. sfdae_start does this if there is no analysis. `result` may be NULL. The point reached is
 * discarded: sfdae_start has to follow.
 * Warnings: SFDAE_NOT_UNIQUE. Failures: callbacks, structure, SFDAE_NO_CONSISTENT_VALUES. After a failure there is no
 * analysis, but its rank decisions can be read; a refused argument changes nothing. */
SFDAE_API int sfdae_analyze_at(sfdae_solver* solver, double t, double toward, const double* x,
                               sfdae_characteristics* result);

/** The characteristic values in use. SFDAE_NOT_STARTED before an analysis. */
SFDAE_API int sfdae_get_characteristics(const sfdae_solver* solver, sfdae_characteristics* result);

/* The matrix of a rank decision. */
#define SFDAE_DECISION_STAGE 0 /**< pivots of a diagonal block of the derivative array */
#define SFDAE_DECISION_A2 1    /**< the constraints A^ x + f^ = 0: rank a */
#define SFDAE_DECISION_ET2 2   /**< E T2: rank d */
#define SFDAE_DECISION_ARRAY 3 /**< the full derivative array M (SVD reduction) */
#define SFDAE_DECISION_BLOCK \
  4 /**< a diagonal block of the system Jacobian of recorded equations (sfdae_get_structure) */

/* Verdicts. */
#define SFDAE_VERDICT_CLEAR 0
#define SFDAE_VERDICT_CONFIRMED 1 /**< small gap, confirmed by a second judgement (SVD, certificate) */
#define SFDAE_VERDICT_UNCLEAR 2
#define SFDAE_VERDICT_USER 3 /**< decided by rank_tol */

/** One rank decision. Values are relative to the norm of the data. */
typedef struct sfdae_decision {
  size_t size;
  double t;
  int level; /**< of the derivative array, 0 ... */
  int stage; /**< block column 1 ... level + 1 for SFDAE_DECISION_STAGE, the block for SFDAE_DECISION_BLOCK, else 0 */
  int what;  /**< SFDAE_DECISION_ ... */
  int rows, columns; /**< of the matrix judged */
  int rank;
  double kept;      /**< smallest value kept, 0 if rank = 0 */
  double dropped;   /**< largest value dropped, 0 if the rank is full */
  double noise;     /**< bound of the effect of rounding errors */
  double threshold; /**< values below count as zero */
  double gap;       /**< kept / max(dropped, noise); 1e300 if nothing was kept */
  int verdict;      /**< SFDAE_VERDICT_ ... */
} sfdae_decision;
/** Prepares a result of sfdae_get_decision. size: sizeof(sfdae_decision). */
SFDAE_API int sfdae_decision_init(sfdae_decision* decision, size_t size);

/** Number of rank decisions of the last analysis, successful or not. SFDAE_NOT_STARTED if there are none. */
SFDAE_API int sfdae_get_num_decisions(const sfdae_solver* solver, int* count);

/** One rank decision of the last analysis, successful or not, 0 <= index < count. SFDAE_NOT_STARTED if there are
 * none. */
SFDAE_API int sfdae_get_decision(const sfdae_solver* solver, int index, sfdae_decision* result);

/** A change of the characteristic values. */
typedef struct sfdae_change {
  size_t size;
  double t; /**< where, to about 1e-6 of the step or better */
  int old_strangeness_index, old_differential, old_algebraic, old_undetermined, old_redundant;
  int new_strangeness_index; /**< -1: could not be determined at t; then the other new values are -1 as well */
  int new_differential, new_algebraic, new_undetermined, new_redundant;
} sfdae_change;
/** Prepares a result of sfdae_get_change. size: sizeof(sfdae_change). */
SFDAE_API int sfdae_change_init(sfdae_change* change, size_t size);

/** The place and kind of a change of the characteristic values after SFDAE_CHARACTERISTICS_CHANGED; else
 * SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_get_change(const sfdae_solver* solver, sfdae_change* result);

/* ---- Initial values -------------------------------------------------------------------------- */

/** Makes x (n values, in: initial guess, out: consistent) consistent at t by the option initial_values and computes the
 * derivative x'(t) of the solution through it (xdot: n values, may be NULL; minimum norm in directions that the problem
 * leaves free). With the option xdot_is_guess, xdot is also an initial guess. Analyzes first, forward from t, if there
 * is no analysis. The point reached is unaffected.
 * Warnings: SFDAE_INCONSISTENCY_IGNORED, SFDAE_VALUES_CHANGED, SFDAE_NOT_UNIQUE, the first that applies;
 * sfdae_message names all. Failures: callbacks, structure, values; SFDAE_TOLERANCE_TOO_SMALL, with the values found in
 * x and xdot, if finite differences make them less accurate than the tolerances. */
SFDAE_API int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot);

/** Report on the consistent initial values of the last sfdae_start or sfdae_make_consistent. */
typedef struct sfdae_initial_report {
  size_t size;
  double t;
  double residual_before; /**< 2-norm of A2 x + f2, rows of A2 orthonormalized, for the given values: distance to the
                             nearest consistent point */
  double residual_after;  /**< the same distance for the returned values */
  double largest_change;  /**< max |change_i|, 0 if nothing changed */
  int component;          /**< its component, -1 if nothing changed */
  int derivative_exact; /**< 1: x' from the derivative array; 0: the derivative of the constraints in it was computed by
                           finite differences */
} sfdae_initial_report;
/** Prepares a result of sfdae_get_initial_report. size: sizeof(sfdae_initial_report). */
SFDAE_API int sfdae_initial_report_init(sfdae_initial_report* report, size_t size);

/** Reads the report on the initial values. SFDAE_NOT_STARTED before sfdae_start and sfdae_make_consistent. */
SFDAE_API int sfdae_get_initial_report(const sfdae_solver* solver, sfdae_initial_report* result);

/* ---- Integration ----------------------------------------------------------------------------- */

/** Starts or restarts the integration at (t, x): makes x (n values, in: initial guess, out: consistent) consistent by
 * the option initial_values and computes x' (xdot: n values, may be NULL; with xdot_is_guess also an initial guess).
 * `toward`, not equal to t, sets the direction; its distance sets the scale of the first step. Analyzes if there is no
 * analysis or one for the other direction; a restart on an analyzed solver needs no new analysis.
 * Warnings: SFDAE_INCONSISTENCY_IGNORED, SFDAE_VALUES_CHANGED, SFDAE_NOT_UNIQUE, the first that applies;
 * sfdae_message names all. Failures: callbacks, structure, values;
 * SFDAE_CHARACTERISTICS_CHANGED if the known characteristic values do not hold at t: call sfdae_analyze. After a
 * failure nothing is started, and an integration that was under way is lost; a refused argument changes nothing. */
SFDAE_API int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot);

/** Integrates to tout and returns there: *t = tout, x (n values), xdot (n values, may be NULL). tout must lie in the
 * direction of integration, at or after the last point returned and not beyond stop_time. Steps may go past tout; a
 * later call with a tout within the last step only interpolates.
 *
 * x satisfies all constraints, hidden ones included, to roundoff. xdot is the slope of the method's polynomial,
 * corrected toward the equations: its error is about that of x over the step size. Within Radau steps xdot is exact if
 * derivatives of order mu + 1 are available, else less accurate. NULL for xdot saves its cost. The option `output`
 * selects cheaper dense output. Steps do not depend on tout, except Radau steps in which the polynomial would not be
 * accurate: these are shortened or end at tout.
 *
 * Warnings: SFDAE_STOPPED, SFDAE_INCONSISTENCY_IGNORED, SFDAE_EVENT. Failures: callbacks, integration,
 * SFDAE_CHARACTERISTICS_CHANGED, SFDAE_INCONSISTENT_EQUATIONS, SFDAE_NOT_STARTED. If tout is not reached, t, x and
 * xdot are the last accepted point, which may lie after tout if the last step went past it. */
SFDAE_API int sfdae_advance(sfdae_solver* solver, double tout, double* t, double* x, double* xdot);

/** Takes one step toward tout, which must lie in the direction of integration, at or after the last point returned
 * and not beyond stop_time. Returns SFDAE_STEP_TAKEN with the point reached in t, x (n values) and xdot (n values,
 * may be NULL), or SFDAE_OK with these at tout, interpolated if the step went past it. x and xdot are what
 * sfdae_advance returns.
 * Warnings: SFDAE_STEP_TAKEN, SFDAE_STOPPED, SFDAE_INCONSISTENCY_IGNORED, SFDAE_EVENT. Failures: callbacks,
 * integration, SFDAE_CHARACTERISTICS_CHANGED, SFDAE_INCONSISTENT_EQUATIONS, SFDAE_NOT_STARTED, with the last
 * accepted point in t, x and xdot. */
SFDAE_API int sfdae_step(sfdae_solver* solver, double tout, double* t, double* x, double* xdot);

/** The solution at any t within the last step taken (t_internal - last_step ... t_internal in sfdae_statistics),
 * before or after the point returned last, which stays (dense output). x (n values) and xdot (n values, may be NULL)
 * have the accuracy set by the option `output`. SFDAE_ILLEGAL_ARGUMENT for other t.
 * Failures: callbacks, integration, SFDAE_CHARACTERISTICS_CHANGED, SFDAE_INCONSISTENT_EQUATIONS,
 * SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_interpolate(sfdae_solver* solver, double t, double* x, double* xdot);

/** Counts since sfdae_start, except where stated. */
typedef struct sfdae_statistics {
  size_t size;
  long steps;                                       /**< accepted */
  long error_failures;                              /**< attempts rejected by the error test */
  long other_failures;                              /**< attempts rejected for callbacks, singular matrices */
  long reductions;                                  /**< strangeness-free systems computed */
  long factorizations;                              /**< LU factorizations of the step's matrix */
  long evaluations_E, evaluations_A, evaluations_f; /**< callback calls except check_calls, since creation */
  int last_order;                                   /**< order of the last step, 0 before the first */
  int next_order;
  double last_step; /**< signed size of the last step */
  double next_step;
  double t_internal;    /**< end of the last step, at or after the last point returned */
  double smallest_kept; /**< smallest value kept in any rank decision along the way, relative */
  double consistency;   /**< largest relative residual of redundant equations along the way (v > 0) */
  double first_step;    /**< signed size of the first accepted step */
  long evaluations_F;   /**< nonlinear: of F and its total derivatives along a jet, since creation */
  long linearizations;  /**< nonlinear: of F, its Jacobians and their total derivatives, since creation */
  double rounding;  /**< nonlinear: largest rounding error that the equations cause in a component so far, over the
                       tolerance used for it; above 1 it was tested against that error instead */
  long check_calls; /**< by the option check_derivatives, not included elsewhere, since creation: callback calls of
                       linear and nonlinear problems, points of multibody systems */
  long switches; /**< of conditions, see sfdae_get_switch; since the start or the checkpoint; 0 for hybrid systems */
  long jumps;    /**< times of switches at which x jumps by impulses */
} sfdae_statistics;
/** Prepares a result of sfdae_get_statistics. size: sizeof(sfdae_statistics). */
SFDAE_API int sfdae_statistics_init(sfdae_statistics* statistics, size_t size);

/** Counts and step sizes of the integration under way; without an integration all but evaluations and linearizations
 * are 0. */
SFDAE_API int sfdae_get_statistics(const sfdae_solver* solver, sfdae_statistics* result);

/* ---- Checkpoints ----------------------------------------------------------------------------- */

/* A checkpoint is the analysis and the state of an integration as an array of doubles, to be stored, written to a file,
 * or passed to another process. A restored integration continues as if uninterrupted, bit for bit if binary, BLAS,
 * processor and the environment variable SFDAE_INSTRUCTIONS (portable or avx2: no faster instructions of the processor
 * are used) are the same. The numbers are plain doubles (infinity may be among them): copy them, or print them with 17
 * digits. A checkpoint does not contain the problem and the options, but identifies them; it contains sensitivities
 * with all their data. */

/** Number of doubles that sfdae_save_checkpoint writes now; it changes from step to step. SFDAE_NOT_STARTED if there
 * is no integration. */
SFDAE_API int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length);

/** Writes a checkpoint to an array of `length` doubles, at least as many as are needed. SFDAE_NOT_STARTED if there
 * is no integration. */
SFDAE_API int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length);

/** Continues from a checkpoint of `length` doubles instead of sfdae_start: sfdae_advance is next. The solver has to be
 * created with the problem of the checkpoint, with the same sensitivities requested. Method, structure, max_index,
 * reduction, rank_tol, time_scale, difference_derivatives, difference_step, leading_term and the values of parameters
 * must be those of the checkpoint; other options, such as tolerances and limits, may differ. Recorded equations are
 * compared operation by operation, patterns entry by entry. Callbacks cannot be compared: supply the same ones. No
 * callback of a linear problem is called; a nonlinear problem is linearized at the same point as before. An integration
 * under way is replaced. SFDAE_ILLEGAL_ARGUMENT if the checkpoint is damaged or belongs to another problem or version,
 * or if one of these options or parameters differs; the message names it with both values. After any failure everything
 * is unchanged, and an integration under way continues. */
SFDAE_API int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length);

/* ---- Inspection ------------------------------------------------------------------------------ */

/** Writes the diagnostics report as text: index analysis with every rank decision, initial values, integration. At
 * most length characters, final zero included (text NULL with length 0 is allowed). *needed (may be NULL): length
 * of the whole text + 1. */
SFDAE_API int sfdae_report(const sfdae_solver* solver, char* text, size_t length, size_t* needed);

/** Certifies the ranks of the analysis: the elimination runs once more on copies of the data whose entries are
 * perturbed by 1e-12 of themselves (zeros stay), in balanced units. Pivots that do not change are values, those that
 * change are errors, whatever their size. *distance (may be NULL): the approximate smallest relative change of the
 * data, entry by entry, that gives other characteristic values; at most 1. sfdae_report includes it from then on.
 * Nonlinear problems: at the point reached. Evaluates callbacks. Failures: callbacks; SFDAE_NOT_STARTED before an
 * analysis; SFDAE_RANK_UNCLEAR if the certificate does not confirm the values; SFDAE_ILLEGAL_ARGUMENT for multibody
 * systems, whose ranks are those of the constraints. */
SFDAE_API int sfdae_certify(sfdae_solver* solver, double* distance);

/* The theory's objects: derivative array, projectors, strangeness-free system.
 *
 * For linear problems they depend on t alone. For others they belong to a jet, that is t, x, x', ..., x^(l+1), at which
 * F and its derivatives F' = dF/dt, ..., F^(l) along the jet are linearized: they refer to changes dx of x and dy of y
 * = (x', ..., x^(l+1)),
 *
 *     M dy = N dx + g,   M = dF_l/dy,   N = -dF_l/dx,   g = -F_l,   F_l = (F, F', ..., F^(l)),
 *
 * with plain derivatives, without factorials. For a linear problem, F = E x' - A x - f, M and N are the same at any
 * jet, and g is that at the jet 0, where dx = x and dy = y. In memory a jet is an n x (l+2) array, x first.
 *
 * Multibody systems are treated as x = (q, v, lambda, kappa) and F = (q' - S v, M v' - f + G^T lambda + H^T kappa, g, H
 * v + h), m = n.
 *
 * Functions whose name ends in _at take a jet from the caller, which need not be consistent; the properties of Z2, Z3
 * and T2 then hold as far as F_l = 0 does. The others, for nonlinear problems and multibody systems, take the jet of
 * the solution at t, which has to lie within the last step taken, as for sfdae_interpolate, or be the start before the
 * first step, or the point of the analysis before a start. An integration under way is not affected.
 *
 * If the number of differentiations is limited (sfdae_nonlinear_problem.differentiations), the omitted rows of the
 * derivative array are zero, also in Z2 and Z3. */

/** Writes the jet of level l, 0 ... 12, through (t, x): x and derivatives x', ..., x^(l+1) with F_k = 0, k = max(l,
 * mu). Components that these equations do not determine are as near as possible to those of the point reached. x: n
 * values, consistent, or NULL for the solution at t. jet: n x (l+2).
 * Callbacks of multibody systems: level 0 only, with lambda' and kappa' by finite differences; else
 * SFDAE_ORDER_MISSING. Failures: callbacks, SFDAE_NOT_STARTED before an analysis, and for x = NULL those of
 * sfdae_interpolate; SFDAE_INCONSISTENT_VALUES if there is no such jet. */
SFDAE_API int sfdae_get_jet(sfdae_solver* solver, double t, const double* x, int level, double* jet);

/** Derivative array of level l, 0 ... 12, at t: M is (l+1)m x (l+1)n, N is (l+1)m x n, g has (l+1)m entries. Linear
 * problems: M y = N x + g, blocks of M are C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1), of N A^(i), of g f^(i), at any t,
 * analyzed or not. Others: M dy = N dx + g at the jet of the solution, with (F_x')^(i-j) for E^(i-j) and -(F_x)^(i)
 * for A^(i), where ^(i) is the i-th total derivative along the jet. Any of M, N, g may be NULL.
 * Failures: callbacks, and those of sfdae_get_jet; SFDAE_ORDER_MISSING for callbacks of multibody systems at levels
 * above 0. */
SFDAE_API int sfdae_get_derivative_array(sfdae_solver* solver, double t, int level, double* M, double* N, double* g);

/** Derivative array of level l, 0 ... 12, for changes of a jet, n x (l+2), of any problem, analyzed or not: g = -F_l
 * there. Any of M, N, g may be NULL. Failures: callbacks; SFDAE_ORDER_MISSING for callbacks of multibody systems at
 * levels above 0. */
SFDAE_API int sfdae_get_derivative_array_at(sfdae_solver* solver, double t, const double* jet, int level, double* M,
                                            double* N, double* g);

/** Projectors at t, with orthonormal columns, for the derivative array of level mu:
 *   Z2 ((mu+1)m x a):  Z2^T M = 0, A2 = Z2^T N has full row rank;   Z3 ((mu+1)m x vhat): Z3^T [M N] = 0;
 *   T2 (n x (n-a)):    A2 T2 = 0;                                   Z1 (m x d): spans the range of E T2, E = F_x'.
 * *vhat, the number of columns of Z3, is at most (mu+1)m - a. All pointers may be NULL; sfdae_get_characteristics
 * returns the sizes, and a call with all matrices NULL returns vhat.
 * Multibody systems: Z1 and T2 are those of the minimal extension (index-reduced system). Z2, Z3 and vhat need the
 * derivative array, which exists for recorded formulas only (else SFDAE_ORDER_MISSING). If r constraints are redundant,
 * the array does not determine r multipliers: the last r columns of Z2 are zero.
 * Failures: callbacks, structure, SFDAE_NOT_STARTED before an analysis, those of sfdae_get_jet. */
SFDAE_API int sfdae_get_projectors(sfdae_solver* solver, double t, double* Z1, double* Z2, double* Z3, double* T2,
                                   int* vhat);

/** Projectors at a jet, n x (mu+2): those of sfdae_get_projectors. For Z1 and T2 alone of multibody systems, two
 * columns suffice. */
SFDAE_API int sfdae_get_projectors_at(sfdae_solver* solver, double t, const double* jet, double* Z1, double* Z2,
                                      double* Z3, double* T2, int* vhat);

/** Strangeness-free system at t, E1, A1 d x n, A2 a x n, for the projectors of sfdae_get_projectors:
 *   E1 = Z1^T F_x', A1 = -Z1^T F_x, f1 = -Z1^T F:   E1 dx' = A1 dx + f1   (d rows)
 *   A2 = Z2^T N,    f2 = -Z2^T F_mu:                      0 = A2 dx + f2   (a rows)
 * at the jet of the solution. Linear problems: E1 x' = A1 x + f1, 0 = A2 x + f2 with E1 = Z1^T E, A1 = Z1^T A, f1 =
 * Z1^T f, f2 = Z2^T g. [E1; A2] is nonsingular for u = 0. *residual: max norm of Z3^T g, the contradiction of redundant
 * equations. Any pointer may be NULL.
 * Multibody systems, also those of callbacks: 0 = A2 dx + f2 are independent rows of g = 0, then of G v + g_t = 0 and H
 * v + h = 0, then (lambda, kappa) = mu(t, q, v), all multipliers, all with the sign of -F; they span what Z2^T N spans,
 * unless constraints are redundant. residual: that of the other rows of constraints.
 * Failures: callbacks, structure, SFDAE_NOT_STARTED before an analysis, those of sfdae_get_jet. */
SFDAE_API int sfdae_get_strangeness_free(sfdae_solver* solver, double t, double* E1, double* A1, double* f1,
                                         double* A2, double* f2, double* residual);

/** Strangeness-free system for changes of a jet, n x (mu+2), for multibody systems n x 2, of any problem: f1 = -Z1^T F,
 * f2 = -Z2^T F_mu there. */
SFDAE_API int sfdae_get_strangeness_free_at(sfdae_solver* solver, double t, const double* jet, double* E1, double* A1,
                                            double* f1, double* A2, double* f2, double* residual);

/** Worst mismatch found by sfdae_check_derivatives, sfdae_check_total_derivatives or
 * sfdae_check_multibody_derivatives. */
typedef struct sfdae_derivative_check {
  size_t size;
  char function;      /**< 'E', 'A' or 'f'; 'F', 'x' (F_x) or 'd' (F_x'); 'G' (g_q), 'T' (g_t), 'C' (gamma) or
                         'H' (eta); 0 if nothing could be compared */
  int order;          /**< of the derivative; >= 1, except for 'x' and 'd' */
  int row, column;    /**< of the entry, from 0; column 0 for f and F */
  double supplied;    /**< by the callback */
  double difference;  /**< finite difference of order - 1, or of F for 'x' and 'd' */
  double error;       /**< |supplied - difference| relative to the size of the function's derivatives */
  double uncertainty; /**< of the difference, relative to that size; much larger errors are mistakes */
  int suspicious;     /**< 1 if error > 100 uncertainty */
} sfdae_derivative_check;
/** Prepares a result of the functions that check derivatives. size: sizeof(sfdae_derivative_check). */
SFDAE_API int sfdae_derivative_check_init(sfdae_derivative_check* check, size_t size);

/** Compares the derivatives of order 1 ... max_order (<= 13) that the callbacks of a linear problem supply near t with
 * finite differences of the order below, and reports the worst mismatch; sfdae_message describes it if it is
 * suspicious. Orders that are not available are skipped. Failures: callbacks; SFDAE_ILLEGAL_ARGUMENT for nonlinear
 * problems. */
SFDAE_API int sfdae_check_derivatives(sfdae_solver* solver, double t, int max_order, sfdae_derivative_check* result);

#ifdef __cplusplus
}
#endif

#include <sfdae/ensemble.h>
#include <sfdae/events.h>
#include <sfdae/expression.h>
#include <sfdae/linearization.h>
#include <sfdae/multibody.h>
#include <sfdae/sensitivity.h>
#include <sfdae/solution.h>

#endif
