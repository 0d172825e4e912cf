/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - modes: breakpoints (times of discontinuities of the data), and jumps of x when equations change.
 *
 * A switching system (an ideal switch closes, a clutch engages, a body hits another one) is a sequence of modes, each a
 * problem with its own index: another solver, or the same one with other parameters. When one mode ends, sfdae_jump
 * computes the initial values of the next one: they change only by impulses of its equations. sfdae_start alone changes
 * values as little as possible instead, which is right for initial guesses and wrong for switches: capacitors of 1 F at
 * 2 V and 3 F at 0 V, once connected, are both at 0.5 V, since charge is conserved.
 *
 * sfdae.h has the conventions. This header is not included by it.
 */
#ifndef SFDAE_MODES_H
#define SFDAE_MODES_H

#include <sfdae/sfdae.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Breakpoints ----------------------------------------------------------------------------- */

#define SFDAE_BREAKPOINT_KINK 0 /**< data or their derivatives jump; differential variables are continuous */
#define SFDAE_BREAKPOINT_JUMP 1 /**< data jump so that x may jump: values after it are those of sfdae_jump */

/** Sets the times of discontinuities (kinks or jumps) of the data: steps end there, and the integrator restarts with
 * short steps of low order, in both directions of integration. Switching times of tables and of conditions on t in
 * recorded equations are found automatically, however close; x jumps there if it has to.
 *
 * count: 0 ... 1000000 (0 removes all). t: count times, finite and increasing. kinds: NULL (all are kinks) or count
 * numbers SFDAE_BREAKPOINT_KINK or _JUMP.
 *
 * With delta = 1.42e-14 S, S the largest |t_k| (if 0 is the only breakpoint, the largest of the times given to
 * sfdae_start), the functions of the problem are called with t <= t_k - delta up to a breakpoint t_k, and with t >= t_k
 * + delta after it: a comparison of t with t_k takes the branch of the side of the step, whatever its rounding. Finite
 * differences and the analysis use one side only, too. A kink is crossed by a step of length 2 delta, with calls in
 * between; at a jump there are none. (A start at a breakpoint itself calls the functions there: they decide the side.)
 *
 *  - At a kink E x is continuous. If it cannot be, or no step succeeds across, the kink is treated as a jump.
 *    Sensitivities jump, too, if conditions on t and parameters move the time; with the adjoint the call ends at jumps
 *    of x or x'.
 *  - At a jump t_k the values before are those at t_k - delta, and sfdae_jump computes those after it with the
 *    functions at t_k + delta; sfdae_get_jump returns both, and the impulses. The index and d, a, u, v have to be the
 *    same on both sides, else the call ends with SFDAE_CHARACTERISTICS_CHANGED or a failure of sfdae_jump, with the
 *    values before: continue with sfdae_analyze_at, sfdae_jump and sfdae_start.
 *  - tout = t_k gives the solution after t_k (for both directions, that on the side of larger t), with x' there.
 *  - Breakpoints survive sfdae_start, sfdae_analyze and sfdae_set_options, and apply to the instances of ensembles.
 *    Checkpoints do not contain them: set the same ones before restoring. Breakpoints set during an integration take
 *    effect with the next step.
 * SFDAE_ILLEGAL_ARGUMENT names the first time that is not finite, not larger than the one before, or of unknown kind,
 * and leaves the breakpoints unchanged. */
SFDAE_API int sfdae_set_breakpoints(sfdae_solver* solver, int count, const double* t, const int* kinds);

/** The last jump at a breakpoint: its time t, the values before and after it, and the factor of the impulse delta in
 * each component (n values each; any pointer may be NULL). SFDAE_NOT_STARTED if there was none since sfdae_start. */
SFDAE_API int sfdae_get_jump(const sfdae_solver* solver, double* t, double* before, double* after, double* impulse);

/* ---- Jumps ----------------------------------------------------------------------------------- */

/** Consistent initial values of the equations of this solver at t, after other equations have led to `before`: the
 * values reached by impulses of the equations. For E x' = A x + f with constant E and A they satisfy
 *
 *     E (after - before) = A xi_0,   E xi_0 = A xi_1,   ...,   E xi_(mu-1) = 0,   after consistent,
 *
 * x = xi_0 delta(t) + xi_1 delta'(t) + ... at t: for regular pencils the consistency projector. Charges, momenta and
 * other quantities that no impulse of the equations changes are conserved. With E(t) and A(t) their derivatives enter
 * accordingly. Nonlinear equations are linearized after the jump; this determines the jump if the unknowns that jump or
 * have impulses enter linearly, with factors that do neither, which is tested. (C(v) v' + i = 0 is not of that kind;
 * with a charge q as an unknown, q' + i = 0 and q = Q(v), it is.) Multibody systems: M (v+ - v-) = -C^T p, positions
 * stay; xi_0 of the multipliers is p.
 *
 * toward: in the direction of integration. before, after: n values, may be the same array; algebraic variables of
 * `before` matter only if they are combined with others in E x. orders, impulses: n x orders array for xi_0, xi_1, ...
 * (NULL for orders = 0), columns from the strangeness index on are zero. f is evaluated at t: for data that jump there,
 * the functions have to be those after it. Continue with sfdae_start(solver, t, toward, after, ...); an integration
 * under way ends. Analyzes if necessary, as sfdae_start does.
 * Failures: those of sfdae_analyze_at; SFDAE_NO_CONSISTENT_VALUES if the jump is not determined (u > 0 without
 * prescribed components, factors that jump themselves, positions that would have to jump), or impulses do not lead to
 * consistent values (redundant equations, v > 0). `after` and `impulses` are untouched then. */
SFDAE_API int sfdae_jump(sfdae_solver* solver, double t, double toward, const double* before, double* after,
                         int orders, double* impulses);

/** The velocities of a multibody system after an impact at t,
 *
 *     M (v+ - v-) = -C^T p,   C_i v+ + r_i = -e_i (C_i v- + r_i),   C = [G; H], r = (g_t, h)
 *
 * with coefficients of restitution e_i, 0 ... 1: restitution has nl + nk of them, holonomic constraints first, or is
 * NULL (all 0, as sfdae_jump). Positions do not change, and must satisfy the constraints within the tolerances. before,
 * after: n values, may be the same array; with any e_i > 0 constraint i does not hold afterwards: continue with a
 * solver without it; lambda and kappa are 0 then. impulses: p, nl + nk values, may be NULL; of minimum norm if
 * constraints are redundant. An integration under way ends. Failures: as sfdae_jump; SFDAE_ILLEGAL_ARGUMENT for other
 * problems and for coefficients that are not in 0 ... 1; SFDAE_INCONSISTENT_EQUATIONS if redundant constraints require
 * different velocities. */
SFDAE_API int sfdae_impact(sfdae_solver* solver, double t, const double* restitution, const double* before,
                           double* after, double* impulses);

#ifdef __cplusplus
}
#endif

#endif
