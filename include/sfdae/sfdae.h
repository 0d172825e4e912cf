/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - initial value problems for differential-algebraic equations of arbitrary index.
 *
 *     F(t, x(t), x'(t)) = 0   or   E(t) x'(t) = A(t) x(t) + f(t),   m equations, n unknowns, any strangeness index.
 *
 * Life cycle:   fill a problem -> create -> (analyze) -> start -> advance ... advance -> destroy
 *
 * The library finds the strangeness index mu and the characteristic values d, a, u, v from the derivative array,
 * replaces the problem at every point by an equivalent strangeness-free system, makes the initial values
 * consistent, and integrates with BDF of orders 1 to 5 or Radau IIA of orders 1 to 13. Theory: P. Kunkel, V.
 * Mehrmann, Differential-Algebraic Equations: Analysis and Numerical Solution, EMS, 2006. Letters follow that book:
 * E, A, f, mu, d, a, u, v, M, N, g, Z1, Z2, Z3, T2.
 *
 * Here are the life cycle, options, linear problems, integration and inspection. This header includes all others:
 * sfdae/events.h, sfdae/expression.h for equations written as formulas and nonlinear problems, sfdae/multibody.h
 * for mechanical systems, sfdae/ensemble.h for many instances of a problem, sfdae/sensitivity.h for derivatives of the
 * solution by parameters, sfdae/solution.h for the solution over a whole run, sfdae/linearization.h for poles, zeros
 * and transfer functions at a point.
 *
 * Conventions
 *  - Matrices are column-major without padding: entry (i, j) of an m x n matrix is a[i + j * m]. Indices count from
 *    0. Vectors of unknowns have n entries. Times and values have the user's units.
 *  - Functions return a status: SFDAE_OK, a warning (> 0) or a failure (< 0). sfdae_message() explains it in words.
 *    Failures are named here by group: callbacks, structure, values, integration. Any function may also return
 *    SFDAE_ILLEGAL_ARGUMENT, SFDAE_OUT_OF_MEMORY, SFDAE_BUSY or SFDAE_INTERNAL, and any that calls callbacks
 *    SFDAE_STOPPED, which leaves what a failure leaves.
 *  - After a failure outputs are untouched, except where stated (sfdae_advance, sfdae_step). An argument that is
 *    refused with SFDAE_ILLEGAL_ARGUMENT changes nothing at all: an integration under way goes on. After
 *    SFDAE_OUT_OF_MEMORY the solver is still usable: the call may be repeated, and so may any other.
 *  - Structs begin with their size. Call the init function of a struct before anything else, with sizeof(struct) in
 *    your program: later versions of the library may know more members.
 *  - Whatever the library keeps it copies. Only what the callbacks use, functions and the object that `user` points
 *    to, must live as long as the solver.
 *  - The library never prints, exits, installs signal handlers or changes the number of BLAS threads. Small
 *    matrices run fastest with one BLAS thread (OPENBLAS_NUM_THREADS=1): parallelize over problems.
 *  - Different solvers are independent. One solver belongs to one thread at a time; only sfdae_request_stop() may
 *    be called from anywhere. Within its own callbacks a solver answers SFDAE_BUSY, except to sfdae_request_stop
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

/* Warnings: the call did what it could. */
#define SFDAE_STEP_TAKEN 1            /**< sfdae_step: one step taken, tout not reached yet */
#define SFDAE_STOPPED 2               /**< the monitor or sfdae_request_stop stopped the call; it can be repeated */
#define SFDAE_NOT_UNIQUE 3            /**< u > 0: the free part of the solution is held constant */
#define SFDAE_INCONSISTENCY_IGNORED 4 /**< redundant equations contradict each other, ignored as the option says */
#define SFDAE_EVENT 5                 /**< an event: sfdae_get_events reports which */
#define SFDAE_VALUES_CHANGED 6   /**< initial values: what is differentiated had to change beyond the tolerances */
#define SFDAE_INSTANCES_FAILED 7 /**< sfdae_solve_ensemble: some instances failed, as their statuses say */

/* Failures: wrong use. */
#define SFDAE_ILLEGAL_ARGUMENT (-1)
#define SFDAE_OUT_OF_MEMORY (-2)
#define SFDAE_BUSY (-3)          /**< called from within a callback of the same solver */
#define SFDAE_EMPTY_PROBLEM (-4) /**< no equations or no unknowns */
#define SFDAE_NOT_STARTED (-5)   /**< sfdae_start (or sfdae_analyze) has to come first */

/* Failures: callbacks. */
#define SFDAE_CALLBACK_STOPPED (-10)  /**< a callback returned a negative value */
#define SFDAE_CALLBACK_FAILED (-11)   /**< a callback returned a positive value and a smaller step did not help */
#define SFDAE_NOT_FINITE (-12)        /**< a callback returned NaN or Inf and a smaller step did not help */
#define SFDAE_ORDER_MISSING (-13)     /**< a derivative that is needed is not available */
#define SFDAE_WRONG_DERIVATIVES (-14) /**< a derivative contradicts its function: option check_derivatives */
#define SFDAE_WRONG_PATTERN (-15)     /**< an entry of a matrix is not zero, and not in its sparsity pattern */

/* Failures: structure of the problem. */
#define SFDAE_INDEX_TOO_HIGH (-20)          /**< the hypothesis holds at no level up to max_index */
#define SFDAE_RANK_UNCLEAR (-21)            /**< a rank decision is not clear: the data do not determine the index */
#define SFDAE_CHARACTERISTICS_CHANGED (-22) /**< they change; sfdae_get_change reports where */
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
#define SFDAE_TOLERANCE_TOO_SMALL (-43) /**< tolerances below what rounding, or derivatives by differences, allow */
#define SFDAE_ZENO (-44) /**< conditions, or transitions of a hybrid system, change without end at one time */

#define SFDAE_INTERNAL (-99) /**< a defect of the library: please report it */

/** Name of a status, for example "SFDAE_STEP_TOO_SMALL"; "unknown status" for any other number. */
SFDAE_API const char* sfdae_status_name(int status);

/** Version of the library that is running, for example "0.2.0". */
SFDAE_API const char* sfdae_version(void);

/* ---- Linear problems ------------------------------------------------------------------------- */

/* Callbacks return 0 (ok), a positive value (cannot evaluate here: a smaller step is tried) or a negative value
 * (stop at once). All arrays are filled with zeros before the call: write the nonzeros only. */

/** A callback may return this if it cannot provide the derivative order asked for. */
#define SFDAE_ORDER_NOT_AVAILABLE 1001

/** Writes the derivative of the given order (0: the matrix itself) of E or A at t to `matrix`, m x n, plain, without
 * factorials. Orders asked for: 0 ... max_index in the analysis, 0 ... max(mu, 1) later, and mu + 1 for the
 * derivative of initial values and of outputs within Radau steps unless that exceeds max_index. */
typedef int (*sfdae_matrix_function)(double t, int order, double* matrix, void* user);

/** Writes the derivative of the given order (0: the vector itself) of f at t to `vector`, m entries, plain, without
 * factorials. Orders asked for: 0 ... max_index in the analysis, 0 ... max(mu, 1) later, and mu + 1 for the
 * derivative of initial values and of outputs within Radau steps unless that exceeds max_index. Functions of this
 * type write prescribed values, too: order is 0. */
typedef int (*sfdae_vector_function)(double t, int order, double* vector, void* user);

/* Functions that contain an `if` declare its conditions, which are events then, as those of recorded equations are. A
 * problem has num_conditions of them: condition k holds where g_k(t, x, x') > 0. The callbacks of the problem do not
 * compare anything themselves: they read `branches`, an array of the user's with num_conditions numbers, to which the
 * library writes 1 (the condition holds) or 0 before each call. The array lives as long as the solver; solvers that run
 * at the same time need arrays of their own. Within a step branches may be held beyond the zero of g, so the formulas
 * of a branch have to be defined a little beyond it.
 *  - Where E x has to jump at a zero, or a step fails because of it, the step ends there and x moves by impulses of the
 *    new equations (modes.h). sfdae_get_switch lists the zeros.
 *  - Conditions that switch twice within one step are not seen between its ends (max_step). Where both branches lead
 *    back to the zero the call ends with SFDAE_ZENO. Recorded equations have neither limitation. */

/** Writes the switching functions g(t, x, x') of all conditions, num_conditions entries, zeros before the call. x and
 * xdot have n entries each. Zeros of g should not depend on whether the condition holds. Returns as other callbacks. */
typedef int (*sfdae_conditions_function)(double t, const double* x, const double* xdot, double* g, void* user);

/* Callbacks write matrices with all entries, or the entries of sparsity patterns. A pattern has compressed
 * columns: rows of the entries of column j, 0 <= j < n, are row_index[col_start[j]], ..., row_index[col_start[j + 1] -
 * 1], in any order and none twice; col_start has n + 1 numbers, the first 0 and the last the number of entries. All are
 * copied. */
#define SFDAE_MATRICES_DENSE 0 /**< all m x n entries; those beyond the pattern have to be zero, which is checked */
#define SFDAE_MATRICES_COMPRESSED 1 /**< the entries alone, in the order of row_index */
#define SFDAE_MATRICES_DIFFERENCES \
  2 /**< nonlinear: nothing. F_x and F_x' are differences of F: of each column, or of groups of columns of a pattern */

/** Linear problem E(t) x' = A(t) x + f(t). Call sfdae_linear_problem_init first, then set members. */
typedef struct sfdae_linear_problem {
  size_t size;       /**< set by sfdae_linear_problem_init */
  int num_equations; /**< m, 1 ... 5000, or 50000 where compressed matrices are square and nothing is prescribed */
  int num_unknowns;  /**< n, as m; m and n may differ */
  sfdae_matrix_function E;
  sfdae_matrix_function A;
  sfdae_vector_function f; /**< NULL: f = 0 */
  int constant_E;          /**< 1: E does not depend on t; only order 0 is asked for, once. 0 (default): it may */
  int constant_A;          /**< 1: A does not depend on t; both 1: one reduction serves all points */

  /** u > 0 only: components x_j that are prescribed as functions of time, for example inputs of a controlled system.
   * At most u of them, and they must determine the part of the solution that is free. */
  int num_prescribed;                      /**< default 0 */
  const int* prescribed;                   /**< their indices j, 0 <= j < n, no two equal */
  sfdae_vector_function prescribed_values; /**< writes their values at t, num_prescribed entries; order is 0 */

  void* user; /**< handed to every callback */

  /** Names of the equations for messages, copied: NULL (default), or m names, NULL or "" for those without one. What a
   * message says of an equation then includes its name, as in "equation 7 (balance of mass)". */
  const char* const* equation_names;

  /** Sparsity patterns: of both matrices or none (default: NULL). As many equations as unknowns, none prescribed, are
   * then solved by their structure and with sparse matrices as recorded equations are (sfdae_options.structure). An
   * entry that a dense matrix has beyond its pattern ends the call with SFDAE_WRONG_PATTERN, whenever it occurs. */
  int E_entries;          /**< default 0 */
  const int* E_col_start; /**< n + 1 numbers */
  const int* E_row_index; /**< E_entries rows, 0 ... m - 1 */
  int A_entries;
  const int* A_col_start;
  const int* A_row_index;
  int matrices; /**< SFDAE_MATRICES_DENSE (default) or _COMPRESSED */

  /** Conditions on which E, A and f depend (see above). With conditions the problem is solved as a nonlinear one, with
   * dense matrices that are not constant and without prescribed components. */
  int num_conditions;                   /**< 0 (default) ... 1000 */
  sfdae_conditions_function conditions; /**< must be set if num_conditions > 0 */
  int* branches;                        /**< the same; written before each call */
} sfdae_linear_problem;
/** Sets every member to its default. size: sizeof(sfdae_linear_problem). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_linear_problem_init(sfdae_linear_problem* problem, size_t size);

/* ---- Options --------------------------------------------------------------------------------- */

/* How the derivative array is reduced. */
#define SFDAE_REDUCTION_STAGED 0 /**< staged orthogonal elimination: fast, cleanest rank decisions */
#define SFDAE_REDUCTION_SVD 1    /**< singular value decompositions of the whole array, the classical way */

/* How initial values become consistent. */
#define SFDAE_INITIAL_NEAREST 0 /**< the nearest consistent point; what is differentiated stays if it can */
#define SFDAE_INITIAL_FIXED 1   /**< the nearest one that leaves the components marked in `fixed` as they are */
#define SFDAE_INITIAL_ACCEPT 2  /**< taken as given and checked: violations above the tolerances are refused */

/* The quantity w = W x that is differentiated by the integrator in E x' = A x + f. */
#define SFDAE_LEADING_AUTOMATIC 0 /**< projector where rank E is constant, else matrix, else identity */
#define SFDAE_LEADING_PROJECTOR 1 /**< W = E^+ E */
#define SFDAE_LEADING_MATRIX 2    /**< W = E */
#define SFDAE_LEADING_IDENTITY 3  /**< W = I; needs no derivative of E, but may be unstable where ker E rotates */

/* Integration methods. Radau takes fewer and longer steps where the problem is smooth, the more so the tighter the
 * tolerances. */
#define SFDAE_METHOD_BDF 0       /**< orders 1 to 5 */
#define SFDAE_METHOD_RADAU 1     /**< Radau IIA with 1, 3, 5 or 7 stages, orders 1, 5, 9, 13 */
#define SFDAE_METHOD_AUTOMATIC 2 /**< Radau; BDF where steps fail, or are too rough for frequent output, too often */

/* What x is at outputs within steps. Points of steps themselves satisfy the constraints as far as the iteration for
 * nonlinear equations went. */
#define SFDAE_OUTPUT_CONSISTENT 0   /**< all constraints, hidden ones included, hold to rounding */
#define SFDAE_OUTPUT_INTERPOLATED 1 /**< the method's polynomial alone, for curves; constraints within tolerances */

/* Whether the derivative array follows what recorded equations contain. */
#define SFDAE_STRUCTURE_OFF 0       /**< it has all its rows */
#define SFDAE_STRUCTURE_AUTOMATIC 1 /**< rows that are not needed are left out, large ones are sparse */
#define SFDAE_STRUCTURE_REQUIRED 2  /**< the minimal extension with sparse matrices, or a failure */

/* Conditions on which equations depend. */
#define SFDAE_CONDITIONS_SMOOTH 0 /**< their zeros are not looked for: the error test alone chooses the steps */
#define SFDAE_CONDITIONS_EVENTS 1 /**< steps end at zeros where something jumps, or that depend on t alone */

/** What is reported to the monitor. */
typedef struct sfdae_progress {
  size_t size;      /**< of this struct in the library that calls */
  double t;         /**< point reached */
  double step;      /**< step size that led there, negative when integrating backward */
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

  /** Index analysis. Derivatives that callbacks do not provide (SFDAE_ORDER_NOT_AVAILABLE) can be computed from
   * order 0 by differences, up to order 6, each entry to the accuracy that its own values allow. Where that is not
   * enough for the tolerances (above all for mu >= 3 and tolerances below 1e-8), at the start, too, steps and outputs
   * end with SFDAE_TOLERANCE_TOO_SMALL, the component and its error in the message. */
  int max_index;              /**< highest strangeness index tried, default 5; 0 ... 12 */
  int reduction;              /**< SFDAE_REDUCTION_STAGED (default) or _SVD */
  double rank_tol;            /**< in (0, 1): values below rank_tol * norm of the data, in balanced units, count as
                                 zero. Default 0: the library judges by propagated rounding errors and, where norms
                                 are not clear in two systems of units, by a certificate (sfdae_certify) */
  double time_scale;          /**< unit of time of derivatives (> 0), rounded to a power of two. Default 0: chosen */
  int difference_derivatives; /**< 1: differences are allowed. Default 0: SFDAE_ORDER_MISSING */
  double difference_step;     /**< spacing of the points used for them, at most (> 0): eight of these are the whole
                                 interval of 13 Chebyshev points; default 0: chosen */

  /** Initial values. Where x violates the constraints, unknowns without a derivative (multipliers, currents; the kernel
   * of E or F_x') adapt first. Only what then remains moves the others, and as little as possible:
   * sum (change_i / (rtol |x_i| + atol))^2 is smallest; SFDAE_VALUES_CHANGED if that is beyond the tolerances
   * (_NEAREST). Weights make sum (change_i / w_i)^2 of all unknowns smallest instead (a local minimum where
   * constraints are not linear), without that warning; of multibody systems that of positions, then that of
   * velocities. Where _NEAREST would move what is differentiated, or the analysis fails, since the equations are
   * singular at the guess of unknowns without a derivative, guesses beside it are tried. */
  int initial_values;            /**< SFDAE_INITIAL_NEAREST (default), _FIXED or _ACCEPT */
  const int* fixed;              /**< for _FIXED: n flags, 1 where x_i must not change */
  const double* initial_weights; /**< NULL or n positive numbers w_i */

  /** Redundant equations, v > 0. */
  int ignore_inconsistency; /**< 1: go on (SFDAE_INCONSISTENCY_IGNORED) where they contradict. Default 0: stop */
  double consistency_tol;   /**< relative size of a contradiction that counts, default 1e-8; > 0, < 1 */

  /** Integration. */
  int max_order;       /**< highest BDF order, 1 ... 5 (default) */
  double initial_step; /**< size of the first step; default 0: chosen */
  /** Largest step; default 0: no limit. Steps notice what inputs do within them where equations are recorded. Of
   * functions of the user's, nothing is known between the points at which they are called: steps that grow while
   * nothing happens may lead beyond the next pulse of a source, unless this is less than it is long. */
  double max_step;
  int use_stop_time; /**< 1: nothing is evaluated beyond stop_time. Default 0 */
  double stop_time;
  long max_steps;   /**< attempted steps in one call, default 100000; >= 1 */
  int leading_term; /**< SFDAE_LEADING_AUTOMATIC (default), ... */

  sfdae_monitor_function monitor; /**< NULL: none */
  void* monitor_user;             /**< handed to the monitor */

  /** The method, and the numbers of stages that Radau may use: 1, 3, 5 or 7, min_stages <= max_stages, that number
   * always if they are equal (1 alone is for rough problems: errors add up). Changes take effect with the next
   * sfdae_start. */
  int method;                 /**< SFDAE_METHOD_BDF (default), ... */
  int min_stages, max_stages; /**< defaults 1 and 7 */

  /** 1: xdot is in/out for sfdae_start and sfdae_make_consistent: a guess of x' that a nonlinear problem follows where
   * F(t, x, x') = 0 allows several x' (zeros: none; linear and multibody problems determine x' and ignore it).
   * Default 0: xdot is out. */
  int xdot_is_guess;

  /** SFDAE_OUTPUT_CONSISTENT (default): an output costs a reduction of a linear problem, an iteration with kept factors
   * of others, and more if x' is asked for. _INTERPOLATED: it costs next to nothing; x' is the slope of the polynomial.
   * Where the polynomial of x is not accurate to within the tolerances, where there are no differential equations
   * and where there are events, outputs are consistent all the same. */
  int output;

  /** 1 (default): derivatives that callbacks supply are compared with the functions once with every analysis, by few
   * evaluations on the side of t that the integration goes to. Where one contradicts its function beyond doubt, on two
   * scales of time or space and by a hundredth at least, SFDAE_WRONG_DERIVATIVES names function, order, row, column and
   * both values. 0: they are not.
   *  - Linear problems: E, A, f, orders 1 ... mu + 1, as far as available. Total derivatives of nonlinear problems:
   *    F along the solution and F_x, F_x' in one direction at random. Multibody systems: g_q and g_t in one direction
   *    at random, gamma and eta along consistent velocities, at the consistent start values.
   *  - Not seen: mistakes of less than a hundredth or in noise (of single precision, of tables), in entries that vary
   *    faster than a 1e-8th of the interval to `toward`, that are right near t, or of values that are themselves
   *    wrong; E and A that are wrongly called constant; M, f, H, S of multibody systems, which are not differentiated
   *    by callbacks. sfdae_check_derivatives and its kind look at both sides, at any point, more closely.
   *  - Failures of evaluations that only this needs are ignored, but for negative return values. */
  int check_derivatives;

  /** Recorded equations, as many as unknowns: which unknowns and derivatives they contain tells how often each of
   * them has to be differentiated (J. D. Pryce, BIT 41, 2001), if nothing cancels; sfdae_get_structure has the details.
   * SFDAE_STRUCTURE_AUTOMATIC (default): where the numbers at the start agree, rows of the derivative array that are
   * not needed are left out, and from some 100 columns of the array on (20 where nothing has to be differentiated)
   * all matrices are sparse; else the whole array is taken, or, with more than 5000 unknowns, the failure is
   * reported. Results are the same within the tolerances. With sparse matrices, equations that depend on others
   * wherever one looks, as those of nodes on both sides of a capacitor do, are replaced by sums in which numbers
   * cancel, if constant factors do it. Where numbers cancel at a later time only, the whole array may go on and the
   * other end with SFDAE_CHARACTERISTICS_CHANGED. SFDAE_STRUCTURE_REQUIRED: always the rows that are needed, with
   * sparse matrices; SFDAE_RANK_UNCLEAR where the numbers do not agree, SFDAE_ILLEGAL_ARGUMENT for problems that have
   * no structure: functions without patterns, prescribed components, differentiations, other numbers of equations
   * than of unknowns. SFDAE_STRUCTURE_OFF: always the whole array, as for these.
   * Recorded multibody systems: local coordinates with dense matrices, or first-order equations with sparse ones.
   * SFDAE_STRUCTURE_AUTOMATIC takes these from 200 unknowns (q, v, lambda, kappa) on, where an equation contains at
   * most a tenth of them on average, no constraint is redundant and the numbers agree; coordinates is without effect
   * then. A singular configuration ends the integration as ever; the values after it are not determined. */
  int structure;

  /** Conditions of recorded equations (choose, comparisons, abs, min, max, sign, floor, remainders, tables), and those
   * that callbacks declare. SFDAE_CONDITIONS_EVENTS (default): steps end at the zeros of conditions on t alone, and at
   * those of others where E x has to jump; x moves by impulses there, or along the surface of the zeros (modes.h).
   * SFDAE_CONDITIONS_SMOOTH: the equations count as smooth, and the error test alone chooses the steps, for those who
   * know that their conditions are kinks which no equation differentiates. Results are wrong without a warning where
   * they are not. Breakpoints that are set are kept. */
  int conditions;
} sfdae_options;
/** Sets every member to its default. size: sizeof(sfdae_options). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_options_init(sfdae_options* options, size_t size);

/* ---- Solver ---------------------------------------------------------------------------------- */

/** A problem with its options, its analysis and its integration. */
typedef struct sfdae_solver sfdae_solver;

/** Creates a solver of a linear problem. problem and options (NULL: defaults) are copied. On failure *solver is
 * NULL.
 * Failures: SFDAE_ILLEGAL_ARGUMENT, SFDAE_EMPTY_PROBLEM; sfdae_message(NULL) says in words what is wrong. */
SFDAE_API int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem,
                                  const sfdae_options* options);

