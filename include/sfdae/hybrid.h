/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - hybrid systems: several modes, transitions between them, and an integration across all of them.
 *
 *     solvers, one for each mode -> sfdae_create_hybrid -> sfdae_add_mode ... -> sfdae_add_transition ...
 *         -> sfdae_start_hybrid -> sfdae_advance_hybrid ... -> sfdae_destroy_hybrid, then the solvers
 *
 * A mode is a problem with its solver: equations, options, parameters, index. All modes have the same unknowns. An
 * ideal diode, for example, has the modes "conducts" (u = 0) and "blocks" (i = 0); the first is left when i falls below
 * zero, the second when u rises above it. A mode is analyzed when it is first entered; later entries reuse the
 * analysis.
 *
 * sfdae.h has the conventions. This header is not included by it.
 */
#ifndef SFDAE_HYBRID_H
#define SFDAE_HYBRID_H

#include <sfdae/modes.h>
#include <sfdae/sensitivity.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Modes, transitions, and an integration across them. It belongs to one thread at a time, as its solvers do. */
typedef struct sfdae_hybrid sfdae_hybrid;

/** Creates a hybrid system without modes. On failure *hybrid is NULL. */
SFDAE_API int sfdae_create_hybrid(sfdae_hybrid** hybrid);

/** Frees the hybrid system and sets *hybrid to NULL; its solvers remain, and can be used elsewhere. NULL and *hybrid ==
 * NULL are allowed. SFDAE_BUSY from a callback, which changes nothing. */
SFDAE_API int sfdae_destroy_hybrid(sfdae_hybrid** hybrid);

/** The message of the last call on this hybrid system, as sfdae_message; messages of a solver begin with its mode. */
SFDAE_API const char* sfdae_get_hybrid_message(const sfdae_hybrid* hybrid);

/* ---- Modes and transitions ------------------------------------------------------------------- */

/** Adds a mode, solved by `solver`; modes count from 0. Two modes may have the same equations with other values of
 * parameters: create two solvers. The solver has to live as long as the hybrid system: until then sfdae_destroy refuses
 * it. Its options, parameters and breakpoints can be changed as usual; a change that ends its integration also ends
 * that of the hybrid system. All modes have the same number of unknowns, with the same meaning.
 * name: for messages and the report, copied; NULL: none. *mode (may be NULL): the number of the mode.
 * SFDAE_ILLEGAL_ARGUMENT: another number of unknowns, a solver that is a mode already, that has events or sensitivities
 * of its own; a name that another mode has. */
SFDAE_API int sfdae_add_mode(sfdae_hybrid* hybrid, sfdae_solver* solver, const char* name, int* mode);

/* Kinds of transitions. */
#define SFDAE_TRANSITION_CONDITION 0 /**< as soon as function > 0, clearly; also at the start of a mode */
#define SFDAE_TRANSITION_ZERO 1      /**< function passes zero in `direction`: an event */
#define SFDAE_TRANSITION_TIME 2      /**< at `time`, if the mode began before */

/** Writes the values after a transition at t from one mode to another to `after`, n values, initially those before.
 * Returns 0, or any other value to end the integration. */
typedef int (*sfdae_jump_function)(double t, int from, int to, const double* before, double* after, void* user);

/** A transition from a mode to another one, or to itself. Call sfdae_transition_init first, then set members.
 *
 * A condition holds if function exceeds its uncertainty: its change if x changes by the tolerances, or t by a few
 * rounding errors. It is also checked at the start of the mode, which may be left at once. If it does not hold there,
 * it holds as soon as the function exceeds its value at the start, if this was positive, by the uncertainty; so a
 * condition that is zero at the start of its mode holds when it rises. An event is one of sfdae_set_events of its mode:
 * a zero at the start of the mode is none. If several transitions are due, the one added first happens. */
typedef struct sfdae_transition {
  size_t size;                   /**< set by sfdae_transition_init */
  int from, to;                  /**< modes */
  int kind;                      /**< SFDAE_TRANSITION_CONDITION (default), _ZERO or _TIME */
  sfdae_event_function function; /**< writes one number; not for _TIME */
  int direction;                 /**< _ZERO: +1 rising zeros, -1 falling ones, 0 (default) both */
  double time;                   /**< _TIME: finite */
  sfdae_event_function
      guard; /**< NULL (default), or writes one number: no transition unless it is > 0 at the event */
  /** NULL (default): values after it are those of sfdae_jump for the mode `to`. Else this function writes them, and
   * they are made consistent by the options of the solver of `to`. */
  sfdae_jump_function jump;
  void* user; /**< passed to the functions */
} sfdae_transition;
/** Sets every member to its default. size: sizeof(sfdae_transition). SFDAE_ILLEGAL_ARGUMENT for NULL. */
SFDAE_API int sfdae_transition_init(sfdae_transition* transition, size_t size);

