/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - multibody (mechanical) systems with constraints, independent or redundant.
 *
 *     q' = S(t,q) v                                             (default: q' = v)
 *     M(t,q) v' = f(t,q,v) - G(t,q)^T lambda - H(t,q)^T kappa,  G = g_q S
 *     0 = g(t,q)                                                holonomic constraints
 *     0 = H(t,q) v + h(t,q)                                     nonholonomic constraints
 *
 * The unknowns are x = (q, v, lambda, kappa). Only the constraints are differentiated (minimal extension), which
 * costs far less than the derivative array of these equations as a nonlinear problem. [M C^T; C 0], C = [G; H], has to
 * be nonsingular except for redundant constraints: M alone may be singular, and need not be symmetric. Consistent
 * redundant constraints are reported; lambda, kappa then have minimum norm.
 *
 * The solver is used as any other. The strangeness index is 2 (differentiation index 3), 1 without holonomic
 * constraints, 0 without any; d counts independent positions and velocities, a all other unknowns.
 *
 *  - SFDAE_INITIAL_NEAREST and _FIXED leave positions and velocities that satisfy the constraints unchanged, to the
 *    last bit, and change others as little as possible in the metric of the kinetic energy, v^T M v, if M is symmetric
 *    and positive definite and there are no initial_weights, else in the (weighted) 2-norm: positions first, then
 *    velocities there. Changes beyond the tolerances are SFDAE_VALUES_CHANGED. lambda and kappa are computed: given
 *    values matter only if they are fixed or to be accepted.
 *  - rank_tol: rows of [G; H] of length 1 are dependent if the remainder of one after elimination is below it.
 *  - Singular configurations, where the rank of [G; H] drops, end with SFDAE_CHARACTERISTICS_CHANGED, also at the
 *    start, and if steps fail just before: motions end or branch there. Those that are touched without being crossed
 *    (det of the constraints keeps its sign) and without failing steps are not detected.
 *  - Options without a meaning here: reduction, time_scale, difference_derivatives, leading_term.
 *
 * sfdae.h has the conventions, and includes this header.
 */
#include <sfdae/sfdae.h> /* before the guard: whichever of the headers is included first, sfdae.h is read first */

#ifndef SFDAE_MULTIBODY_H
#define SFDAE_MULTIBODY_H

#include <sfdae/expression.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Problem --------------------------------------------------------------------------------- */

/** Writes a quantity that depends on positions, for example M, to `result`, whose shape stands at the member of
 * sfdae_multibody_problem: column-major, filled with zeros before the call. q: nq values. Returns 0 (ok), a
 * positive value (cannot evaluate here: a smaller step is tried) or a negative value (stop at once). */
typedef int (*sfdae_position_function)(double t, const double* q, double* result, void* user);

/** Writes a quantity that depends on positions and velocities, for example f, to `result`, whose shape stands at the
 * member of sfdae_multibody_problem, filled with zeros before the call. q: nq values, v: nv values. Returns 0 (ok),
 * a positive value (cannot evaluate here: a smaller step is tried) or a negative value (stop at once). */
typedef int (*sfdae_velocity_function)(double t, const double* q, const double* v, double* result, void* user);

/** Formulas of a recorded system, to be written; initially zero, except S, which is the identity if nq = nv. */
typedef struct sfdae_multibody_formulas {
  sfdae_expression* M; /**< mass matrix, nv x nv, column-major as all matrices */
  sfdae_expression* f; /**< nv */
  sfdae_expression* g; /**< nl */
  sfdae_expression* S; /**< nq x nv */
  sfdae_expression* H; /**< nk x nv */
  sfdae_expression* h; /**< nk */
} sfdae_multibody_formulas;

/** Writes a system as formulas in t, q (nq entries) and v (nv entries), those that are not zero: only f may depend
 * on v. Returns 0, or another value to stop. */
typedef int (*sfdae_multibody_equations_function)(sfdae_record* record, sfdae_expression t, const sfdae_expression* q,
                                                  const sfdae_expression* v, const sfdae_multibody_formulas* formulas,
                                                  void* user);

