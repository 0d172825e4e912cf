/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - equations written as formulas, and nonlinear problems.
 *
 * Equations are written once: a user-supplied function applies the operations below to t, x and x'; the library records
 * them, and computes values, Taylor coefficients and exact Jacobians from the record (automatic differentiation). The
 * function is called once, when the solver is created. It may contain loops and call functions, but cannot branch on
 * values: see sfdae_choose. Example, F = x1' - x2^2:
 *
 *     residual[0] = sfdae_subtract(xdot[0], sfdae_multiply(x[1], x[1]));
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_EXPRESSION_H
#define SFDAE_EXPRESSION_H

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Expressions ----------------------------------------------------------------------------- */

/** A recording under way. It ends when the user's function returns. */
typedef struct sfdae_record sfdae_record;

/** A number, or a part of a formula that is being recorded. Passed by value; only the library writes the members. */
typedef struct sfdae_expression {
  sfdae_record* record; /**< NULL: the plain number `value` */
  double value;
  int node;
} sfdae_expression;

/* The functions below never return an error. Operations on plain numbers give plain numbers. A mistake (expressions of
 * different recordings mixed, an entry that was not written, a number that is not finite, as log(-1)) makes the
 * recording call fail with SFDAE_ILLEGAL_ARGUMENT and a message that names the first one. */

/** The plain number `value`, finite. */
SFDAE_API sfdae_expression sfdae_number(double value);

/** A parameter: a constant with a name, not empty, whose finite value can be changed later by sfdae_set_parameter
 * without a new recording. The same name again gives the same parameter, with its first value. */
SFDAE_API sfdae_expression sfdae_parameter(sfdae_record* record, const char* name, double value);

SFDAE_API sfdae_expression sfdae_add(sfdae_expression a, sfdae_expression b);      /**< a + b */
SFDAE_API sfdae_expression sfdae_subtract(sfdae_expression a, sfdae_expression b); /**< a - b */
SFDAE_API sfdae_expression sfdae_multiply(sfdae_expression a, sfdae_expression b); /**< a b */
SFDAE_API sfdae_expression sfdae_divide(sfdae_expression a, sfdae_expression b);   /**< a / b, b not 0 */
SFDAE_API sfdae_expression sfdae_negate(sfdae_expression a);                       /**< -a */

/** a^b. For an integer number b up to 64 in size these are products, for every a. Else a > 0; a = 0 is allowed if the
 * derivatives exist. */
SFDAE_API sfdae_expression sfdae_power(sfdae_expression a, sfdae_expression b);

/* Angles are in radians. */
SFDAE_API sfdae_expression sfdae_sqrt(sfdae_expression a);                      /**< a >= 0, no derivative at 0 */
SFDAE_API sfdae_expression sfdae_exp(sfdae_expression a);                       /**< e^a */
SFDAE_API sfdae_expression sfdae_log(sfdae_expression a);                       /**< natural logarithm, a > 0 */
SFDAE_API sfdae_expression sfdae_log10(sfdae_expression a);                     /**< decimal logarithm, a > 0 */
SFDAE_API sfdae_expression sfdae_sin(sfdae_expression a);                       /**< sine */
SFDAE_API sfdae_expression sfdae_cos(sfdae_expression a);                       /**< cosine */
SFDAE_API sfdae_expression sfdae_tan(sfdae_expression a);                       /**< tangent */
SFDAE_API sfdae_expression sfdae_asin(sfdae_expression a);                      /**< no derivative at -1 and 1 */
SFDAE_API sfdae_expression sfdae_acos(sfdae_expression a);                      /**< no derivative at -1 and 1 */
SFDAE_API sfdae_expression sfdae_atan(sfdae_expression a);                      /**< between -pi/2 and pi/2 */
SFDAE_API sfdae_expression sfdae_atan2(sfdae_expression y, sfdae_expression x); /**< angle of the point (x, y) */
SFDAE_API sfdae_expression sfdae_sinh(sfdae_expression a);                      /**< hyperbolic sine */
SFDAE_API sfdae_expression sfdae_cosh(sfdae_expression a);                      /**< hyperbolic cosine */
SFDAE_API sfdae_expression sfdae_tanh(sfdae_expression a);                      /**< hyperbolic tangent */