/** Adds a transition, which is copied; they count from 0. *number (may be NULL): that of the transition. An integration
 * under way ends. SFDAE_ILLEGAL_ARGUMENT for a missing mode or function, which the message names. */
SFDAE_API int sfdae_add_transition(sfdae_hybrid* hybrid, const sfdae_transition* transition, int* number);

/* ---- Sliding --------------------------------------------------------------------------------- */

/** Adds a switch: mode `below` holds for g(t, x) < 0, mode `above` for g > 0. If both lead toward the surface g = 0,
 * the system slides along it (sliding mode, which is added here), until one of them leads away again [Filippov 1988].
 *
 * Along the surface the equations common to both modes hold unchanged, the others, F_below and F_above, as (1 - s)
 * F_below + s F_above = 0, and g = 0: one more unknown, s, from 0 to 1, the weight of the mode above, which is
 * internal. The index is usually higher by one. Equations that differ must contain x' with the same factors in both
 * modes; those without x', an unknown with the same factor. The rest of them is arbitrary, for example friction that
 * depends on the normal force.
 *
 * At g = 0 the rate of g is evaluated in both modes. If the other mode leads on, or its values are beyond the surface
 * by a jump, it is entered as by a condition. Sliding ends when s is clearly outside of 0 ... 1. If the modes lead away
 * from the surface to both sides, the continuation is not determined: starts in the sliding mode and user-defined
 * transitions to it are refused (SFDAE_NO_CONSISTENT_VALUES).
 *
 * below, above: modes with recorded equations (any of the create functions), nothing prescribed, no sliding modes.
 * surface: writes g as residual[0]; it contains t and x, no x'; called once. Its parameters have the values of those of
 * the same name in the mode below, or else above, or else their own. user is passed to it.
 * name: of the sliding mode, as that of sfdae_add_mode. *mode (may be NULL): its number.
 *
 * The sliding mode has the options of the solver of `below`, the breakpoints of both and the values of parameters at
 * the time of its entry; the smallest rtol is rtol and atol of s. After sfdae_set_parameter during sliding, start
 * again. The switch is four transitions, in this order: out of `below`, out of `above`, from sliding to `below`, to
 * `above`. Other transitions out of the two modes, those of other switches included, also lead out of the sliding mode;
 * there may be more of them. Sliding along two surfaces at once is not implemented: it ends with SFDAE_ZENO.
 * SFDAE_ILLEGAL_ARGUMENT for modes that cannot be combined; the message gives the reason. An integration under way
 * ends. */
SFDAE_API int sfdae_add_switch(sfdae_hybrid* hybrid, int below, int above, sfdae_equations_function surface,
                               void* user, const char* name, int* mode);

/* ---- Integration ----------------------------------------------------------------------------- */

/** Starts at (t, x) in a mode: sfdae_start of its solver, with the same x, xdot, warnings and failures. If a condition
 * of that mode holds there, its transition happens immediately, and x and xdot are those of the new mode. */
SFDAE_API int sfdae_start_hybrid(sfdae_hybrid* hybrid, int mode, double t, double toward, double* x, double* xdot);

/** Integrates to tout across all transitions on the way, those at tout included, and returns there: sfdae_advance of
 * the solvers, with the same arguments, warnings and failures. After failures of a transition itself (those of
 * sfdae_jump and sfdae_start) t and x are those before it and the integration has ended, also after
 * SFDAE_OUT_OF_MEMORY; after other failures sfdae_advance_hybrid continues.
 *
 * Events are located as described at sfdae_set_events. In a linear mode without differential equations (d = 0) steps
 * are as long as tout allows, in others as the error test at their ends allows: limit max_step of its solver.
 *
 * SFDAE_ZENO: transitions accumulate at a time that cannot be passed, as for a bouncing ball: the times between seven
 * passages of a transition shrink by the same factor, and a millionth of the time since the start is left, or the
 * function of the transition changes by only a thousand tolerances. Or modes alternate (chattering): x changes by at
 * most ten tolerances in each of 30 + 2 (number of modes) visits, as when both lead toward the same surface.
 * sfdae_get_accumulation returns the time; t and x are those after the last transition. Continue with
 * sfdae_start_hybrid. */
SFDAE_API int sfdae_advance_hybrid(sfdae_hybrid* hybrid, double tout, double* t, double* x, double* xdot);

/** sfdae_advance_hybrid to the next transition, or to tout if there is none before: returns SFDAE_EVENT with the values
 * after the transition, or SFDAE_OK at tout. Transitions at the same time are returned one by one. */
SFDAE_API int sfdae_advance_to_transition(sfdae_hybrid* hybrid, double tout, double* t, double* x, double* xdot);