/** Checks a linear problem and its options (NULL: defaults) without creating a solver. Returns what
 * sfdae_create_linear would and writes in words what is wrong, "" if nothing is, to `text`, at most `length`
 * characters with the final zero (text NULL with length 0 is allowed). */
SFDAE_API int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text,
                                 size_t length);

/** Frees the solver and sets *solver to NULL. NULL and *solver == NULL are allowed. SFDAE_BUSY from a callback and for
 * a mode of a hybrid system that still exists, which changes nothing. */
SFDAE_API int sfdae_destroy(sfdae_solver** solver);

/** Replaces the options; the point reached stays. A change of max_index, reduction, rank_tol, time_scale,
 * difference_derivatives, difference_step, leading_term or structure ends the integration and makes a new analysis
 * necessary: sfdae_start has to follow. SFDAE_ILLEGAL_ARGUMENT for options out of range; the old ones then stay. */
SFDAE_API int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options);

/** What the last call on this solver had to say: what, where, with which numbers, what to do next. "" after
 * SFDAE_OK. Functions that only read (a const solver, sfdae_get_...) leave the text alone where it explains the
 * failure of an earlier call, and else say why they fail. It lives until the next call.
 *
 * NULL: why the last of the functions sfdae_create_... that this thread called has failed, "" if it has not; it lives
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

/** Detects the strangeness index of a linear problem at t and at a nearby point in the direction of `toward` (the
 * end of the interval of interest, toward != t). The larger one counts and stays fixed until the next analysis.
 * `result` may be NULL. The point reached is forgotten: sfdae_start has to follow.
 * Warnings: SFDAE_NOT_UNIQUE. Failures: callbacks, structure; SFDAE_ILLEGAL_ARGUMENT for nonlinear problems, which
 * need sfdae_analyze_at. After a failure there is no analysis, but its rank decisions can be read; an argument that
 * is refused changes nothing. */