/* Functions with discontinuities (kinks or jumps): their derivatives are those of the active branch. Steps end where
 * such functions of t switch; if E x has to jump there, x jumps by impulses (modes.h). If derivatives of equations are
 * needed, conditions on x at which E x has to jump are located in the same way, and so are those at which an algebraic
 * equation has no solution near the last one; if floor, modulo or tables of x make E x jump, the call ends with
 * SFDAE_STEP_TOO_SMALL. If both branches of a condition lead back to its zero, x slides along that surface: the
 * equations become continuous within a tenth of the tolerances; SFDAE_ZENO if that is not possible. Steps across other
 * switches of functions of x are rejected until they are short enough for the error test; to end a step there, use an
 * event (sfdae_set_events). */
SFDAE_API sfdae_expression sfdae_abs(sfdae_expression a);                     /**< |a| */
SFDAE_API sfdae_expression sfdae_min(sfdae_expression a, sfdae_expression b); /**< the smaller one */
SFDAE_API sfdae_expression sfdae_max(sfdae_expression a, sfdae_expression b); /**< the larger one */

SFDAE_API sfdae_expression sfdae_sign(sfdae_expression a);  /**< 1 if a > 0, 0 if a = 0, -1 if a < 0 */
SFDAE_API sfdae_expression sfdae_floor(sfdae_expression a); /**< the largest integer up to a */
/** a - b floor(a / b), b not 0: between 0 and b, for inputs of period b */
SFDAE_API sfdae_expression sfdae_modulo(sfdae_expression a, sfdae_expression b);

/* Comparisons are 1 if they hold, else 0. Any number > 0 is true, as for sfdae_choose. */
SFDAE_API sfdae_expression sfdae_less(sfdae_expression a, sfdae_expression b);          /**< a < b */
SFDAE_API sfdae_expression sfdae_less_equal(sfdae_expression a, sfdae_expression b);    /**< a <= b */
SFDAE_API sfdae_expression sfdae_greater(sfdae_expression a, sfdae_expression b);       /**< a > b */
SFDAE_API sfdae_expression sfdae_greater_equal(sfdae_expression a, sfdae_expression b); /**< a >= b */
SFDAE_API sfdae_expression sfdae_and(sfdae_expression a, sfdae_expression b); /**< 1 if both are true, else 0 */
SFDAE_API sfdae_expression sfdae_or(sfdae_expression a, sfdae_expression b);  /**< 1 if one is true, else 0 */
SFDAE_API sfdae_expression sfdae_not(sfdae_expression a);                     /**< 1 if a is not true, else 0 */

/** a if c > 0, else b; the operand not chosen need not be defined. */
SFDAE_API sfdae_expression sfdae_choose(sfdae_expression c, sfdae_expression a, sfdae_expression b);

/** The partial derivative of the formula a with respect to a variable: t, an unknown, the derivative of an unknown (all
 * as passed to the function that writes equations) or a parameter. Example: entry j of G^T lambda of constraints g,
 * without writing G = g_q, is the derivative of lambda_1 g_1 + ... with respect to q[j]. The derivatives of one formula
 * with respect to all variables cost little more than one of them if they are requested consecutively. */
SFDAE_API sfdae_expression sfdae_derivative(sfdae_expression a, sfdae_expression variable);

/** The total time derivative of a formula in t and x: a_t + a_x x'. It is a mistake if a depends on x', since x'' is no
 * variable, and in equations of mechanical systems, whose formulas do not contain q' and v'. */
SFDAE_API sfdae_expression sfdae_time_derivative(sfdae_expression a);

/** A table: the value at a of the spline of degree 1, 3, 5 or 7 through `count` points (x[i], y[i]), which are
 * copied; x increasing, at least degree + 1 points. The spline has degree - 1 continuous derivatives, and passes
 * through the points; its knots are the x[i], for degrees above 1 without the first and last (degree - 1) / 2 inside
 * ("not a knot"): polynomials of that degree are reproduced. At a knot the derivative of order `degree` is that after
 * it. Evaluations outside of the data fail, as log(-1) does. For constant extrapolation write the table of min(max(a,
 * x[0]), x[count - 1]), for periodic data that of modulo(a - x[0], period) + x[0].
 * If the argument depends on t alone, steps end where it reaches a knot, so that no kink of an input is missed. If the
 * first derivative (degree 1, the end of a period), the value (a condition) or a derivative on which x depends (degree
 * up to mu) jumps, a step as short as rounding errors of t leads across it; outputs there are those after the jump. If
 * E x has to jump, as the velocities of a position drive of
 * degree 1 do, it jumps by impulses (modes.h). */
SFDAE_API sfdae_expression sfdae_table(sfdae_expression a, int degree, int count, const double* x, const double* y);