/** Records all accepted steps in all modes from now on, see sfdae_record_solution; NULL: stops recording. At
 * transitions the solution may jump, and has the value after the jump. */
SFDAE_API int sfdae_record_hybrid(sfdae_hybrid* hybrid, sfdae_solution* solution);

/** Stops the call that is running, or else the next one, as sfdae_request_stop does. */
SFDAE_API int sfdae_request_stop_hybrid(sfdae_hybrid* hybrid);

/* ---- Sensitivities --------------------------------------------------------------------------- */

/** Requests `count` sensitivities S_j = dx/dp_j, 0 (none) ... 10000, from the next sfdae_start_hybrid on: as
 * sfdae_set_sensitivities, with the same arguments, over all modes and transitions. A run under way ends. Add the modes
 * first.
 *
 * parameters: each is a parameter of at least one mode, or surface of a switch; modes without it do not depend on it. A
 * parameter of several modes is treated as one (with sfdae_set_parameter give it one value in all of them; if values
 * differ, all change by the same amount). directions: at the start. options: with adjoint = 1 steps are stored for
 * sfdae_get_hybrid_gradient, and S is not computed.
 *
 * At a transition at t, at a zero of its function g(t, x), at a fixed time (dt/dp = 0), or immediately after another
 * transition (with its dt/dp),
 *
 *     dt/dp = -(g_x S + g_p) / (g_t + g_x x'),   S after = (M_x S + M_p) + (M_t + M_x x'_before - x'_after) dt/dp
 *
 * M(t, x, p): the values after it, by the rule of sfdae_jump or your jump function. S after is consistent with the
 * constraints of the mode that begins, hidden ones too. Derivatives of g, and of M unless the equations of a jump give
 * them, are finite differences of fourth order: the user's functions are also called with nearby values, and g with
 * meaningless x'. They may depend on parameters through x alone, g_p = 0: any other parameter in them has to be an
 * unknown, p' = 0, with its unit vector as direction. g must not depend on x' (SFDAE_ILLEGAL_ARGUMENT from the
 * transition). Surfaces of switches are formulas: g_p is that of their parameters.
 *
 * S has n rows also along surfaces, as s is internal. If factors of equations in two modes agree only by the values of
 * parameters, m1 x' and m2 x' with m1 = m2, sensitivities with respect to these exist if the equation has only one x';
 * else sfdae_start_hybrid fails (SFDAE_ILLEGAL_ARGUMENT names the equation). Give such parameters one name in both
 * modes.
 *
 * The adjoint differentiates both maps in all directions that S may have there, d + count (d of the mode that ends), in
 * all of which they need a derivative. max_kept_steps applies to the current mode: for earlier visits, checkpoints are
 * stored, or the steps if they take less memory.
 *
 * SFDAE_ILLEGAL_ARGUMENT: no modes, parameters of no mode and no surface, modes defined by callbacks.
 * sfdae_set_sensitivities always refuses the solvers of modes. A transition fails with SFDAE_SINGULAR if g touches
 * zero, within the tolerances, without passing it, or if g or M has no derivative. If two transitions are due at once,
 * or a guard is about to change, only the one that happens is considered. */
SFDAE_API int sfdae_set_hybrid_sensitivities(sfdae_hybrid* hybrid, int count, const char* const* parameters,
                                             const double* directions, const sfdae_sensitivity_options* options);

/** S and S' at t: sfdae_get_sensitivities for the current mode. After a transition at t they are those after it.
 * SFDAE_NOT_STARTED: there is no run, or none with sensitivities, or with the adjoint. */
SFDAE_API int sfdae_get_hybrid_sensitivities(sfdae_hybrid* hybrid, double t, double* S, double* Sdot);

/** dt[j] = dt/dp_j of the last transition, `count` numbers. SFDAE_NOT_STARTED: there was none since the start, or
 * there are no sensitivities. */
SFDAE_API int sfdae_get_passage_sensitivities(sfdae_hybrid* hybrid, double* dt);

/** Gradients of functionals of the solution, with the option adjoint: sfdae_get_gradient, with the same arguments,
 * back through all modes, motion along surfaces included, and transitions since sfdae_start_hybrid, with the times of
 * these.
 *
 * t: points from the start on, as there; at the time of a transition x is that after it (after all of them, if there
 * are several), also if sfdae_advance_to_transition has returned there. The time is held fixed when the parameters
 * change: w^T S, S after the transition.
 *
 * The parameters of modes must have the values used during the steps, else SFDAE_ILLEGAL_ARGUMENT. SFDAE_NOT_STARTED:
 * there is no run, or none with the adjoint. Other failures: those of sfdae_get_gradient. */
SFDAE_API int sfdae_get_hybrid_gradient(sfdae_hybrid* hybrid, int num_times, const double* t, int num_functionals,
                                        const double* weights, double* gradient);