/* How positions and velocities are divided into independent and dependent ones. */
#define SFDAE_COORDINATES_ORTHOGONAL 0  /**< directions tangential and normal to the constraints: best conditioned */
#define SFDAE_COORDINATES_PERMUTATION 1 /**< components of q and v as they are */

/** Call sfdae_multibody_problem_init first, then set members: either `equations` or callbacks. At most 5000
 * unknowns. */
typedef struct sfdae_multibody_problem {
  size_t size;          /**< set by sfdae_multibody_problem_init */
  int num_positions;    /**< nq >= 1 */
  int num_velocities;   /**< nv; default 0: nq */
  int num_constraints;  /**< nl, holonomic; default 0 */
  int num_nonholonomic; /**< nk; default 0 */

  sfdae_multibody_equations_function equations; /**< called once, to record the formulas, instead of all below */

  sfdae_position_function mass;                /**< mass matrix M, nv x nv; NULL: the identity */
  sfdae_velocity_function forces;              /**< f, nv entries */
  sfdae_position_function constraints;         /**< g, nl entries */
  sfdae_position_function constraint_jacobian; /**< g_q, nl x nq: G itself where q' = v */
  sfdae_position_function constraint_rate;     /**< g_t, nl entries; NULL: g does not depend on t */
  sfdae_position_function kinematics;          /**< S, nq x nv; NULL: the identity, nq = nv */
  sfdae_position_function nonholonomic_matrix; /**< H, nk x nv */
  sfdae_position_function nonholonomic_offset; /**< h, nk entries; NULL: h = 0 */

  /** Terms without v' of differentiated constraints: for holonomic ones, differentiated twice, G v' + gamma = 0, nl
   * entries; for nonholonomic ones, differentiated once, H v' + eta = 0, nk entries. NULL: computed by finite
   * differences of G, of H and h, along v. */
  sfdae_velocity_function constraint_curvature;   /**< gamma = (dG/dt) v + d(g_t)/dt */
  sfdae_velocity_function nonholonomic_curvature; /**< eta = (dH/dt) v + dh/dt */

  int coordinates; /**< SFDAE_COORDINATES_ORTHOGONAL (default) or _PERMUTATION */

  void* user; /**< passed to every callback */

  /** Names of the constraints for messages, copied: NULL (default), or nl + nk names, holonomic ones first, NULL or ""
   * for those without one. Messages then include the name, as in "holonomic constraint 1 (length of the rod)". */
  const char* const* constraint_names;
} sfdae_multibody_problem;
/** Sets every member to its default. size: sizeof(sfdae_multibody_problem). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_multibody_problem_init(sfdae_multibody_problem* problem, size_t size);

/* ---- Solver ---------------------------------------------------------------------------------- */

/** Creates a solver of a multibody system and records its formulas, if any. problem and options (NULL: defaults) are
 * copied. On failure *solver is NULL.
 * Failures: SFDAE_ILLEGAL_ARGUMENT, also for mistakes in formulas; SFDAE_EMPTY_PROBLEM; SFDAE_CALLBACK_STOPPED or
 * SFDAE_CALLBACK_FAILED if the function that writes formulas returns a negative or a positive value.
 * sfdae_message(NULL) explains the failure. */
SFDAE_API int sfdae_create_multibody(sfdae_solver** solver, const sfdae_multibody_problem* problem,
                                     const sfdae_options* options);

/** Checks a multibody system and its options (NULL: defaults) without creating a solver; formulas are recorded to
 * check them. Returns the status of sfdae_create_multibody and writes an explanation of the error, "" if there is none,
 * to `text`, at most `length` characters with the final zero (text NULL with length 0 is allowed). */
SFDAE_API int sfdae_check_multibody(const sfdae_multibody_problem* problem, const sfdae_options* options, char* text,
                                    size_t length);

/* ---- Inspection ------------------------------------------------------------------------------ */

