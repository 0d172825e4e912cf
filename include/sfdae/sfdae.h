/* sfdae - initial value problems for differential-algebraic equations of arbitrary index.
 *
 *     F(t, x(t), x'(t)) = 0   or   E(t) x'(t) = A(t) x(t) + f(t),   m equations, n unknowns, any strangeness index.
 *
 * Life cycle:   fill a problem -> create -> (analyze) -> start -> advance ... advance -> destroy
 *
 * The library finds the strangeness index mu and the characteristic values from the derivative array,
 * replaces the problem at every point by an equivalent strangeness-free system, makes the initial
 * values consistent, and integrates with BDF of orders 1 to 5 or Radau IIA of orders 1 to 13.
 * Theory: P. Kunkel, V. Mehrmann, Differential-Algebraic Equations: Analysis and Numerical Solution,
 * EMS, 2006. Letters follow that book: E, A, f, mu, d, a, u, v, M, N, g, Z1, Z2, Z3, T2.
 *
 * Conventions
 *  - Matrices are column-major without padding: entry (i, j) of an m x n matrix is a[i + j * m],
 *    indices count from 0. Vectors of unknowns have n entries. Times and values have the user's units.
 *  - Functions return a status: SFDAE_OK, a remark (> 0) or a failure (< 0). sfdae_message() explains the
 *    last one in words. After a failure outputs are untouched, except where stated (sfdae_advance, sfdae_step).
 *  - Whatever the library keeps it copies; nothing passed in needs to live on, except what the callbacks
 *    use: functions, and the object that `user` points to, must live as long as the solver.
 *  - The library never prints, exits, installs signal handlers or changes the number of BLAS threads.
 *    Small matrices run fastest with one BLAS thread (OPENBLAS_NUM_THREADS=1): parallelize over problems.
 *  - Different solvers are independent. One solver belongs to one thread at a time; sfdae_request_stop()
 *    alone may be called from anywhere. Within its own callbacks a solver answers SFDAE_BUSY, except to
 *    sfdae_request_stop and the functions that only read (those with a const solver).
 *
 * SPDX-License-Identifier: BSD-3-Clause
 */
#ifndef SFDAE_SFDAE_H
#define SFDAE_SFDAE_H

#include <stddef.h>

#define SFDAE_VERSION_MAJOR 0
#define SFDAE_VERSION_MINOR 1
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

/* Remarks: the call did what it could, read on. */
#define SFDAE_STEP_TAKEN 1            /* sfdae_step: one step taken, tout not reached yet */
#define SFDAE_STOPPED 2               /* the monitor or sfdae_request_stop stopped the call; it can be repeated */
#define SFDAE_NOT_UNIQUE 3            /* u > 0: the free part of the solution is held constant */
#define SFDAE_INCONSISTENCY_IGNORED 4 /* redundant equations contradict each other, gone on as the option says */
#define SFDAE_EVENT 5                 /* an event: sfdae_get_events tells which */

/* Failures: wrong use. */
#define SFDAE_ILLEGAL_ARGUMENT (-1)
#define SFDAE_OUT_OF_MEMORY (-2)
#define SFDAE_BUSY (-3)          /* called from within a callback of the same solver */
#define SFDAE_EMPTY_PROBLEM (-4) /* no equations or no unknowns */
#define SFDAE_NOT_STARTED (-5)   /* sfdae_start (or sfdae_analyze) has to come first */

/* Failures: the user's functions. */
#define SFDAE_CALLBACK_STOPPED (-10) /* a callback returned a negative value */
#define SFDAE_CALLBACK_FAILED (-11)  /* a callback returned a positive value and a smaller step did not help */
#define SFDAE_NOT_FINITE (-12)       /* a callback returned NaN or Inf and a smaller step did not help */
#define SFDAE_ORDER_MISSING (-13)    /* a derivative that is needed is not available */

/* Failures: the structure of the problem. */
#define SFDAE_INDEX_TOO_HIGH (-20)          /* the hypothesis holds at no level up to max_index */
#define SFDAE_RANK_UNCLEAR (-21)            /* a rank decision is not clear: the data do not tell the index */
#define SFDAE_CHARACTERISTICS_CHANGED (-22) /* they change at the point that sfdae_get_change tells */
#define SFDAE_PRESCRIPTION_SINGULAR (-23)   /* the prescribed components do not fit the free part of the solution */

/* Failures: values. */
#define SFDAE_INCONSISTENT_VALUES (-30)    /* initial values violate the constraints (SFDAE_INITIAL_ACCEPT) */
#define SFDAE_INCONSISTENT_EQUATIONS (-31) /* redundant equations contradict each other: no solution */
#define SFDAE_FIXED_VALUES (-32)           /* the fixed components contradict the constraints */
#define SFDAE_NO_CONSISTENT_VALUES (-33)   /* nonlinear: no consistent values were found near the guess */

/* Failures: the integration. The point reached is returned, sfdae_advance may be called again. */
#define SFDAE_MAX_STEPS (-40)           /* max_steps taken in this call */
#define SFDAE_STEP_TOO_SMALL (-41)      /* the error test fails at the smallest step */
#define SFDAE_SINGULAR (-42)            /* the iteration matrix stays singular */
#define SFDAE_TOLERANCE_TOO_SMALL (-43) /* tolerances below what rounding allows */

#define SFDAE_INTERNAL (-99) /* a defect of the library: please report it */

/* Name of a status, for example "SFDAE_STEP_TOO_SMALL"; "unknown status" for any other number. */
SFDAE_API const char* sfdae_status_name(int status);

/* Version of the library that is running, for example "0.1.0". */
SFDAE_API const char* sfdae_version(void);

/* ---- Problem --------------------------------------------------------------------------------- */

/* A callback may return this if it cannot provide the derivative order asked for. */
#define SFDAE_ORDER_NOT_AVAILABLE 1001

/* Callbacks return 0 (ok), a positive value (cannot evaluate here, try a smaller step) or a negative value
 * (stop at once). All arrays are filled with zeros before the call: write the nonzeros only.
 *
 * sfdae_matrix_function writes the derivative of the given order (0: the matrix itself) of E or A at t,
 * m x n. sfdae_vector_function writes that of f, m entries. Plain derivatives, no factorials.
 * Orders asked for: 0 ... max_index in the analysis; later 0 ... max(mu, 1), and mu + 1 for the derivative of
 * the initial values and of outputs within Radau steps unless that exceeds max_index. */
