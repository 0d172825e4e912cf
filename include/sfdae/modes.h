/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - modes: times at which data have kinks or jumps, and what is kept when equations change.
 *
 * A system that switches (an ideal switch closes, a clutch engages, a body hits another one) is a sequence of modes,
 * each a problem of its own with an index of its own: another solver, or the same one with other parameters. Where
 * one mode ends, sfdae_jump says which values the next one begins with: impulses of its equations change what they
 * can reach, and nothing else. sfdae_start alone moves values as little as possible instead, which is right for
 * guesses and wrong for switches: capacitors of 1 F at 2 V and 3 F at 0 V that are connected have 0.5 V both, since
 * charge is kept.
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

#define SFDAE_BREAKPOINT_KINK 0 /**< data or their derivatives jump; what is differentiated goes on continuously */
#define SFDAE_BREAKPOINT_JUMP 1 /**< data jump so that x may jump: values are found anew by the rule of sfdae_jump */

/** Sets the times at which data have kinks or jumps: steps end there, and the integrator starts anew with short steps
 * of low order, in both directions of integration. Times at which tables and conditions on t in recorded equations
 * switch are found without, however near to each other they are; there x jumps if it has to.
 *
 * count: 0 ... 1000000 (0: none any more). t: count times, finite and increasing. kinds: NULL (all are kinks) or count
 * numbers SFDAE_BREAKPOINT_KINK or _JUMP.
 *
 * With delta = 1.42e-14 S, S the largest |t_k| (where 0 is the only breakpoint, of the times given to sfdae_start), the
 * functions of the problem are called with t <= t_k - delta up to a breakpoint t_k, and with t >= t_k + delta after
 * it: a comparison of t with t_k takes the branch of the side that the step is on, whatever its rounding. Derivatives
 * by differences and the analysis look at one side only, too. A kink is crossed by a step of length 2 delta, with
 * calls in between; at a jump there are none. (A start at a breakpoint itself calls them there: they decide which
 * side it is.)
 *
 *  - At a kink E x goes on continuously. If it cannot, or no step leads across, the kink is taken for a jump.
 *    Sensitivities jump, too, by the moving time of conditions on t and parameters; with the adjoint the call ends at
 *    jumps of x or x'.
 *  - At a jump t_k the values before are those at t_k - delta, and those after are what sfdae_jump makes of them with
 *    the functions at t_k + delta; sfdae_get_jump has both, and the impulses. The index and d, a, u, v have to be the
 *    same on both sides, else the call ends with SFDAE_CHARACTERISTICS_CHANGED or with what sfdae_jump fails with,
 *    with the values before: go on with sfdae_analyze_at, sfdae_jump and sfdae_start.
 *  - tout = t_k gives the solution after t_k (for both directions, that on the side of larger t), with x' there.
 *  - Breakpoints survive sfdae_start, sfdae_analyze and sfdae_set_options, and hold for the instances of ensembles.
 *    They are not in checkpoints: set the same ones before restoring. Set during an integration, they count from the
 *    next step on.
 * SFDAE_ILLEGAL_ARGUMENT names the first time that is not finite, not larger than the one before, or of unknown kind,
 * and leaves the breakpoints as they were. */
SFDAE_API int sfdae_set_breakpoints(sfdae_solver* solver, int count, const double* t, const int* kinds);

/** The jump crossed last at a breakpoint: its time t, the values before and after it, and the factor of the impulse
 * delta in each component (n values each; any pointer may be NULL). SFDAE_NOT_STARTED if there was none since
 * sfdae_start. */
SFDAE_API int sfdae_get_jump(const sfdae_solver* solver, double* t, double* before, double* after, double* impulse);

/* ---- Jumps ----------------------------------------------------------------------------------- */

/** The values with which the equations of this solver begin at t, if others have led to `before`: consistent values
 * that impulses of the equations lead to. For E x' = A x + f with constant E and A that is
 *
 *     E (after - before) = A xi_0,   E xi_0 = A xi_1,   ...,   E xi_(mu-1) = 0,   after consistent,
 *
 * x = xi_0 delta(t) + xi_1 delta'(t) + ... at t: for regular pencils the consistency projector. Charges, momenta and
 * whatever else no impulse of the equations can reach are kept. With E(t) and A(t) their derivatives enter accordingly.
 * Nonlinear equations are linearized after the jump; this determines the jump where what jumps, or has an impulse, is
 * in them linearly with factors that do neither, which is tested. (C(v) v' + i = 0 is not of that kind: with a charge
 * q as an unknown, q' + i = 0 and q = Q(v), it is.) Multibody systems: M (v+ - v-) = -C^T p, positions stay; xi_0 of
 * the multipliers is p.
 *
 * toward: in the direction of integration. before, after: n values, may be the same array; algebraic components of
 * `before` count only as far as they are combined with others in E x. orders, impulses: n x orders array for xi_0,
 * xi_1, ... (NULL for orders = 0), columns from the strangeness index on are zero. f is that at t: for data that jump
 * there, the functions have to be those after it. sfdae_start(solver, t, toward, after, ...) goes on; an integration
 * under way is ended. Analyzes where that has not been done, as sfdae_start does.
 * Failures: those of sfdae_analyze_at; SFDAE_NO_CONSISTENT_VALUES where the jump is not determined (u > 0 without
 * prescribed components, factors that jump themselves, positions that would have to jump), or impulses do not lead to
 * consistent values (redundant equations, v > 0). `after` and `impulses` are untouched then. */
SFDAE_API int sfdae_jump(sfdae_solver* solver, double t, double toward, const double* before, double* after,
                         int orders, double* impulses);

/** The velocities of a multibody system after an impact at t,
 *
 *     M (v+ - v-) = -C^T p,   C_i v+ + r_i = -e_i (C_i v- + r_i),   C = [G; H], r = (g_t, h)
 *
 * with coefficients of restitution e_i, 0 ... 1: restitution has nl + nk of them, holonomic constraints first, or is
 * NULL (all 0, as sfdae_jump). Positions stay, and have to fulfil the constraints within the tolerances. before,
 * after: n values, may be the same array; with any e_i > 0 constraint i does not hold afterwards: go on with a solver
 * without it; lambda and kappa are 0 then. impulses: p, nl + nk values, may be NULL; of least norm where constraints
 * are redundant. An integration under way is ended. Failures: as sfdae_jump; SFDAE_ILLEGAL_ARGUMENT for other
 * problems and for coefficients that are not in 0 ... 1; SFDAE_INCONSISTENT_EQUATIONS where redundant constraints ask
 * for different velocities. */
SFDAE_API int sfdae_impact(sfdae_solver* solver, double t, const double* restitution, const double* before,
                           double* after, double* impulses);

#ifdef __cplusplus
}
#endif

#endif