/** Properties of a multibody system at the point reached. */
typedef struct sfdae_multibody_report {
  size_t size;
  double t;
  int holonomic, nonholonomic; /**< constraints given, nl and nk */
  int redundant;               /**< redundant ones of these */
  int degrees_of_freedom;      /**< nv - rank [G; H]: independent velocities */
  int position_freedom;        /**< nq - rank g_q: independent positions */
  double condition;            /**< of the partition in use: |(C Q2)^-1| |C|, rows in their units; 1 is perfect */
  /** Partitions chosen since sfdae_start, 1 at first; 0: sparse matrices are in use, condition is that of C at the
   * point. */
  long partitions;
  double position_residual; /**< max |g|, each row in units of its gradient */
  double velocity_residual; /**< max of |G v + g_t| and |H v + h|, each row in units of its gradient */
} sfdae_multibody_report;
/** Prepares a result of sfdae_get_multibody_report. size: sizeof(sfdae_multibody_report). */
SFDAE_API int sfdae_multibody_report_init(sfdae_multibody_report* report, size_t size);

/** Constraints, freedom and partition of a multibody system at the point reached. SFDAE_NOT_STARTED before an
 * analysis, SFDAE_ILLEGAL_ARGUMENT for other problems. */
SFDAE_API int sfdae_get_multibody_report(const sfdae_solver* solver, sfdae_multibody_report* report);

/** The extended system of a multibody system at (t, x), x: n values, or NULL for the solution at t, which has to lie
 * within the last step taken as for sfdae_interpolate:
 *
 *     Q1 Q1^T q' + Q2 wq = S v,   M (Q1 Q1^T v' + Q2 wv) = f - G^T lambda - H^T kappa,
 *     0 = g,   0 = C v + r,   C (Q1 Q1^T v' + Q2 wv) + s = 0,   C = [G; H], r = (g_t, h), s = (gamma, eta)
 *
 * with the partition [Q1 Q2] in use, of positions in the first equation, of velocities in the others, and the
 * derivatives wq = Q2^T q', wv = Q2^T v' of dependent directions as unknowns of their own. It is strangeness-free
 * (mu = 0) while g_q Q2 and C Q2 are regular. With rq = nq - position_freedom and rv = nv - degrees_of_freedom of
 * sfdae_get_multibody_report:
 *   Qq: [Q1 Q2] of positions, nq x nq, Q2 the last rq columns;  Qv: of velocities, nv x nv, Q2 the last rv columns;
 *   E, A (N x N), f (N entries): the system linearized at (t, x), E X' = A X + f for changes of X = (x, wq, wv), N =
 *   n + rq + rv, in the order above, rq and rv independent rows of constraints. If nl + nk > rv, redundant, equations
 *   follow that keep the multipliers those of least norm;  w: (wq, wv), rq + rv values.
 * Any of Qq, Qv, E, A, f, w may be NULL. Derivatives of callbacks are computed by finite differences.
 * Failures: callbacks, SFDAE_NOT_STARTED before an analysis, those of sfdae_interpolate for x = NULL,
 * SFDAE_CHARACTERISTICS_CHANGED if the ranks of constraints differ there; SFDAE_ILLEGAL_ARGUMENT for other problems. */
SFDAE_API int sfdae_get_extended_system(sfdae_solver* solver, double t, const double* x, double* Qq, double* Qv,
                                        double* E, double* A, double* f, double* w);

/** Compares g_q, g_t, gamma and eta of callbacks with finite differences near (t, q, v), q: nq values, v: nv values,
 * where derivatives of g_q, of S and of H are those along (1, S v), and reports the worst mismatch; sfdae_message
 * describes it if it is suspicious. A missing constraint_rate counts as zero; gamma and eta are compared if they are
 * supplied, and g_q and g_t are right.
 * Failures: callbacks; SFDAE_ILLEGAL_ARGUMENT for recorded systems and for other problems. */
SFDAE_API int sfdae_check_multibody_derivatives(sfdae_solver* solver, double t, const double* q, const double* v,
                                                sfdae_derivative_check* result);

#ifdef __cplusplus
}
#endif

#endif