SFDAE_API int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result);

/** Detects the strangeness index of any problem along the solution through a point near x (n values, which need not
 * be consistent and are not changed; linear problems do not look at them), at t and at a nearby point in the
 * direction of `toward`, toward != t. sfdae_start does this where it has not been done. `result` may be NULL. The
 * point reached is forgotten: sfdae_start has to follow.
 * Warnings: SFDAE_NOT_UNIQUE. Failures: callbacks, structure, SFDAE_NO_CONSISTENT_VALUES. After a failure there is
 * no analysis, but its rank decisions can be read; an argument that is refused changes nothing. */
SFDAE_API int sfdae_analyze_at(sfdae_solver* solver, double t, double toward, const double* x,
                               sfdae_characteristics* result);

/** The characteristic values in use. SFDAE_NOT_STARTED before an analysis. */
SFDAE_API int sfdae_get_characteristics(const sfdae_solver* solver, sfdae_characteristics* result);

/* Which matrix a rank decision was about. */
#define SFDAE_DECISION_STAGE 0 /**< pivots of a diagonal block of the derivative array */
#define SFDAE_DECISION_A2 1    /**< the constraints A^ x + f^ = 0: rank a */
#define SFDAE_DECISION_ET2 2   /**< E T2: rank d */
#define SFDAE_DECISION_ARRAY 3 /**< the whole array M (SVD reduction) */
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
  double noise;     /**< what rounding errors may amount to */
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