/** Writes all partial derivatives of one order of a function of k arguments: order 0 the value; order 1 the gradient, k
 * entries; order 2 the k x k matrix of second derivatives; in general k^order entries; the derivative with respect to
 * the arguments i, j, ... has the index i + j k + ... The array is filled with zeros before the call. Called with
 * finite arguments, from several threads at a time in ensembles; equal arguments have to give equal results. Requested
 * orders: those of the equations that contain it and one more, for Jacobians. Returns 0 (ok), SFDAE_ORDER_NOT_AVAILABLE
 * (SFDAE_ORDER_MISSING if the solver needs that order), another positive value (cannot evaluate here: a smaller step is
 * tried) or a negative value (stop at once). */
typedef int (*sfdae_external_function)(int order, const double* arguments, double* derivatives, void* user);

/** The value of a user-supplied function at `count` arguments, 1 ... 16, at least one of them recorded. Orders with
 * more than 4096 entries count as not available. name: for messages, not empty. function and user have to live as long
 * as the solver. */
SFDAE_API sfdae_expression sfdae_external(const char* name, sfdae_external_function function, int count,
                                          const sfdae_expression* arguments, void* user);

/* ---- Nonlinear problems ---------------------------------------------------------------------- */

/** Writes F(t, x, x') as formulas: all m entries of `residual`, for n unknowns x and their derivatives xdot. Returns
 * 0, or another value to stop. */
typedef int (*sfdae_equations_function)(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                                        const sfdae_expression* xdot, sfdae_expression* residual, void* user);

/** Writes the linear equations E(t) x' = A(t) x + f(t) as formulas in t: the entries of E and A (m x n,
 * column-major) and of f (m entries) that are not zero. Returns 0, or another value to stop. */
typedef int (*sfdae_linear_equations_function)(sfdae_record* record, sfdae_expression t, sfdae_expression* E,
                                               sfdae_expression* A, sfdae_expression* f, void* user);

/** Writes the total derivative of the given order of F, F_x and F_x' along a jet at t. derivatives: n x (order + 2),
 * column k is the k-th derivative of x. F: m entries, d^order/dt^order of F(t, x, x'). F_x, F_xdot: m x n entries,
 * the total derivatives of the Jacobians of F with respect to x and x', or NULL if not requested. Plain
 * derivatives, without factorials. All arrays are filled with zeros before the call. Requested orders: 0 ... mu + 1 in
 * the analysis (up to max_index + 1 if the hypothesis seems not to hold at mu) and for derivatives of the solution, 0
 * ... mu in steps. Returns 0 (ok), SFDAE_ORDER_NOT_AVAILABLE (possible for orders above mu), another positive value
 * (cannot evaluate here: a smaller step is tried) or a negative value (stop at once). */
typedef int (*sfdae_total_derivative_function)(double t, int order, const double* derivatives, double* F, double* F_x,
                                               double* F_xdot, void* user);

/** Writes the derivative array of the given order at t: all total derivatives of F up to this order in one call.
 * derivatives: n x (order + 2), column k is the k-th derivative of x. F: (order + 1) m entries, d^k/dt^k of
 * F(t, x, x') for k = 0 ... order, one after the other. jacobian: (order + 1) m x (order + 2) n entries, or NULL if it
 * is not requested: the partial derivatives of these with respect to x, x', ..., x^(order + 1), one after the other.
 * Its blocks are
 *
 *     J_kj = d F^(k) / d x^(j) = C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1),   0 <= k <= order, 0 <= j <= order + 1
 *
 * C(k, j) are the binomial coefficients, 0 unless 0 <= j <= k; F_x^(k) and F_x'^(k) are the total derivatives of the
 * Jacobians of F. If blocks contradict each other, the call ends with SFDAE_WRONG_DERIVATIVES, and the message names
 * the entry. All arrays are filled with zeros before the call. Requested orders, and return values, are those of
 * sfdae_total_derivative_function; the order mu + 1 need not be available. */
typedef int (*sfdae_derivative_array_function)(double t, int order, const double* derivatives, double* F,
                                               double* jacobian, void* user);

/** Nonlinear problem F(t, x, x') = 0. Call sfdae_nonlinear_problem_init first, then set members: exactly one of the
 * four functions. The library differentiates formulas; those that are linear in x and x' are solved as linear
 * problems. Square systems of up to 50000 equations can be solved by structural analysis (sfdae_options.structure):
 * formulas or a function with patterns, nothing prescribed, no differentiations. */