typedef int (*sfdae_matrix_function)(double t, int order, double* matrix, void* user);
typedef int (*sfdae_vector_function)(double t, int order, double* vector, void* user);

/* Linear problem E(t) x' = A(t) x + f(t). Call sfdae_linear_problem_init first, then set members. */
typedef struct sfdae_linear_problem {
  size_t size;       /* set by sfdae_linear_problem_init */
  int num_equations; /* m, 1 ... 5000 */
  int num_unknowns;  /* n, 1 ... 5000; m and n may differ */
  sfdae_matrix_function E;
  sfdae_matrix_function A;
  sfdae_vector_function f; /* NULL: f = 0 */
  int constant_E;          /* 1: E does not depend on t; only order 0 is asked for, once. 0 (default): it may */
  int constant_A;          /* 1: A does not depend on t; both 1: one reduction serves all points */

  /* u > 0 only: components x_j that are prescribed as functions of time, for example inputs of a controlled
   * system. At most u of them, and they must determine the part of the solution that is free. */
  int num_prescribed;                      /* default 0 */
  const int* prescribed;                   /* their indices j, 0 <= j < n, no two equal */
  sfdae_vector_function prescribed_values; /* writes their values at t, num_prescribed entries; order is 0 */

  void* user; /* handed to every callback */
} sfdae_linear_problem;

/* Sets defaults. size: sizeof(sfdae_linear_problem) of the caller. SFDAE_ILLEGAL_ARGUMENT for NULL or a size
 * that is none. */
SFDAE_API int sfdae_linear_problem_init(sfdae_linear_problem* problem, size_t size);

/* ---- Options --------------------------------------------------------------------------------- */

/* How the derivative array is reduced. */
#define SFDAE_REDUCTION_STAGED 0 /* staged orthogonal elimination: fast, cleanest rank decisions */
#define SFDAE_REDUCTION_SVD 1    /* singular value decompositions of the whole array, the classical way */

/* How initial values become consistent. */
#define SFDAE_INITIAL_NEAREST 0 /* the consistent point that is nearest in the weighted 2-norm */
#define SFDAE_INITIAL_FIXED 1   /* likewise, but the components marked in `fixed` stay */
#define SFDAE_INITIAL_ACCEPT 2  /* taken as given and checked: violations above the tolerances are refused */

/* The quantity w = W x that is differentiated by the integrator in E x' = A x + f. */
#define SFDAE_LEADING_AUTOMATIC 0 /* projector where rank E is constant, else matrix, else identity */
#define SFDAE_LEADING_PROJECTOR 1 /* W = E^+ E */
#define SFDAE_LEADING_MATRIX 2    /* W = E */
#define SFDAE_LEADING_IDENTITY 3  /* W = I; needs no derivative of E, but may be unstable where ker E rotates */

/* What the monitor is told after every accepted step. */
typedef struct sfdae_progress {
  size_t size;      /* of this struct in the library that calls */
  double t;         /* point reached */
  double step;      /* step size that led there, negative when integrating backward */
  int order;        /* order of that step */
  long steps;       /* accepted steps since sfdae_start */
  int num_unknowns; /* n */
  const double* x;  /* n values at t, valid during the call */
} sfdae_progress;

/* Called after every accepted step. Any value but 0 stops the call with SFDAE_STOPPED. */
typedef int (*sfdae_monitor_function)(const sfdae_progress* progress, void* user);

/* Integration methods. */
#define SFDAE_METHOD_BDF 0 /* orders 1 to 5 */
#define SFDAE_METHOD_RADAU \
  1                              /* Radau IIA with 1, 3, 5 or 7 stages, orders 1, 5, 9, 13: fewer and longer steps
                                    where the problem is smooth, the more so the tighter the tolerances */
#define SFDAE_METHOD_AUTOMATIC 2 /* Radau; BDF from where frequent output or failing steps make that better */

/* Call sfdae_options_init first, then set members. */
typedef struct sfdae_options {
  size_t size; /* set by sfdae_options_init */

  /* Accuracy: the error of component i is kept near rtol |x_i| + atol. */
  double rtol;               /* default 1e-6; 0 <= rtol < 1, not both zero */
  double atol;               /* default 1e-6; >= 0 */
  const double* rtol_vector; /* NULL or n values that replace rtol, one for each component */
  const double* atol_vector; /* NULL or n values that replace atol */

  /* Index analysis. */
  int max_index;              /* highest strangeness index tried, default 5; 0 ... 12 */
  int reduction;              /* SFDAE_REDUCTION_STAGED (default) or _SVD */
  double rank_tol;            /* > 0: values below rank_tol * norm of the data count as zero; default 0: the
                                  library judges by propagated rounding errors. < 1 */
  double time_scale;          /* > 0: unit of time in which derivatives are compared, rounded to a power
                                  of two; default 0: chosen */
  int difference_derivatives; /* 1: derivatives that are not available (SFDAE_ORDER_NOT_AVAILABLE) are computed
                                  from order 0 by differences, up to order 6. Default 0: SFDAE_ORDER_MISSING */
  double difference_step;     /* > 0: spacing of the points used for that; default 0: chosen */

  /* Initial values. */
  int initial_values;            /* SFDAE_INITIAL_NEAREST (default), _FIXED or _ACCEPT */
  const int* fixed;              /* for _FIXED: n flags, 1 where x_i must not change */
  const double* initial_weights; /* NULL or n positive numbers w_i: sum (change_i / w_i)^2 is smallest */

  /* Redundant equations, v > 0. */
  int ignore_inconsistency; /* 1: go on (SFDAE_INCONSISTENCY_IGNORED) where they contradict. Default 0: stop */
  double consistency_tol;   /* relative size of a contradiction that counts, default 1e-8; > 0, < 1 */

  /* Integration. */
  int max_order;       /* highest BDF order, 1 ... 5 (default) */
  double initial_step; /* size of the first step; default 0: chosen */
  double max_step;     /* largest step; default 0: no limit */
  int use_stop_time;   /* 1: nothing is evaluated beyond stop_time. Default 0 */
  double stop_time;
  long max_steps;   /* attempted steps in one call, default 100000; >= 1 */
  int leading_term; /* SFDAE_LEADING_AUTOMATIC (default), ... */

  sfdae_monitor_function monitor; /* NULL: none */
  void* monitor_user;             /* handed to the monitor */

  int method;                 /* SFDAE_METHOD_BDF (default), ...; a change takes effect with the next sfdae_start */
  int min_stages, max_stages; /* Radau: 1, 3, 5 or 7, defaults 1 and 7; equal: that number always (1 alone is for
                                  rough problems: errors add up). A change takes effect with the next sfdae_start */
} sfdae_options;