/* ---- Inspection ------------------------------------------------------------------------------ */

/** The current mode. SFDAE_NOT_STARTED before a start. */
SFDAE_API int sfdae_get_current_mode(const sfdae_hybrid* hybrid, int* mode);

/** Statistics of a mode since sfdae_start_hybrid. */
typedef struct sfdae_mode {
  size_t size;
  long visits;           /**< how often the mode was entered */
  double duration;       /**< time spent in it, signed as the direction of integration */
  long steps;            /**< accepted */
  int num_analyses;      /**< index analyses made by this hybrid system, usually 1 after the first entry */
  int strangeness_index; /**< -1, as the following: not analyzed yet */
  int differential;      /**< d */
  int algebraic;         /**< a */
} sfdae_mode;
/** Prepares a result of sfdae_get_mode. size: sizeof(sfdae_mode). */
SFDAE_API int sfdae_mode_init(sfdae_mode* mode, size_t size);

/** Statistics of a mode. SFDAE_ILLEGAL_ARGUMENT if there is no such mode. */
SFDAE_API int sfdae_get_mode(const sfdae_hybrid* hybrid, int mode, sfdae_mode* result);

/** A transition that happened. */
typedef struct sfdae_passage {
  size_t size;
  double t;
  int transition, from, to; /**< numbers of the transition and of the modes */
  double largest_impulse;   /**< largest |factor| of delta(t), 0 with a user-supplied jump */
  int impulse_component;    /**< where, -1 if there is none */
  double largest_change;    /**< largest |after - before| */
  int changed_component;    /**< where, -1 if nothing changed */
} sfdae_passage;
/** Prepares a result of sfdae_get_passage. size: sizeof(sfdae_passage). */
SFDAE_API int sfdae_passage_init(sfdae_passage* passage, size_t size);

/** Number of transitions since sfdae_start_hybrid, including those before a restored checkpoint. */
SFDAE_API int sfdae_get_num_passages(const sfdae_hybrid* hybrid, long* count);

/** Transition number `index` in time, 0 ... count - 1. Those before a restored checkpoint are counted, but not stored
 * (SFDAE_ILLEGAL_ARGUMENT). */
SFDAE_API int sfdae_get_passage(const sfdae_hybrid* hybrid, long index, sfdae_passage* result);

/** Values before and after the last transition, and the factors of delta(t) there (n values each, any pointer may be
 * NULL). SFDAE_NOT_STARTED if there was none since the start or the checkpoint. */
SFDAE_API int sfdae_get_passage_values(const sfdae_hybrid* hybrid, double* before, double* after, double* impulse);

/** After SFDAE_ZENO: the time at which transitions accumulate. Else SFDAE_NOT_STARTED. */
SFDAE_API int sfdae_get_accumulation(const sfdae_hybrid* hybrid, double* t);

/** sfdae_get_statistics over all modes: counts since the start (of callbacks: since creation of the solvers), largest
 * and smallest values of all, steps and orders of the current mode. */
SFDAE_API int sfdae_get_hybrid_statistics(const sfdae_hybrid* hybrid, sfdae_statistics* result);

/** Writes a report as text, as sfdae_report does: modes with their index, d, a, u, v, visits, times and steps; the
 * current one, its start, its future transitions by time and breakpoints; sensitivities; and the past transitions. */
SFDAE_API int sfdae_report_hybrid(const sfdae_hybrid* hybrid, char* text, size_t length, size_t* needed);

/* ---- Checkpoints ----------------------------------------------------------------------------- */

/* Checkpoints like those of sfdae_save_checkpoint, with the mode and counts. Add the same modes and transitions, and
 * request the same sensitivities, before restoring: recorded equations, parameters and options of all modes are
 * compared, and modes, kinds, directions and times of transitions, whether they have a guard and a jump, and surfaces.
 * Modes that are entered later are analyzed if their solvers have no analysis. */

/** Number of doubles that sfdae_save_hybrid_checkpoint writes now. SFDAE_NOT_STARTED if there is no integration. */
SFDAE_API int sfdae_get_hybrid_checkpoint_length(sfdae_hybrid* hybrid, size_t* length);

/** Writes a checkpoint to an array of `length` doubles. SFDAE_NOT_STARTED if there is no integration. */
SFDAE_API int sfdae_save_hybrid_checkpoint(sfdae_hybrid* hybrid, double* checkpoint, size_t length);

/** Continues from a checkpoint instead of sfdae_start_hybrid. SFDAE_ILLEGAL_ARGUMENT if it is damaged or does not
 * match; after a failure an integration under way continues. */
SFDAE_API int sfdae_restore_hybrid_checkpoint(sfdae_hybrid* hybrid, const double* checkpoint, size_t length);

#ifdef __cplusplus
}
#endif

#endif