typedef struct sfdae_nonlinear_problem {
  size_t size;                                      /**< set by sfdae_nonlinear_problem_init */
  int num_equations;                                /**< m, 1 ... 5000 or more: see above */
  int num_unknowns;                                 /**< n, 1 ... 5000 or more: see above; m and n may differ */
  sfdae_equations_function equations;               /**< called once, to record F */
  sfdae_linear_equations_function linear_equations; /**< called once, to record E, A and f */
  sfdae_total_derivative_function total_derivative; /**< called at every point */

  /** u > 0 only: components x_j that are prescribed as functions of time, for example inputs of a controlled system.
   * At most u of them, and they must determine the part of the solution that is free. */
  int num_prescribed;                      /**< default 0 */
  const int* prescribed;                   /**< their indices j, 0 <= j < n, no two equal */
  sfdae_vector_function prescribed_values; /**< writes their values at t, num_prescribed entries; order is 0 */

  void* user; /**< passed to every callback */

  /** NULL (default): every equation is differentiated as often as the index requires. Else m counts, 0 ... 12: equation
   * i is differentiated at most that often, which makes the derivative array smaller (minimal extension). Counts that
   * are too small are reported (SFDAE_INDEX_TOO_HIGH). One more derivative is used for x'. Linear equations are then
   * treated as nonlinear. */
  const int* differentiations;

  /** Names of the equations for messages, copied: NULL (default), or m names, NULL or "" for those without one.
   * Messages then include the name, as in "equation 7 (balance of mass)". */
  const char* const* equation_names;

  /** With total_derivative or derivative_array: sparsity patterns (SFDAE_MATRICES_...) of both F_x and F_x', or of
   * neither (default: NULL). Square problems without prescribed components and differentiations then use structural
   * analysis and sparse matrices, as recorded equations do (sfdae_options.structure). Entries outside a pattern end the
   * call with SFDAE_WRONG_PATTERN: dense Jacobians are checked at every evaluation. For the other forms, groups of
   * unknowns are perturbed, and equations without any of them must not change: all groups at first, one with every
   * tenth Jacobian later. */
  int F_x_entries;          /**< default 0 */
  const int* F_x_col_start; /**< n + 1 numbers */
  const int* F_x_row_index; /**< F_x_entries rows, 0 ... m - 1 */
  int F_xdot_entries;
  const int* F_xdot_col_start;
  const int* F_xdot_row_index;
  /** SFDAE_MATRICES_DENSE (default); _COMPRESSED (not with derivative_array): F_x and F_xdot of the callback, and
   * their total derivatives, have the entries of the patterns; or _DIFFERENCES (finite-difference Jacobian): the
   * callback gets NULL for Jacobians, and patterns are optional. Central differences have relative errors of 1e-9, with
   * which ranks are decided (with respect to x', if F is linear in it, roundoff alone). They allow
   * SFDAE_ORDER_NOT_AVAILABLE for order 1 and above if no equation has to be differentiated (strangeness index 0,
   * differentiation index at most 1): x' at outputs then has finite-difference errors. A Jacobian takes 6 evaluations
   * of F for each unknown (more if F is not smooth), or for each group of columns of the patterns that have no row in
   * common. */
  int matrices;

  /** With total_derivative or derivative_array: conditions on which F depends (sfdae.h, sfdae_conditions_function). */
  int num_conditions;                   /**< 0 (default) ... 1000 */
  sfdae_conditions_function conditions; /**< must be set if num_conditions > 0 */
  int* branches;                        /**< the same; written before each call of the function */

  /** In place of total_derivative: one function for F and all its total derivatives. */
  sfdae_derivative_array_function derivative_array; /**< called at every point */
} sfdae_nonlinear_problem;
/** Sets every member to its default. size: sizeof(sfdae_nonlinear_problem). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_nonlinear_problem_init(sfdae_nonlinear_problem* problem, size_t size);

/** Creates a solver of a nonlinear problem and records its formulas, if any. problem and options (NULL: defaults) are
 * copied. On failure *solver is NULL.
 * Failures: SFDAE_ILLEGAL_ARGUMENT, also for mistakes in formulas; SFDAE_EMPTY_PROBLEM; SFDAE_CALLBACK_STOPPED or
 * SFDAE_CALLBACK_FAILED if the function that writes formulas returns a negative or a positive value.
 * sfdae_message(NULL) explains the failure. */
SFDAE_API int sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                                     const sfdae_options* options);