/** Where the characteristic values changed, after SFDAE_CHARACTERISTICS_CHANGED; else SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_get_change(const sfdae_solver* solver, sfdae_change* result);

/* ---- Initial values -------------------------------------------------------------------------- */

/** Makes x (n values, in: guess, out: consistent) consistent at t as the options say and computes the derivative
 * x'(t) of the solution through it (xdot: n values, may be NULL; minimum norm in directions that the problem leaves
 * free). xdot is a guess before if the option xdot_is_guess says so. Analyzes first, forward from t, if there is no
 * analysis. The point reached is unaffected.
 * Warnings: SFDAE_INCONSISTENCY_IGNORED, SFDAE_VALUES_CHANGED, SFDAE_NOT_UNIQUE, the first that applies;
 * sfdae_message names all. Failures: callbacks, structure, values; SFDAE_TOLERANCE_TOO_SMALL, with the values found
 * in x and xdot, where derivatives by differences make them less accurate than the tolerances ask for. */
SFDAE_API int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot);

/** What the last sfdae_start or sfdae_make_consistent did to the initial values. */
typedef struct sfdae_initial_report {
  size_t size;
  double t;
  double residual_before; /**< 2-norm of A2 x + f2 for the values given, rows of A2 orthonormalized: the distance to
                             the nearest consistent point */
  double residual_after;  /**< distance of the values returned */
  double largest_change;  /**< max |change_i|, 0 if nothing changed */
  int component;          /**< where it happened, -1 if nothing changed */
  int derivative_exact; /**< 1: x' from the derivative array; 0: the derivative of the constraints that enters it was
                             computed by differences */
} sfdae_initial_report;
/** Prepares a result of sfdae_get_initial_report. size: sizeof(sfdae_initial_report). */
SFDAE_API int sfdae_initial_report_init(sfdae_initial_report* report, size_t size);