/* Sets defaults. size: sizeof(sfdae_options) of the caller. */
SFDAE_API int sfdae_options_init(sfdae_options* options, size_t size);

/* ---- Recorded equations ---------------------------------------------------------------------- */

/* Equations can be written once, as formulas: a function of the user applies the functions below to t, x and x', the
 * library records what it does, and computes values, Taylor coefficients and Jacobians from the record. That function
 * is called once. It may contain loops and functions of its own, but there are no values yet to branch on: see
 * sfdae_choose. */
typedef struct sfdae_record sfdae_record; /* a recording under way; ends when the user's function returns */

/* A part of a formula, passed by value. Only the library writes the members; numbers come from sfdae_number. */
typedef struct sfdae_expression {
  sfdae_record* record; /* NULL: the plain number `value` */
  double value;
  int node;
} sfdae_expression;

/* Writes the m entries of F(t, x, x'), all of them, for n unknowns x and their derivatives xdot. Returns 0, or
 * another value to give up. Mistakes (an entry forgotten, expressions of different recordings mixed, numbers that are
 * not finite) make the call that records fail with SFDAE_ILLEGAL_ARGUMENT and a message that names the first one. */
typedef int (*sfdae_equations_function)(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                                        const sfdae_expression* xdot, sfdae_expression* residual, void* user);

/* Writes the entries of E(t), A(t) (m x n, column-major) and f(t) of E x' = A x + f that are not zero. Likewise. */
typedef int (*sfdae_linear_equations_function)(sfdae_record* record, sfdae_expression t, sfdae_expression* E,
                                               sfdae_expression* A, sfdae_expression* f, void* user);

/* A number. */
SFDAE_API sfdae_expression sfdae_number(double value);

/* A parameter: a constant with a name, whose value can be changed later without recording anew. The same name is the
 * same parameter, and the first value counts. */
SFDAE_API sfdae_expression sfdae_parameter(sfdae_record* record, const char* name, double value);

SFDAE_API sfdae_expression sfdae_add(sfdae_expression a, sfdae_expression b);      /* a + b */
SFDAE_API sfdae_expression sfdae_subtract(sfdae_expression a, sfdae_expression b); /* a - b */
SFDAE_API sfdae_expression sfdae_multiply(sfdae_expression a, sfdae_expression b); /* a b */
SFDAE_API sfdae_expression sfdae_divide(sfdae_expression a, sfdae_expression b);   /* a / b */
SFDAE_API sfdae_expression sfdae_negate(sfdae_expression a);                       /* -a */

/* a^b. Integer b up to 64 in size: products, for every a. Else a > 0; a = 0 as far as derivatives exist. */
SFDAE_API sfdae_expression sfdae_power(sfdae_expression a, sfdae_expression b);