/** Checks a nonlinear problem and its options (NULL: defaults) without creating a solver; formulas are recorded to
 * check them. Returns the status of sfdae_create_nonlinear and writes an explanation of the error, "" if there is none,
 * to `text`, at most `length` characters with the final zero (text NULL with length 0 is allowed). */
SFDAE_API int sfdae_check_nonlinear(const sfdae_nonlinear_problem* problem, const sfdae_options* options, char* text,
                                    size_t length);

/** Changes the value of a parameter of recorded equations without a new recording, as a controller does between two
 * calls. The analysis is discarded. An integration under way continues with the next sfdae_advance or sfdae_step from
 * the point returned last, as at a jump of data (modes.h): x stays if the equations allow it, and changes by impulses
 * of the new equations if E x has to jump; statistics, switches and the recorded solution continue. If that call fails,
 * the point is unchanged. With sensitivities, and for modes of hybrid systems, sfdae_start has to follow.
 * SFDAE_ILLEGAL_ARGUMENT, which changes nothing: no parameter of that name, or a value that is not finite. */
SFDAE_API int sfdae_set_parameter(sfdae_solver* solver, const char* name, double value);

/** Reads the value of a parameter of recorded equations. SFDAE_ILLEGAL_ARGUMENT: no parameter of that name. */
SFDAE_API int sfdae_get_parameter(const sfdae_solver* solver, const char* name, double* value);

/* Numerical confirmation of the structural analysis of recorded equations at a point. */
#define SFDAE_STRUCTURE_UNCHECKED 0 /**< no point is known: neither an analysis nor a step has been made */
#define SFDAE_STRUCTURE_CERTIFIED 1 /**< the system Jacobian is nonsingular: counts and freedom are right */
#define SFDAE_STRUCTURE_MISLEADS 2  /**< it is singular: terms cancel, counts and freedom are meaningless */
#define SFDAE_STRUCTURE_UNCLEAR 3   /**< it is nearly singular */

/** Structural analysis (Pryce's Sigma-method) of equations, recorded or with sparsity patterns, from the unknowns and
 * derivatives that they contain. Each equation is assigned a different unknown, so that the sum of the orders is
 * largest. This gives the smallest counts c_i >= 0 and orders d_j such that, with equation i differentiated c_i times,
 * x_j occurs up to its derivative d_j. The system Jacobian has the entries dF_i / dx_j^(d_j - c_i). J. D. Pryce, BIT
 * 41, 2001. */
typedef struct sfdae_structure {
  size_t size;
  int has_assignment; /**< 0: structurally singular, some equations contain too few unknowns; the rest is zero */
  int freedom;        /**< sum d - sum c: free initial values, if certified */
  int index_bound;    /**< upper bound of the strangeness index, if certified */
  int num_blocks;     /**< of the block triangular form of the system Jacobian */
  int largest_block;
  int is_followed;    /**< 1: rows of the derivative array are left out (sfdae_options.structure) */
  int verdict;        /**< SFDAE_STRUCTURE_UNCHECKED, ... */
  int doubtful_block; /**< the first one that is singular or nearly so, -1: none */
  /** Smallest pivot of all blocks, rows and columns scaled to 1; 0 if a block is singular or none was examined. */
  double smallest_pivot;
  /** Number of equations replaced by a sum of equations and their derivatives, with constant factors, in which terms
   * cancel; the results here are those after the replacement. (G. Tan, N. S. Nedialkov, J. D. Pryce, BIT 57, 2017.)
   * Such equations depend on others in the system Jacobian: nodes on both sides of a capacitor, for example. */
  int num_replaced;
} sfdae_structure;
/** Prepares a result of sfdae_get_structure. size: sizeof(sfdae_structure). */
SFDAE_API int sfdae_structure_init(sfdae_structure* structure, size_t size);

/** Structural analysis of square systems F(t, x, x') = 0 or E x' = A x + f, recorded or with patterns, checked
 * numerically at the last accepted point, or that of the analysis. Equations are replaced if the analysis has found
 * that this makes the structure right and sparse matrices are used (sfdae_options.structure). Arrays may be NULL; n
 * entries each:
 *  - differentiations: c_i;
 *  - orders: d_j;
 *  - assigned: the unknown of equation i;
 *  - block: the block of equation i; a block depends only on blocks with smaller numbers.
 * Without an assignment, block is 0 for equations that contain fewer unknowns than there are such equations, and -1 for
 * others; orders is 0 for these unknowns, and -1 for others; assigned is -1, differentiations 0. sfdae_message names
 * these equations, or the block that is not confirmed numerically.
 * Failures: SFDAE_ILLEGAL_ARGUMENT for problems of other kinds; SFDAE_NOT_FINITE if F cannot be evaluated there. */