/** What was done to the initial values. SFDAE_NOT_STARTED before sfdae_start and sfdae_make_consistent. */
SFDAE_API int sfdae_get_initial_report(const sfdae_solver* solver, sfdae_initial_report* result);

/* ---- Integration ----------------------------------------------------------------------------- */

/** Starts or restarts the integration at (t, x): makes x (n values, in: guess, out: consistent) consistent as the
 * options say and computes x' (xdot: n values, may be NULL; a guess before with xdot_is_guess). `toward`, not equal to
 * t, sets the direction; its distance sets the scale of the first step. Analyzes if that has not happened or was made
 * for the other direction; a restart on an analyzed solver needs no new analysis.
 * Warnings: SFDAE_INCONSISTENCY_IGNORED, SFDAE_VALUES_CHANGED, SFDAE_NOT_UNIQUE, the first that applies;
 * sfdae_message names all. Failures: callbacks, structure, values;
 * SFDAE_CHARACTERISTICS_CHANGED if the values known do not hold at t: call sfdae_analyze. After these nothing is
 * started, and an integration that was under way is lost; an argument that is refused changes nothing. */
SFDAE_API int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot);

/** Integrates to tout and returns there: *t = tout, x (n values), xdot (n values, may be NULL). tout must lie in the
 * direction of integration, at or after the last point returned and not beyond stop_time. Steps may go past tout; a
 * later call with a tout within the last step only interpolates.
 *
 * x satisfies all constraints, hidden ones included, to rounding. xdot is the slope of the method's polynomial,
 * corrected toward the equations: its error is about that of x over the step size. Within Radau steps xdot is exact
 * where derivatives of order mu + 1 are available, else less accurate. NULL for xdot saves its cost. The option
 * `output` has cheaper outputs. Steps do not depend on tout, except those of Radau within which its polynomial would
 * not be accurate: these become shorter or end at tout.
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
 * before or after the point returned last, which stays. x (n values) and xdot (n values, may be NULL) are what the
 * option `output` says. SFDAE_ILLEGAL_ARGUMENT for other t.
 * Failures: callbacks, integration, SFDAE_CHARACTERISTICS_CHANGED, SFDAE_INCONSISTENT_EQUATIONS,
 * SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_interpolate(sfdae_solver* solver, double t, double* x, double* xdot);

/** Counts since sfdae_start, except where stated. */
typedef struct sfdae_statistics {
  size_t size;
  long steps;                                       /**< accepted */
  long error_failures;                              /**< attempts rejected by the error test */
  long other_failures;                              /**< attempts rejected otherwise: callbacks, singular matrices */
  long reductions;                                  /**< strangeness-free systems computed */
  long factorizations;                              /**< LU factorizations of the step's matrix */
  long evaluations_E, evaluations_A, evaluations_f; /**< callback calls but for check_calls, since creation */
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
  double rounding;  /**< nonlinear: largest rounding error of a component along the way, as the equations cause it,
                           over the tolerance used for it; above 1 it was tested against that error instead */
  long check_calls; /**< by the option check_derivatives, in no other count, since creation: callback calls of linear
                         and nonlinear problems, points of multibody systems */
  long switches; /**< of conditions, see sfdae_get_switch; since the start or the checkpoint; 0 of hybrid systems */
  long jumps;    /**< times of switches at which x jumps by impulses */
} sfdae_statistics;
/** Prepares a result of sfdae_get_statistics. size: sizeof(sfdae_statistics). */
SFDAE_API int sfdae_statistics_init(sfdae_statistics* statistics, size_t size);

