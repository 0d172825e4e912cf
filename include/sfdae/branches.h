/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - branches: singular points of solutions, what they are, and how to go on after them.
 *
 * Where constraints lose rank, or differential equations vanish, an integration ends with
 * SFDAE_CHARACTERISTICS_CHANGED. A solution may end there (a fold: it turns around), or go on smoothly while others
 * branch off, as with a mechanism whose bars come to lie in one line. sfdae_get_singular_point says which, as far as
 * the solution in front of the point tells; sfdae_pass_singular_points lets an integration go on where that can be
 * confirmed.
 *
 * sfdae.h has the conventions. This header is not included by it.
 */
#ifndef SFDAE_BRANCHES_H
#define SFDAE_BRANCHES_H

#include <sfdae/sfdae.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the solution does at a singular point. */
#define SFDAE_SINGULAR_UNDETERMINED 0 /**< numbers do not decide */
#define SFDAE_SINGULAR_FOLD 1         /**< it turns around: x' is unbounded, and no solution continues */
#define SFDAE_SINGULAR_CROSSING 2     /**< what is differentiated is smooth up to it; branches may cross there */
#define SFDAE_SINGULAR_UNBOUNDED 3    /**< what is differentiated grows without bound */

/* Which part of the strangeness-free system loses rank. */
#define SFDAE_PART_UNDETERMINED 0 /**< not separated: linear problems, minimal extensions, or numbers do not tell */
#define SFDAE_PART_CONSTRAINTS 1  /**< A2 */
#define SFDAE_PART_DIFFERENTIAL 2 /**< E T2: as many equations no longer determine derivatives */
#define SFDAE_PART_BOTH 3

/** A singular point that an integration has met. */
typedef struct sfdae_singular_point {
  size_t size;
  double t;        /**< where, as accurately as sfdae_get_change says */
  int kind;        /**< SFDAE_SINGULAR_ ... */
  int part;        /**< SFDAE_PART_ ... */
  int component;   /**< of x, from 0: the one that tells a fold, or grows; else -1 */
  double exponent; /**< that component goes as |t - t*| to this power, about 1/2 in a fold; else 0 */
  int passed;      /**< 1: the integration went on after it */
  double t_before; /**< the last point before it */
  double t_after;  /**< the first point after it; t_before if it was not passed */
  long count;      /**< singular points passed since sfdae_start */
} sfdae_singular_point;
/** Prepares a result of sfdae_get_singular_point. size: sizeof(sfdae_singular_point). */
SFDAE_API int sfdae_singular_point_init(sfdae_singular_point* point, size_t size);

/** The singular point met last since sfdae_start, whether it ended a call or was passed; SFDAE_NOT_STARTED if there was
 * none. kind comes from the points that the integration came through, of which a restored checkpoint has none. */
SFDAE_API int sfdae_get_singular_point(const sfdae_solver* solver, sfdae_singular_point* result);

/** Lets integrations go on after singular points, up to max_points of them from sfdae_start on (>= 0; 0, the default,
 * ends them at the first one). Where the solution is smooth in front of such a point, polynomials fitted to what is
 * differentiated there are extrapolated a little beyond it and made consistent, hidden constraints included. The
 * point is passed if
 *
 *  - there are such values with the known characteristic values, no farther from the polynomials than the errors
 *    expected of these, within some ten tolerances;
 *  - x' by the equations there agrees with that of the polynomials accordingly.
 *
 * If not, the call ends with SFDAE_CHARACTERISTICS_CHANGED as it does without; the message says why. Nothing else is
 * checked: energy, for example, is yours to look at. Branches that touch each other to second order, within
 * tolerances, cannot be told apart: tight tolerances help. After the point the integration starts anew, with errors
 * of extrapolation of about the tolerances. Outputs between t_before and t_after are those of the polynomials, and
 * straight lines for components that are not smooth (multipliers may have a pole there).
 *
 * Steps are shorter near singular points, and steps of Radau take more time, with this than without. Counts from the
 * next step on and survives sfdae_start and sfdae_set_options; it holds for instances of ensembles; checkpoints do
 * not contain it. Nothing is passed while events are searched or sensitivities are carried along. */
SFDAE_API int sfdae_pass_singular_points(sfdae_solver* solver, long max_points);

#ifdef __cplusplus
}
#endif

#endif