SFDAE_API int sfdae_get_structure(sfdae_solver* solver, sfdae_structure* result, int* differentiations, int* orders,
                                  int* assigned, int* block);

/* Languages of sfdae_export_source. */
#define SFDAE_SOURCE_C 0       /**< C99 */
#define SFDAE_SOURCE_FORTRAN 1 /**< a module NAME_model of Fortran 2008 */

/** Writes source text, for use without the library, of a strangeness-free system F(t, z, z') = 0 that has the
 * solutions of recorded equations F(t, x, x') = 0 or E x' = A x + f, as many as unknowns. Its equations are those
 * recorded and their derivatives by structural analysis (sfdae_get_structure: differentiations), n + sum of c_i; its
 * unknowns z are x_j and the derivatives of x_j up to d_j, except x_j' of the states (d of the x_j), which is in z'.
 * All other derivatives are algebraic unknowns (dummy derivatives; S. E. Mattsson, G. Soederlind, SIAM J. Sci. Comput.
 * 14, 1993). Equations that are already strangeness-free are unchanged. The states are chosen at the point that the
 * solver has reached, or that of the analysis (linear equations before a start: at x = 0); F stays strangeness-free as
 * long as they determine the other unknowns.
 *
 * The text has constants NAME_size, NAME_num_states, NAME_num_parameters, NAME_mu, NAME_d, NAME_a, tables NAME_unknown,
 * NAME_order, NAME_is_state of z, and functions NAME_start (t, z, z' and parameters at the point), NAME_residual(t,
 * z, zdot, p, r) and NAME_jacobian(t, z, zdot, p, F_zdot, F_z), full matrices by columns. Comments explain them.
 *
 * language: SFDAE_SOURCE_C, SFDAE_SOURCE_FORTRAN. name: NAME, 1 ... 40 letters, digits and _, a letter first. At most
 * length characters, final zero included, are written to text (NULL with length 0 is allowed). *needed (may be NULL):
 * length of the whole text + 1. An integration is not affected.
 * Failures: SFDAE_NOT_STARTED before an analysis; SFDAE_ILLEGAL_ARGUMENT for arguments, for problems of other kinds
 * and for equations that call functions or tables; SFDAE_RANK_UNCLEAR and others if the structural analysis is not
 * confirmed numerically, even with equations replaced. */
SFDAE_API int sfdae_export_source(sfdae_solver* solver, int language, const char* name, char* text, size_t length,
                                  size_t* needed);

/** Compares the total derivatives that sfdae_nonlinear_problem.total_derivative, or derivative_array, supplies at t
 * along a jet with finite differences, and reports the worst mismatch; sfdae_message describes it if it is suspicious.
 * derivatives: n x (max_order + 2), the jet as that function gets it, which need not be consistent; preferably without
 * zeros. F of the orders 1 ... max_order (0 ... 13) is compared with differences in t of the order below, F_x and F_x'
 * of the orders 0 ... max_order with differences of F with respect to x and x'.
 * Failures: callbacks; SFDAE_ILLEGAL_ARGUMENT if the problem has no such function. */
SFDAE_API int sfdae_check_total_derivatives(sfdae_solver* solver, double t, const double* derivatives, int max_order,
                                            sfdae_derivative_check* result);

/** Splits the Jacobian of a derivative array into the total derivatives of F_x and F_x', and checks all its blocks; no
 * solver is needed. jacobian: (order + 1) m x (order + 2) n entries, as a sfdae_derivative_array_function writes them.
 * F_x, F_xdot: m x n x (order + 1), the derivatives of order 0 ... order one after the other, without factorials. m and
 * n: 1 ... 5000; order: 0 ... 13. Writes an explanation of the error, "" if there is none, to `text`, at most `length`
 * characters with the final zero (text NULL with length 0 is allowed).
 * Failures: SFDAE_WRONG_DERIVATIVES if an entry contradicts others; SFDAE_NOT_FINITE for NaN and Inf. */
SFDAE_API int sfdae_split_derivative_array(int num_equations, int num_unknowns, int order, const double* jacobian,
                                           double* F_x, double* F_xdot, char* text, size_t length);

#ifdef __cplusplus
}
#endif

#endif