/** Counts and step sizes of the integration under way; without one all but evaluations and linearizations are 0. */
SFDAE_API int sfdae_get_statistics(const sfdae_solver* solver, sfdae_statistics* result);

/* ---- Checkpoints ----------------------------------------------------------------------------- */

/* A checkpoint is the analysis and the state of an integration as an array of doubles, to be kept, written to a
 * file, or handed to another process. Restored, the integration goes on as if nothing had happened, in every bit if
 * binary, BLAS, processor and the environment variable SFDAE_INSTRUCTIONS (portable or avx2: no faster instructions of
 * the processor are used) are the same. The numbers are plain doubles (infinity may be among them): copy or print them
 * with 17 digits as you like. The problem and the options are not in it, but it knows which they were; sensitivities
 * are in it, with all that they depend on. */

/** Number of doubles that sfdae_save_checkpoint writes now; it changes from step to step. SFDAE_NOT_STARTED if there
 * is no integration. */
SFDAE_API int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length);

/** Writes a checkpoint to an array of `length` doubles, at least as many as are needed. SFDAE_NOT_STARTED if there
 * is no integration. */
SFDAE_API int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length);

/** Continues from a checkpoint of `length` doubles instead of sfdae_start: sfdae_advance is next. The solver has to be
 * created with the problem that the checkpoint was made with, and asked for the sensitivities that are in it. Method,
 * structure, max_index, reduction, rank_tol, time_scale, difference_derivatives, difference_step, leading_term and
 * the values of parameters have to be as they were; other options, such as tolerances and limits, may differ.
 * Recorded equations are compared operation by operation, patterns entry by entry. Your own functions cannot be
 * compared: give the same ones. No callback of a linear problem is called; a nonlinear one is linearized as it was.
 * An integration under way is replaced. SFDAE_ILLEGAL_ARGUMENT if the checkpoint is damaged or is that of another
 * problem or version, or one of these options or parameters differs, which the message names with both values. After
 * any failure everything is as before, and an integration under way continues. */