SFDAE_API sfdae_expression sfdae_sqrt(sfdae_expression a); /* no derivative at 0 */
SFDAE_API sfdae_expression sfdae_exp(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_log(sfdae_expression a); /* natural logarithm */
SFDAE_API sfdae_expression sfdae_sin(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_cos(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_tan(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_asin(sfdae_expression a); /* asin and acos: no derivative at 1 and -1 */
SFDAE_API sfdae_expression sfdae_acos(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_atan(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_atan2(sfdae_expression y, sfdae_expression x); /* angle of the point (x, y) */
SFDAE_API sfdae_expression sfdae_sinh(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_cosh(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_tanh(sfdae_expression a);

/* These have kinks, or jumps: derivatives are those of the branch that holds at the point. Integrations are efficient
 * where no kink is crossed. */
SFDAE_API sfdae_expression sfdae_abs(sfdae_expression a);
SFDAE_API sfdae_expression sfdae_min(sfdae_expression a, sfdae_expression b);
SFDAE_API sfdae_expression sfdae_max(sfdae_expression a, sfdae_expression b);
/* a if c > 0, else b; the other one need not be defined. */
SFDAE_API sfdae_expression sfdae_choose(sfdae_expression c, sfdae_expression a, sfdae_expression b);

/* ---- Nonlinear problem ----------------------------------------------------------------------- */

/* Total derivative of the given order of F, F_x and F_x' along a jet, at t. derivatives: n x (order + 2), column k is
 * the k-th derivative of x. F: m entries, d^order/dt^order of F(t, x, x'). F_x, F_xdot: m x n entries, the total
 * derivatives of the Jacobians of F with respect to x and x', or NULL if they are not asked for. Plain derivatives.
 * All arrays are filled with zeros before the call. Orders asked for: 0 ... mu + 1 in the analysis (higher ones, up
 * to max_index + 1, where the hypothesis seems not to hold at mu) and for derivatives of the solution, 0 ... mu in
 * steps. SFDAE_ORDER_NOT_AVAILABLE is a possible answer to those above mu. */
typedef int (*sfdae_total_derivative_function)(double t, int order, const double* derivatives, double* F, double* F_x,
                                               double* F_xdot, void* user);

/* Nonlinear problem F(t, x, x') = 0. Call sfdae_nonlinear_problem_init first, then set members: exactly one of the
 * three functions. Recorded equations are differentiated by the library; those that are linear in x and x' are solved
 * as linear problems. */
typedef struct sfdae_nonlinear_problem {
  size_t size;                                      /* set by sfdae_nonlinear_problem_init */
  int num_equations;                                /* m, 1 ... 5000 */
  int num_unknowns;                                 /* n, 1 ... 5000; m and n may differ */
  sfdae_equations_function equations;               /* called once, by sfdae_create_nonlinear, to record F */
  sfdae_linear_equations_function linear_equations; /* likewise E, A and f */
  sfdae_total_derivative_function total_derivative; /* called at every point */

  int num_prescribed; /* u > 0 only, as for linear problems; default 0 */
  const int* prescribed;
  sfdae_vector_function prescribed_values; /* order is 0 */

  void* user; /* handed to every callback */

  /* NULL (default): every equation is differentiated as often as the index asks for. Else m counts, 0 ... 12:
   * equation i is differentiated that often at most, which makes the derivative array smaller (minimal extension).
   * Counts that are too small are told (SFDAE_INDEX_TOO_HIGH). For x' one more derivative is used. Linear equations
   * are treated as nonlinear ones. */
  const int* differentiations;
} sfdae_nonlinear_problem;

/* Sets defaults. size: sizeof(sfdae_nonlinear_problem) of the caller. */
SFDAE_API int sfdae_nonlinear_problem_init(sfdae_nonlinear_problem* problem, size_t size);

/* ---- Multibody systems ----------------------------------------------------------------------- */

/* A mechanical system with constraints, whatever their number and whether or not they are independent:
 *
 *     q' = S(t,q) v                                             (default: q' = v)
 *     M(t,q) v' = f(t,q,v) - G(t,q)^T lambda - H(t,q)^T kappa,  G = g_q S
 *     0 = g(t,q)                                                holonomic constraints
 *     0 = H(t,q) v + h(t,q)                                     nonholonomic constraints
 *
 * The unknowns are x = (q, v, lambda, kappa). Only the constraints are differentiated (minimal extension), which
 * costs far less than the derivative array of the same equations as a nonlinear problem. [M C^T; C 0], C = [G; H],
 * has to be regular but for redundant constraints: M alone may be singular. Redundant constraints that agree are
 * reported, and lambda, kappa are then those of least norm. M need not be symmetric.
 *
 *  - SFDAE_INITIAL_NEAREST and _FIXED change positions (where q' = v) and velocities as little as possible in the
 *    metric of the kinetic energy, v^T M v, if M is symmetric and positive definite and there are no initial_weights,
 *   else in
 *    the (weighted) 2-norm. lambda and kappa follow: values given count only if they are fixed or to be accepted.
 *  - rank_tol: rows of [G; H] of length 1 depend on each other if what is left of one is below it.
 *  - Singular configurations, where the rank of [G; H] drops, end with SFDAE_CHARACTERISTICS_CHANGED, also at the
 *    start. Those that the motion touches without crossing them, so that det of the constraints keeps its sign, end
 *   with
 *    SFDAE_STEP_TOO_SMALL if forces grow beyond all bounds there, and are not seen otherwise.
 *  - Options without a meaning here: reduction, time_scale, difference_derivatives, leading_term. */

/* Callbacks return as all others do; arrays are column-major and filled with zeros before the call. The first kind
 * sees t and q, the second kind v, too. */
typedef int (*sfdae_position_function)(double t, const double* q, double* result, void* user);
typedef int (*sfdae_velocity_function)(double t, const double* q, const double* v, double* result, void* user);

/* Places for the formulas of a recorded system, all zero at first but S, which is the identity if nq = nv. */
typedef struct sfdae_multibody_formulas {
  sfdae_expression* M; /* nv x nv, column-major as all matrices */
  sfdae_expression* f; /* nv */
  sfdae_expression* g; /* nl */
  sfdae_expression* S; /* nq x nv */
  sfdae_expression* H; /* nk x nv */
  sfdae_expression* h; /* nk */
} sfdae_multibody_formulas;

/* Writes the formulas that are not zero; derivatives of q are not among their arguments. The rest is as for
 * sfdae_equations_function. */
typedef int (*sfdae_multibody_equations_function)(sfdae_record* record, sfdae_expression t, const sfdae_expression* q,
                                                  const sfdae_expression* v, const sfdae_multibody_formulas* formulas,
                                                  void* user);

/* How positions and velocities are divided into independent and dependent ones. */
#define SFDAE_COORDINATES_ORTHOGONAL 0  /* directions tangential and normal to the constraints: best conditioned */
#define SFDAE_COORDINATES_PERMUTATION 1 /* components of q and v as they are */

/* Call sfdae_multibody_problem_init first, then set members: either `equations` or callbacks. */
typedef struct sfdae_multibody_problem {
  size_t size;          /* set by sfdae_multibody_problem_init */
  int num_positions;    /* nq >= 1 */
  int num_velocities;   /* nv; default 0: nq */
  int num_constraints;  /* nl, holonomic; default 0 */
  int num_nonholonomic; /* nk; default 0 */

  sfdae_multibody_equations_function equations; /* called once, by sfdae_create_multibody, instead of all below */

  sfdae_position_function mass;                /* M, nv x nv; NULL: the identity */
  sfdae_velocity_function forces;              /* f, nv entries */
  sfdae_position_function constraints;         /* g, nl entries */
  sfdae_position_function constraint_jacobian; /* g_q, nl x nq: G itself where q' = v */
  sfdae_position_function constraint_rate;     /* g_t, nl entries; NULL: g does not depend on t */
  sfdae_position_function kinematics;          /* S, nq x nv; NULL: the identity, nq = nv */
  sfdae_position_function nonholonomic_matrix; /* H, nk x nv */
  sfdae_position_function nonholonomic_offset; /* h, nk entries; NULL: h = 0 */
  /* What is left of twice (once) differentiated constraints without v': G v' + gamma = 0, nl entries, H v' + eta = 0,
   * nk entries. NULL: differences of G (of H and h) along v. */
  sfdae_velocity_function constraint_curvature;   /* gamma = (dG/dt) v + d(g_t)/dt */
  sfdae_velocity_function nonholonomic_curvature; /* eta = (dH/dt) v + dh/dt */

  int coordinates; /* SFDAE_COORDINATES_ORTHOGONAL (default) or _PERMUTATION */

  void* user; /* handed to every callback */
} sfdae_multibody_problem;

/* Sets defaults. size: sizeof(sfdae_multibody_problem) of the caller. */
SFDAE_API int sfdae_multibody_problem_init(sfdae_multibody_problem* problem, size_t size);

/* What is known of a multibody system at the point reached. */
typedef struct sfdae_multibody_report {
  size_t size;
  double t;
  int holonomic, nonholonomic; /* constraints given, nl and nk */
  int redundant;               /* of these, those that follow from the others */
  int degrees_of_freedom;      /* nv - rank [G; H]: independent velocities */
  int position_freedom;        /* nq - rank g_q: independent positions */
  double condition;            /* of the partition in use: |(C Q2)^-1| |C|, rows in their units; 1 is perfect */
  long partitions;             /* chosen since sfdae_start, 1 at first */
  double position_residual;    /* max |g|, each row in units of its gradient */
  double velocity_residual;    /* max |G v + g_t|, |H v + h|, likewise */
} sfdae_multibody_report;
SFDAE_API int sfdae_multibody_report_init(sfdae_multibody_report* report, size_t size);

/* ---- Solver ---------------------------------------------------------------------------------- */

typedef struct sfdae_solver sfdae_solver;

/* Creates a solver. problem and options (NULL: defaults) are copied. On failure *solver is NULL.
 * Errors: SFDAE_ILLEGAL_ARGUMENT, SFDAE_EMPTY_PROBLEM, SFDAE_OUT_OF_MEMORY; sfdae_check_linear says in words
 * what is wrong. */
SFDAE_API int sfdae_create_linear(sfdae_solver** solver, const sfdae_linear_problem* problem,
                                  const sfdae_options* options);

/* The same for a nonlinear problem. Recorded equations are recorded here. Further errors: those of recording;
 * SFDAE_CALLBACK_STOPPED or SFDAE_CALLBACK_FAILED if the function that records does not return 0. */
SFDAE_API int sfdae_create_nonlinear(sfdae_solver** solver, const sfdae_nonlinear_problem* problem,
                                     const sfdae_options* options);

/* The same for a multibody system. The result of sfdae_get_multibody_report is for such solvers only; all else is as
 * for nonlinear problems with x = (q, v, lambda, kappa): strangeness index 2 (1 without holonomic constraints, 0
 * without any), d = independent positions and velocities, a = all other unknowns. */
SFDAE_API int sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                                     const sfdae_options* options);

/* Checks a problem with its options as sfdae_create_linear does and writes what is wrong, in words, to
 * `text` (at most `length` characters with the final zero; length 0 and text NULL are allowed). */
SFDAE_API int sfdae_check_linear(const sfdae_linear_problem* problem, const sfdae_options* options, char* text,
                                 size_t length);

SFDAE_API int sfdae_check_nonlinear(const sfdae_nonlinear_problem* problem, const sfdae_options* options, char* text,
                                    size_t length);

SFDAE_API int sfdae_check_multibody(const sfdae_multibody_problem* problem, const sfdae_options* options, char* text,
                                    size_t length);

/* Parameters of recorded equations, by name. sfdae_set_parameter changes one without recording anew; an integration
 * under way is lost, sfdae_start has to follow. SFDAE_ILLEGAL_ARGUMENT: no parameter of that name, or a value that is
 * not finite. */
SFDAE_API int sfdae_set_parameter(sfdae_solver* solver, const char* name, double value);
SFDAE_API int sfdae_get_parameter(const sfdae_solver* solver, const char* name, double* value);

/* Frees the solver and sets *solver to NULL. NULL and *solver == NULL are allowed. SFDAE_BUSY from a callback. */
SFDAE_API int sfdae_destroy(sfdae_solver** solver);

/* Replaces the options; the point reached stays. A change of max_index, reduction, rank_tol, time_scale,
 * difference_derivatives, difference_step or leading_term makes a new analysis and sfdae_start necessary. */
SFDAE_API int sfdae_set_options(sfdae_solver* solver, const sfdae_options* options);

/* What the last call on this solver had to say: what, where, with which numbers, what to do next. "" after
 * SFDAE_OK. Calls on a const solver leave the text alone unless they fail. It lives until the next call. NULL: "". */
SFDAE_API const char* sfdae_message(const sfdae_solver* solver);

/* Stops the call that is running, or else the next one, at its next callback or step: it returns SFDAE_STOPPED,
 * which clears the request. Lock-free: may be called from signal handlers and other threads. */
SFDAE_API int sfdae_request_stop(sfdae_solver* solver);

/* ---- Index analysis -------------------------------------------------------------------------- */

/* Characteristic values: d + a + v = m, d + a + u = n. */
typedef struct sfdae_characteristics {
  size_t size;
  double t;              /* where they were determined */
  int strangeness_index; /* mu; the differentiation index of a regular problem is mu + 1, or 0 if a = 0 */
  int differential;      /* d */
  int algebraic;         /* a */
  int undetermined;      /* u: free components of the solution, before any are prescribed */
  int redundant;         /* v: equations that follow from the others */
  int rank_E;            /* rank of E(t) */
  int leading_term;      /* SFDAE_LEADING_ ... in use */
  double time_scale;     /* in use */
  double smallest_gap;   /* smallest ratio of kept to dropped values of all rank decisions; >= 1e3 is clear */
} sfdae_characteristics;
SFDAE_API int sfdae_characteristics_init(sfdae_characteristics* characteristics, size_t size);

/* Detects the strangeness index at t and at a nearby point in the direction of `toward` (the end of the
 * interval of interest, toward != t); the larger one counts and stays fixed until the next sfdae_analyze.
 * Forgets the point reached: sfdae_start has to follow. `result` may be NULL.
 * Remarks: SFDAE_NOT_UNIQUE. Failures: callbacks, structure. */
SFDAE_API int sfdae_analyze(sfdae_solver* solver, double t, double toward, sfdae_characteristics* result);

/* The same along the solution through a point near x (n values, which need not be consistent and are not changed).
 * For nonlinear problems, where sfdae_analyze answers SFDAE_ILLEGAL_ARGUMENT; for linear ones x does not matter. Also
 * SFDAE_NO_CONSISTENT_VALUES. sfdae_start does this where it has not been done. */
SFDAE_API int sfdae_analyze_at(sfdae_solver* solver, double t, double toward, const double* x,
                               sfdae_characteristics* result);

/* The characteristic values in use. SFDAE_NOT_STARTED before an analysis. */
SFDAE_API int sfdae_get_characteristics(const sfdae_solver* solver, sfdae_characteristics* result);

/* Which matrix a rank decision was about. */
#define SFDAE_DECISION_STAGE 0 /* pivots of a diagonal block of the derivative array */
#define SFDAE_DECISION_A2 1    /* the constraints A^ x + f^ = 0: rank a */
#define SFDAE_DECISION_ET2 2   /* E T2: rank d */
#define SFDAE_DECISION_ARRAY 3 /* the whole array M (SVD reduction) */

/* Verdicts. */
#define SFDAE_VERDICT_CLEAR 0
#define SFDAE_VERDICT_CONFIRMED 1 /* small gap, confirmed by a second reading (SVD, other time scale) */
#define SFDAE_VERDICT_UNCLEAR 2
#define SFDAE_VERDICT_USER 3 /* decided by rank_tol */

/* One rank decision of the last analysis, be it a failed one. Values are relative to the norm of the data. */
typedef struct sfdae_decision {
  size_t size;
  double t;
  int level;         /* of the derivative array, 0 ... */
  int stage;         /* block column 1 ... level + 1 for SFDAE_DECISION_STAGE, else 0 */
  int what;          /* SFDAE_DECISION_ ... */
  int rows, columns; /* of the matrix judged */
  int rank;
  double kept;      /* smallest value kept, 0 if rank = 0 */
  double dropped;   /* largest value dropped, 0 if the rank is full */
  double noise;     /* what rounding errors may amount to */
  double threshold; /* values below count as zero */
  double gap;       /* kept / max(dropped, noise); 1e300 if nothing was kept */
  int verdict;      /* SFDAE_VERDICT_ ... */
} sfdae_decision;
SFDAE_API int sfdae_decision_init(sfdae_decision* decision, size_t size);

/* Number of rank decisions of the last analysis, and one of them, 0 <= index < count. */
SFDAE_API int sfdae_get_num_decisions(const sfdae_solver* solver, int* count);
SFDAE_API int sfdae_get_decision(const sfdae_solver* solver, int index, sfdae_decision* result);

/* Where the characteristic values changed (after SFDAE_CHARACTERISTICS_CHANGED; else SFDAE_NOT_STARTED). */
typedef struct sfdae_change {
  size_t size;
  double t; /* where, to about 1e-6 of the step or better */
  int old_strangeness_index, old_differential, old_algebraic, old_undetermined, old_redundant;
  int new_strangeness_index; /* -1: could not be determined at t; then the other new values are -1 as well */
  int new_differential, new_algebraic, new_undetermined, new_redundant;
} sfdae_change;
SFDAE_API int sfdae_change_init(sfdae_change* change, size_t size);
SFDAE_API int sfdae_get_change(const sfdae_solver* solver, sfdae_change* result);

/* ---- Initial values -------------------------------------------------------------------------- */

/* What the last sfdae_start or sfdae_make_consistent did to the initial values. */
typedef struct sfdae_initial_report {
  size_t size;
  double t;
  double residual_before; /* 2-norm of A2 x + f2 for the values given, rows of A2 orthonormalized: the distance to
                              the nearest consistent point */
  double residual_after;  /* and for the values returned */
  double largest_change;  /* max |change_i|, 0 if nothing changed */
  int component;          /* where it happened, -1 if nothing changed */
  int derivative_exact;   /* 1: x' from the derivative array; 0: the derivative of the constraints that enters it
                              was computed by differences */
} sfdae_initial_report;
SFDAE_API int sfdae_initial_report_init(sfdae_initial_report* report, size_t size);
SFDAE_API int sfdae_get_initial_report(const sfdae_solver* solver, sfdae_initial_report* result);

/* Makes x (n values, in: guess, out: consistent) consistent at t as the options say and computes the derivative
 * x'(t) of the solution through it (xdot: n values, may be NULL; minimum norm in directions that the problem
 * leaves free). Analyzes first, forward from t, if there is no analysis. The point reached is unaffected.
 * Remarks: SFDAE_NOT_UNIQUE, SFDAE_INCONSISTENCY_IGNORED.
 * Failures: callbacks, structure, SFDAE_INCONSISTENT_VALUES, SFDAE_INCONSISTENT_EQUATIONS, SFDAE_FIXED_VALUES. */
SFDAE_API int sfdae_make_consistent(sfdae_solver* solver, double t, double* x, double* xdot);

/* ---- Integration ----------------------------------------------------------------------------- */

/* Starts or restarts the integration at (t, x), toward the given time: analyzes if that has not happened (or was
 * made for the other direction), makes x consistent (in: guess, out: consistent), computes x'. xdot may be NULL.
 * The direction is that of `toward`; its distance sets the scale of the first step. A restart on an analyzed solver
 * needs no new analysis. Remarks: SFDAE_NOT_UNIQUE, SFDAE_INCONSISTENCY_IGNORED. Failures as sfdae_make_consistent,
 * also SFDAE_CHARACTERISTICS_CHANGED if the values known do not hold at t: call sfdae_analyze. After a failure
 * nothing is started, an integration that was under way is lost. */
SFDAE_API int sfdae_start(sfdae_solver* solver, double t, double toward, double* x, double* xdot);

/* Integrates to tout and returns there: *t = tout, x (n values), xdot (n values, may be NULL). x satisfies
 * all constraints, hidden ones included, to rounding. Steps may go past tout (not past stop_time); a later
 * call with a tout within the last step only interpolates. Remarks and failures of the integration return the
 * last accepted point in t, x, xdot instead, which may lie behind tout if the last step went past it. xdot is
 * the slope of the method's polynomial, corrected toward the equations: its error is about that of x over the step
 * size. Within Radau steps xdot is exact where derivatives of order mu + 1 are available, else less accurate.
 * Steps of Radau end at tout until there are enough of them to interpolate accurately; those of BDF do not depend
 * on tout. tout must lie in the direction of integration, at or behind the last point returned; the direction is
 * set by sfdae_start.
 * Remarks: SFDAE_STOPPED, SFDAE_INCONSISTENCY_IGNORED, SFDAE_EVENT. Failures: callbacks,
 * SFDAE_CHARACTERISTICS_CHANGED, SFDAE_INCONSISTENT_EQUATIONS, integration, SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_advance(sfdae_solver* solver, double tout, double* t, double* x, double* xdot);

/* One-step mode: takes one step toward tout and returns SFDAE_STEP_TAKEN with the point reached, or SFDAE_OK
 * at tout (interpolated if the step went past it). Otherwise as sfdae_advance. */
SFDAE_API int sfdae_step(sfdae_solver* solver, double tout, double* t, double* x, double* xdot);

/* Checkpoints: the analysis and the state of an integration as an array of doubles, to be kept, written to a file, or
 * handed to another process. Restored, the integration goes on as if nothing had happened, in every bit if binary and
 * BLAS are the same. The numbers are plain doubles (infinity may be among them): copy or print them with 17 digits as
 * you like. Problem and options are not in it. SFDAE_NOT_STARTED if there is no integration.
 *
 * Number of doubles that sfdae_save_checkpoint writes now; it changes from step to step. */
SFDAE_API int sfdae_get_checkpoint_length(sfdae_solver* solver, size_t* length);

/* Writes a checkpoint to an array of `length` doubles, at least as many as are needed. */
SFDAE_API int sfdae_save_checkpoint(sfdae_solver* solver, double* checkpoint, size_t length);

/* Continues from a checkpoint instead of sfdae_start: sfdae_advance is next. The solver has to be created with the
 * problem and the options that the checkpoint was made with (tolerances, limits and the monitor may differ); no
 * callback of a linear problem is called; a nonlinear one is linearized as it was. An integration under way is lost.
 * SFDAE_ILLEGAL_ARGUMENT if the checkpoint is damaged or does not fit; then nothing is started. */
SFDAE_API int sfdae_restore_checkpoint(sfdae_solver* solver, const double* checkpoint, size_t length);

/* ---- Events ---------------------------------------------------------------------------------- */

/* Writes the event functions g_i(t, x, x') to g (num_events entries, zero before). Returns 0 (ok), a positive value
 * (cannot evaluate here: SFDAE_CALLBACK_FAILED) or a negative value (stop at once: SFDAE_CALLBACK_STOPPED). */
typedef int (*sfdae_event_function)(double t, const double* x, const double* xdot, double* g, void* user);

/* An event happens where a g_i becomes zero or changes its sign. sfdae_advance and sfdae_step then return SFDAE_EVENT
 * with t, x, xdot there: the zero itself or, within rounding errors of t, the first point behind it; x satisfies all
 * constraints, and g_i is as small as rounding allows. Called again they go on; to change x, call sfdae_start at t.
 *
 * directions: NULL or num_events numbers: +1 only rising zeros count (from - to + in the direction of integration),
 * -1 only falling ones, 0 both. num_events: 1 ... 10000, or 0 to have no events any more. Events are searched from
 * the point returned last or the next start on. They survive sfdae_start, sfdae_analyze and sfdae_set_options.
 *
 *  - Events are returned in their order; those that are one but for rounding errors together. Only events up to tout
 *    count, tout included.
 *  - Nothing happens twice: after its event a g_i is armed again once it has left zero. Where it is zero at the start
 *    (a zero within rounding errors of the start counts as such), or after sfdae_start at the point of its event, it
 *    is armed by its first values that are not; where it stays zero, or is nothing but rounding errors, it is silent.
 *  - Two zeros of one g_i within a step are found where the values of g_i at a few points of the step show that it
 *    bends toward zero in between. A zero without change of sign is found only if g_i is exactly zero at a point
 *    looked at. Jumps of g_i count as zeros. Motions smaller than the tolerances mean nothing. Without differential
 *    equations (d = 0) steps go to tout at once: 33 points at least are looked at, at each one reduction is made.
 *    With BDF, where algebraic components vary much faster than the others, limit max_step.
 *  - g_i is evaluated at values with the accuracy of interpolation, which may violate constraints slightly; failures
 *    there do no harm. Failures on the solution itself end the call (SFDAE_NOT_FINITE for NaN or Inf).
 *  - Without success, with SFDAE_STOPPED for example, sfdae_advance returns the point up to which events have been
 *    searched. If the monitor stops a step with an event in it, the event is returned instead.
 *  - Checkpoints contain the signs of all g_i, not the functions: set the same number of events before restoring. */
SFDAE_API int sfdae_set_events(sfdae_solver* solver, int num_events, sfdae_event_function function,
                               const int* directions, void* user);

/* Which events happened at the point that was returned with SFDAE_EVENT: num_events entries, +1 where g_i was rising,
 * -1 where it was falling, else 0. All 0 before the first event and when the integration has gone on. */
SFDAE_API int sfdae_get_events(const sfdae_solver* solver, int* which);

/* The solution at any t within the last step taken (t_internal - last_step ... t_internal in sfdae_statistics), be it
 * behind or beyond the point returned last. x (n values) satisfies all constraints; xdot (n values) may be NULL. The
 * point reached stays. Failures: as of sfdae_advance; SFDAE_ILLEGAL_ARGUMENT for other t. */
SFDAE_API int sfdae_interpolate(sfdae_solver* solver, double t, double* x, double* xdot);

/* Counts since sfdae_start, except where stated. */
typedef struct sfdae_statistics {
  size_t size;
  long steps;                                       /* accepted */
  long error_failures;                              /* attempts rejected by the error test */
  long other_failures;                              /* attempts rejected otherwise: callbacks, singular matrices */
  long reductions;                                  /* strangeness-free systems computed */
  long factorizations;                              /* LU factorizations of the step's matrix */
  long evaluations_E, evaluations_A, evaluations_f; /* callback calls, since creation */
  int last_order;                                   /* order of the last step, 0 before the first */
  int next_order;
  double last_step; /* signed size of the last step */
  double next_step;
  double t_internal;    /* farthest point reached, at or behind the last point returned */
  double smallest_kept; /* smallest value kept in any rank decision along the way, relative */
  double consistency;   /* largest relative residual of redundant equations along the way (v > 0) */
  double first_step;    /* signed size of the first accepted step */
  long evaluations_F;   /* nonlinear: of F and its total derivatives along a jet, since creation */
  long linearizations;  /* likewise with their Jacobians */
  double rounding;      /* nonlinear: largest rounding error of a component along the way, as the equations
                               cause it, against the tolerance used for it; above 1 it was tested against that
                               error instead */
} sfdae_statistics;
SFDAE_API int sfdae_statistics_init(sfdae_statistics* statistics, size_t size);
SFDAE_API int sfdae_get_statistics(const sfdae_solver* solver, sfdae_statistics* result);

/* ---- Looking inside -------------------------------------------------------------------------- */

/* The derivative array, the projectors and the strangeness-free system below are those of linear problems, recorded
 * ones included. For nonlinear problems, where they depend on more than t, the answer is SFDAE_ILLEGAL_ARGUMENT. */

/* The diagnostics report as text: index analysis with every rank decision, initial values, integration.
 * Writes at most length characters, final zero included. *needed (may be NULL): length of the whole text + 1. */
SFDAE_API int sfdae_report(const sfdae_solver* solver, char* text, size_t length, size_t* needed);

/* Classical derivative array M y = N x + g of the given level l, 0 ... 12, at t, with plain derivatives
 * y = (x', x'', ..., x^(l+1)):  M is (l+1)m x (l+1)n with blocks C(i,j) E^(i-j) - C(i,j+1) A^(i-j-1),
 * N is (l+1)m x n with blocks A^(i), g has (l+1)m entries f^(i). Any of M, N, g may be NULL. */
SFDAE_API int sfdae_get_derivative_array(sfdae_solver* solver, double t, int level, double* M, double* N, double* g);

/* Projectors at t, with orthonormal columns, for the classical array of level mu:
 *   Z2 ((mu+1)m x a):  Z2^T M = 0, A2 = Z2^T N has full row rank;   Z3 ((mu+1)m x vhat): Z3^T [M N] = 0;
 *   T2 (n x (n-a)):    A2 T2 = 0;                                    Z1 (m x d): spans the range of E T2.
 * *vhat, the number of columns of Z3, is at most (mu+1)m - a. All pointers may be NULL; for the sizes ask
 * sfdae_get_characteristics, and call with all matrices NULL for vhat. Needs an analysis. */
SFDAE_API int sfdae_get_projectors(sfdae_solver* solver, double t, double* Z1, double* Z2, double* Z3, double* T2,
                                   int* vhat);

/* Strangeness-free system at t:  E1 x' = A1 x + f1 (d rows),  0 = A2 x + f2 (a rows), with E1 = Z1^T E and so
 * on for the projectors of sfdae_get_projectors; E1, A1 are d x n, A2 is a x n. *residual: max norm of Z3^T g, the
 * contradiction of redundant equations. Any pointer may be NULL. Needs an analysis. */
SFDAE_API int sfdae_get_strangeness_free(sfdae_solver* solver, double t, double* E1, double* A1, double* f1,
                                         double* A2, double* f2, double* residual);

/* Worst mismatch found by sfdae_check_derivatives, sfdae_check_total_derivatives or
 * sfdae_check_multibody_derivatives. */
typedef struct sfdae_derivative_check {
  size_t size;
  char function;      /* 'E', 'A' or 'f'; 'F', 'x' (F_x) or 'd' (F_x'); 'G' (g_q), 'T' (g_t), 'C' (gamma) or
                           'H' (eta); 0 if nothing could be compared */
  int order;          /* of the derivative; >= 1, but for 'x' and 'd' */
  int row, column;    /* of the entry, from 0; column 0 for f and F */
  double supplied;    /* by the callback */
  double difference;  /* by differences of order - 1, or of F for 'x' and 'd' */
  double error;       /* |supplied - difference| relative to the size of the function's derivatives */
  double uncertainty; /* of the differences, likewise; an error far above is a mistake in the callback */
  int suspicious;     /* 1 if error > 100 uncertainty */
} sfdae_derivative_check;
SFDAE_API int sfdae_derivative_check_init(sfdae_derivative_check* check, size_t size);

/* Compares the derivatives of order 1 ... max_order (<= 13) that the callbacks supply near t with differences of
 * the order below, and reports the worst mismatch; sfdae_message says it in words if it is suspicious. Orders that
 * are not available are passed over. */
SFDAE_API int sfdae_check_derivatives(sfdae_solver* solver, double t, int max_order, sfdae_derivative_check* result);

/* The same for the total derivatives that sfdae_nonlinear_problem.total_derivative supplies along a jet, which need
 * not be consistent: derivatives, n x (max_order + 2), as that function gets them; best without zeros. F of the
 * orders 1 ... max_order (0 ... 13) is compared with differences in t of the order below, F_x and F_x' of the orders
 * 0 ... max_order with differences of F with respect to x and x'. SFDAE_ILLEGAL_ARGUMENT if the library
 * differentiates by itself. */
SFDAE_API int sfdae_check_total_derivatives(sfdae_solver* solver, double t, const double* derivatives, int max_order,
                                            sfdae_derivative_check* result);

/* Multibody systems: constraints, freedom and partition at the point reached. SFDAE_NOT_STARTED before an analysis,
 * SFDAE_ILLEGAL_ARGUMENT for other problems. */
SFDAE_API int sfdae_get_multibody_report(const sfdae_solver* solver, sfdae_multibody_report* report);

/* Compares g_q, g_t, gamma and eta as callbacks supply them with differences near (t, q, v), where derivatives of
 * g_q, of S and of H are those along (1, S v), and reports the worst mismatch; sfdae_message says it in words if it
 * is suspicious. A constraint_rate that is missing counts as zero; gamma and eta are compared if they are supplied,
 * and g_q and g_t are right. SFDAE_ILLEGAL_ARGUMENT for recorded systems. */
SFDAE_API int sfdae_check_multibody_derivatives(sfdae_solver* solver, double t, const double* q, const double* v,
                                                sfdae_derivative_check* result);

#ifdef __cplusplus
}
#endif

#endif
