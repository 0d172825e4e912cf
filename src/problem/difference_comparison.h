// Values that a user supplies as a derivative, compared with differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "problem/problem.h"

namespace sfdae::core {

struct DerivativeMismatch {
  char function = 0;  // 'E', 'A', 'f'; 'F', 'x' (F_x), 'd' (F_x'); 'G', 'T', 'C', 'H' (g_q, g_t, gamma, eta); 0: none
  int order = 0, row = 0, column = 0;
  double supplied = 0.0, difference = 0.0;
  double error = 0.0;        // |supplied - difference| relative to the size of the derivatives compared
  double uncertainty = 0.0;  // of the difference, relative to that size
  // An estimate of the uncertainty is right to two digits at most; wrong derivatives are off by far more.
  bool suspicious() const { return error > 100.0 * uncertainty; }
};

// "derivative 1 of E", "constraint_jacobian (g_q)"
std::string name_of(const DerivativeMismatch& mismatch);

// Entries of a derivative: `rows` to a column, the first one being `first_column` of the function's matrix.
struct SuppliedDerivative {
  char function;
  int order, rows, first_column;
  std::vector<double> values;
};

// Writes the function that is differentiated, at an offset from the point.
using OffsetFunction = std::function<CallbackError(double offset, double* values)>;

// Unit of the spacings in time: 1 near t = 0; a thousandth of |t| far away, so that the rounding of t is negligible.
inline double unit_of_time(double t) { return std::max(1.0, std::fabs(t) * 1e-3); }

// Differences at spacings of 0.1 unit and less. `worst` becomes the worst mismatch, measured by error / uncertainty, of
// the entries and its former value. Throws Failure if the function fails permanently.
void compare_with_differences(const SuppliedDerivative& supplied, double unit, const OffsetFunction& function,
                              DerivativeMismatch& worst);

}  // namespace sfdae::core
