// The Radau IIA methods with 1, 3, 5 and 7 stages, of orders 1, 5, 9 and 13.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996, section IV.5.
// [HW99] E. Hairer, G. Wanner: Stiff differential equations solved by Radau methods. J. Comput. Appl. Math. 111
// (1999).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "system/stage_method.h"

namespace sfdae::core {

struct RadauMethod {
  StageMethod stages;
  // Slope of the collocation polynomial at the start of the step: sum_j slope_at_start_j (w_j - w) / h.
  std::array<double, max_stages> slope_at_start{};
  // The local error is error_constant h^(2s) times the divided difference of order 2s of the solution.
  double error_constant = 0.0;
  // Data of the collocation polynomial (radau_polynomial.h): factors of the Lagrange polynomials, 1 / prod (c_j - c_k)
  // with c_0 = 0, and those of the first s - 1 points only, so that sums of values with them are divided differences of
  // orders s and s - 2; the coefficients of tau^i in Q; and the largest values in [0, 1] of |Q| and of tau |M|.
  std::array<double, max_stages + 1> lagrange_factors{}, lower_factors{};
  std::array<double, max_stages + 2> correction{};
  double largest_correction = 0.0, largest_remainder = 0.0;

  int s() const { return stages.s; }
  int order() const { return 2 * stages.s - 1; }
};

// s = 1, 3, 5 or 7.
const RadauMethod& radau_method(int s);

}  // namespace sfdae::core