SFDAE_API int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length);

/* ---- Inspection ------------------------------------------------------------------------------ */

/** Writes the diagnostics report as text: index analysis with every rank decision, initial values, integration. At
 * most length characters, final zero included (text NULL with length 0 is allowed). *needed (may be NULL): length
 * of the whole text + 1. */
SFDAE_API int sfdae_report(const sfdae_solver* solver, char* text, size_t length, size_t* needed);

/** Certifies the ranks of the analysis: the elimination runs once more on copies of the data whose entries are
 * perturbed by 1e-12 of themselves (zeros stay), in units that are balanced. What stays put is a value, what moves is
 * an error, whatever its size. *distance (may be NULL): the smallest relative change of the data, entry by entry,
 * that gives other characteristic values, about; 1 is the most that is said. sfdae_report says it, too, from then on.
 * Nonlinear problems: at the point reached. Evaluates callbacks. Failures: callbacks; SFDAE_NOT_STARTED before an
 * analysis; SFDAE_RANK_UNCLEAR if the certificate does not confirm the values; SFDAE_ILLEGAL_ARGUMENT for multibody
 * systems, whose ranks are those of the constraints. */
SFDAE_API int sfdae_certify(sfdae_solver* solver, double* distance);

/* The theory's objects: derivative array, projectors, strangeness-free system.
 *
 * Those of linear problems depend on t alone. Those of others belong to a jet, that is t, x, x', ..., x^(l+1), in
 * which F and its derivatives F' = dF/dt, ..., F^(l) along the jet are linearized: they are said of changes dx of x
 * and dy of y = (x', ..., x^(l+1)),
 *
 *     M dy = N dx + g,   M = dF_l/dy,   N = -dF_l/dx,   g = -F_l,   F_l = (F, F', ..., F^(l)),
 *
 * with plain derivatives, without factorials. Of a linear problem, F = E x' - A x - f, these are the same M and N at
 * any jet, and g at the jet 0, where dx = x and dy = y. In memory a jet is an n x (l+2) array, x first.
 *
 * Multibody systems are taken as x = (q, v, lambda, kappa) and F = (q' - S v, M v' - f + G^T lambda + H^T kappa, g,
 * H v + h), m = n.
 *
 * Functions whose name ends in _at take a jet from the user, which need not be consistent; what is said of Z2, Z3 and
 * T2 then holds as far as F_l = 0 does. The others, for nonlinear problems and multibody systems, take the jet
 * of the solution at t, which has to lie within the last step taken, as for sfdae_interpolate, or be the start before
 * the first step, or the point of the analysis before a start. Nothing of an integration is disturbed.
 *
 * Where equations are differentiated a limited number of times (sfdae_nonlinear_problem.differentiations), rows of
 * the array that are left out are zero, in Z2 and Z3 as well. */

