// Jump from values that were reached with other equations to consistent ones, by impulses of the new equations.
//
// Let x be x- before t and consistent after it, with impulses xi_0 delta + xi_1 delta' + ... at t, and let the new
// equations hold from t on in the sense of distributions [T09], so that E x' contains E (x+ - x-) delta. With
// xi_-1 := x+ - x-, delta^(p) has the factor
//
//     sum_k (-1)^(k+1-p) C(k+1,p) E^(k+1-p) xi_k  =  sum_k (-1)^(k-p) C(k,p) A^(k-p) xi_k,     p = 0, ..., mu
//
// For constant E and A: E (x+ - x-) = A xi_0, E xi_0 = A xi_1, ..., E xi_(mu-1) = 0. For a regular pencil, x+ is then
// the consistency projector of x-, apart from the effect of f: in Weierstrass form the part that obeys an ODE stays,
// and the rest becomes consistent. There are no impulses of order mu or more. In Taylor coefficients, theta_0 = x+ - x-
// and theta_j = (-1)^j j! tau^-j xi_(j-1),
//
//     sum_{j >= p} ( E_{j-p} + A_{j-p-1} / j ) theta_j = 0,     p = 0, ..., mu        (A_-1 = 0)
//
// with x+ = xp + T2 z: (mu+1) m equations for d + mu n unknowns, which have full column rank if u = 0, so that no rank
// is decided here.
//
// [T09] S. Trenn: Distributional differential algebraic equations. Dissertation, TU Ilmenau, 2009.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "starts/consistent_values.h"
#include "system/jump.h"

namespace sfdae::core {

// Components that are functions of time, without impulses. values: after the jump, as changes of the point that the
// constraints belong to, if its form does not contain them; else empty.
struct InputsAfter {
  const std::vector<int>& components;
  std::vector<double> values;
};

// data: the coefficients up to order mu, all rows. size: the reference of rounding errors if values are changes of a
// point, in scaled units.
struct ImpulseEquations {
  const ConstrainedPoint& point;
  const TaylorData& data;
  int mu;
  const InputsAfter& inputs;
  double size = 0.0;
};

// Residuals that rounding errors of values of this size may leave in the equations.
double rounding_of_impulses(const ConstrainedPoint& point, double size);

// before: x-, in the user's units, as the result. theta, if not null: in scaled units, n x (mu + 1). Throws Failure:
// SFDAE_NO_CONSISTENT_VALUES if the equations do not determine x+, or there is none.
Jump jump_by_impulses(const ImpulseEquations& equations, const std::vector<double>& before, Matrix* theta = nullptr);

// C += the block E_{j-p} + A_{j-p-1} / j.
void add_impulse_block(const TaylorData& data, int p, int j, View C);
// Rows p = 0, ..., mu of the equations, columns theta_1, ..., theta_mu.
Matrix impulse_columns(const TaylorData& data, int mu);

// y := the least squares solutions of C y = b for all right-hand sides; C and b are overwritten. False if C does not
// have full column rank, for example if impulses can lead to several values.
bool solve_least_squares(View C, View b, View y, Arena& arena);

// Residuals of the equations above for these theta and the coefficients of another point, beyond rounding errors and
// relative to the sum of terms in each: mu + 1 blocks of m rows.
std::vector<double> residuals_of_impulses(const TaylorData& data, int mu, ConstView theta, double rounding);

}  // namespace sfdae::core
