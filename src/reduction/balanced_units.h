// Units of equations, unknowns and time in which the entries of E x' = A x are near one.
//
// Small is relative to units: microfarads next to megohms, a structure of fast and slow parts written in meters and
// seconds. Powers of two r_i, c_j and one unit of time 2^s bring all nonzero entries r_i c_j E_ij / 2^s and r_i c_j
// A_ij as near to one as possible in the mean square of their logarithms [CR72]. The same problem in other units is the
// same scaled problem, except for the rounding of exponents: no decision depends on the units of the user.
//
// [CR72] A. R. Curtis, J. K. Reid: On the automatic scaling of matrices for Gaussian elimination. IMA J. Appl. Math.
//        10 (1972) 118-124.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "problem/taylor_data.h"

namespace sfdae::core {

struct BalancedUnits {
  Units unknowns;     // powers of two, one for each unknown
  double time = 1.0;  // 2^s
  // Entries so far below the size suggested by the others that they may be rounding errors of zeros (cos(pi/2) =
  // 6e-17), m x n of E and A; empty: none. They do not count in the units.
  enum class Suspicion : char { none, maybe, certain };
  std::vector<Suspicion> suspects_E, suspects_A;
  bool has_suspects = false;  // any that may be values
};

// data: E and A at a point in the usual units of the unknowns, in which columns are of comparable size; if these are as
// good as balanced ones, entries that are small relative to the largest entries of their row and column are suspicious,
// too.
BalancedUnits balanced_units(const TaylorData& data, const Units& usual);

// True if the entries are within 2^16 of each other: there is nothing to balance.
bool has_even_entries(const TaylorData& data);

// True if the units of the unknowns and of time in use are as good.
bool are_balanced(const Units& used, double time, const BalancedUnits& balanced);

}  // namespace sfdae::core