/** Writes the jet of level l, 0 ... 12, through (t, x): x and derivatives x', ..., x^(l+1) with F_k = 0, k = max(l,
 * mu). Directions that these equations leave open are as near as possible to those of the point reached. x: n values,
 * consistent, or NULL for the solution at t. jet: n x (l+2).
 * Callbacks of multibody systems: level 0 only, with lambda' and kappa' by differences; else SFDAE_ORDER_MISSING.
 * Failures: callbacks, SFDAE_NOT_STARTED before an analysis, and for x = NULL those of sfdae_interpolate;
 * SFDAE_INCONSISTENT_VALUES if there is no such jet. */
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

/** Projectors at t, with orthonormal columns, for the array of level mu:
 *   Z2 ((mu+1)m x a):  Z2^T M = 0, A2 = Z2^T N has full row rank;   Z3 ((mu+1)m x vhat): Z3^T [M N] = 0;
 *   T2 (n x (n-a)):    A2 T2 = 0;                                   Z1 (m x d): spans the range of E T2, E = F_x'.
 * *vhat, the number of columns of Z3, is at most (mu+1)m - a. All pointers may be NULL; for the sizes ask
 * sfdae_get_characteristics, and call with all matrices NULL for vhat.
 * Multibody systems: Z1 and T2 are those of the minimal extension. Z2 and Z3 need the array: ask for them, and for
 * vhat, for recorded formulas only (SFDAE_ORDER_MISSING). If r constraints are redundant, the array does not
 * determine r multipliers: the last r columns of Z2 are zero.
 * Failures: callbacks, structure, SFDAE_NOT_STARTED before an analysis, those of sfdae_get_jet. */
SFDAE_API int sfdae_get_projectors(sfdae_solver* solver, double t, double* Z1, double* Z2, double* Z3, double* T2,
                                   int* vhat);

/** Projectors at a jet, n x (mu+2): those of sfdae_get_projectors. Of multibody systems that are asked for Z1 and T2
 * alone, two columns are enough. */
SFDAE_API int sfdae_get_projectors_at(sfdae_solver* solver, double t, const double* jet, double* Z1, double* Z2,
                                      double* Z3, double* T2, int* vhat);

/** Strangeness-free system at t, E1, A1 d x n, A2 a x n, for the projectors of sfdae_get_projectors:
 *   E1 = Z1^T F_x', A1 = -Z1^T F_x, f1 = -Z1^T F:   E1 dx' = A1 dx + f1   (d rows)
 *   A2 = Z2^T N,    f2 = -Z2^T F_mu:                      0 = A2 dx + f2   (a rows)
 * at the jet of the solution. Linear problems: E1 x' = A1 x + f1, 0 = A2 x + f2 with E1 = Z1^T E, A1 = Z1^T A, f1 =
 * Z1^T f, f2 = Z2^T g. [E1; A2] is regular for u = 0. *residual: max norm of Z3^T g, the contradiction of redundant
 * equations. Any pointer may be NULL.
 * Multibody systems, callbacks as well: 0 = A2 dx + f2 are independent rows of g = 0, then of G v + g_t = 0 and H v +
 * h = 0, then (lambda, kappa) = mu(t, q, v), all multipliers, all with the sign of -F; they span what Z2^T N spans,
 * unless constraints are redundant. residual: that of the other rows of constraints.
 * Failures: callbacks, structure, SFDAE_NOT_STARTED before an analysis, those of sfdae_get_jet. */
SFDAE_API int sfdae_get_strangeness_free(sfdae_solver* solver, double t, double* E1, double* A1, double* f1,
                                         double* A2, double* f2, double* residual);

/** Strangeness-free system for changes of a jet, n x (mu+2), of multibody systems n x 2, of any problem: f1 = -Z1^T F,
 * f2 = -Z2^T F_mu there. */
SFDAE_API int sfdae_get_strangeness_free_at(sfdae_solver* solver, double t, const double* jet, double* E1, double* A1,
                                            double* f1, double* A2, double* f2, double* residual);

/** Worst mismatch found by sfdae_check_derivatives, sfdae_check_total_derivatives or
 * sfdae_check_multibody_derivatives. */
typedef struct sfdae_derivative_check {
  size_t size;
  char function;      /**< 'E', 'A' or 'f'; 'F', 'x' (F_x) or 'd' (F_x'); 'G' (g_q), 'T' (g_t), 'C' (gamma) or
                         'H' (eta); 0 if nothing could be compared */
  int order;          /**< of the derivative; >= 1, but for 'x' and 'd' */
  int row, column;    /**< of the entry, from 0; column 0 for f and F */
  double supplied;    /**< by the callback */
  double difference;  /**< by differences of order - 1, or of F for 'x' and 'd' */
  double error;       /**< |supplied - difference| relative to the size of the function's derivatives */
  double uncertainty; /**< of the differences, relative to that size; errors far above it are mistakes */
  int suspicious;     /**< 1 if error > 100 uncertainty */
} sfdae_derivative_check;
/** Prepares a result of the functions that check derivatives. size: sizeof(sfdae_derivative_check). */
SFDAE_API int sfdae_derivative_check_init(sfdae_derivative_check* check, size_t size);

/** Compares the derivatives of order 1 ... max_order (<= 13) that the callbacks of a linear problem supply near t
 * with differences of the order below, and reports the worst mismatch; sfdae_message says it in words if it is
 * suspicious. Orders that are not available are passed over. Failures: callbacks; SFDAE_ILLEGAL_ARGUMENT for
 * nonlinear problems. */
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
