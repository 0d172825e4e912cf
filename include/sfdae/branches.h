/* SPDX-License-Identifier: BSD-3-Clause */

/** @file
 * sfdae - singular points of solutions (folds, bifurcations): their kinds, and continuation after them.
 *
 * An integration ends with SFDAE_CHARACTERISTICS_CHANGED if constraints lose rank or differential equations vanish. The
 * solution may end there (a fold: it turns around), or continue smoothly while other branches cross, as in a mechanism
 * whose bars become collinear. sfdae_get_singular_point tells which, as far as the solution before the point determines
 * it; sfdae_pass_singular_points lets an integration continue if a smooth continuation is confirmed.
 *
 * sfdae.h has the conventions. This header is not included by it.
 */
#ifndef SFDAE_BRANCHES_H
#define SFDAE_BRANCHES_H

#include <sfdae/sfdae.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Behavior of the solution at a singular point. */
#define SFDAE_SINGULAR_UNDETERMINED 0 /**< not decided numerically */
#define SFDAE_SINGULAR_FOLD 1         /**< it turns around: x' is unbounded, and no solution continues */
#define SFDAE_SINGULAR_CROSSING 2     /**< differential variables are smooth up to it; branches may cross there */
#define SFDAE_SINGULAR_UNBOUNDED 3    /**< differential variables grow without bound */

/* The part of the strangeness-free system that loses rank. */
#define SFDAE_PART_UNDETERMINED 0 /**< not separated: linear problems, minimal extensions, or not decided */
#define SFDAE_PART_CONSTRAINTS 1  /**< A2 */
#define SFDAE_PART_DIFFERENTIAL 2 /**< E T2: fewer equations determine derivatives */
#define SFDAE_PART_BOTH 3

/** A singular point that an integration has met. */
typedef struct sfdae_singular_point {
  size_t size;
  double t;        /**< time, as accurate as that of sfdae_get_change */
  int kind;        /**< SFDAE_SINGULAR_ ... */
  int part;        /**< SFDAE_PART_ ... */
  int component;   /**< of x, from 0: the one that shows the fold, or grows; else -1 */
  double exponent; /**< that component behaves as |t - t*| to this power, about 1/2 at a fold; else 0 */
  int passed;      /**< 1: the integration continued after it */
  double t_before; /**< the last point before it */
  double t_after;  /**< the first point after it; t_before if it was not passed */
  long count;      /**< singular points passed since sfdae_start */
} sfdae_singular_point;
/** Prepares a result of sfdae_get_singular_point. size: sizeof(sfdae_singular_point). */
SFDAE_API int sfdae_singular_point_init(sfdae_singular_point* point, size_t size);

/** The singular point met last since sfdae_start, whether it ended a call or was passed; SFDAE_NOT_STARTED if there was
 * none. `kind` is determined from earlier points of the integration, which a restored checkpoint does not contain. */
SFDAE_API int sfdae_get_singular_point(const sfdae_solver* solver, sfdae_singular_point* result);

/** Lets integrations continue after singular points, up to max_points of them from sfdae_start on (>= 0; 0, the
 * default, ends them at the first one). If the solution is smooth before such a point, polynomials fitted to the
 * differential variables are extrapolated slightly beyond it and made consistent, hidden constraints included. The
 * point is passed if
 *
 *  - there are such values with the known characteristic values, no farther from the polynomials than their expected
 *    errors, within about ten tolerances;
 *  - x' of the equations there agrees with that of the polynomials to the same accuracy.
 *
 * If not, the call ends with SFDAE_CHARACTERISTICS_CHANGED as without this function; the message gives the reason.
 * Nothing else is checked, for example no energy balance. Branches that touch each other to second order, within
 * tolerances, cannot be distinguished: tight tolerances help. The integration restarts after the point, with
 * extrapolation errors of about the tolerances. Outputs between t_before and t_after are evaluated from the
 * polynomials, and by linear interpolation for components that are not smooth (multipliers may have a pole there).
 *
 * This setting shortens steps near singular points and makes Radau steps slower. It takes effect with the next step,
 * survives sfdae_start and sfdae_set_options and applies to instances of ensembles; checkpoints do not contain it. No
 * point is passed while events are located or sensitivities are computed. */
SFDAE_API int sfdae_pass_singular_points(sfdae_solver* solver, long max_points);

#ifdef __cplusplus
}
#endif

#endif
