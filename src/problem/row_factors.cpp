// Row scaling of [E A].
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/row_factors.h"

#include <algorithm>
#include <cmath>

namespace sfdae::core {

namespace {

// 2^exponent; no factor overflows or loses bits.
double power_of_two(int exponent) { return std::ldexp(1.0, std::clamp(exponent, -1020, 1020)); }

}  // namespace

// Units of time beyond 1e39 = 2^130 would make right-hand sides overflow, and those below 2^-900 the powers of their
// inverses.
double power_of_two_near(double x) {
  return std::ldexp(1.0, std::clamp(static_cast<int>(std::lround(std::log2(x))), -900, 130));
}

double unit_of_A(RowScaling rows, double tau) {
  if (rows == RowScaling::timed) return tau;
  return rows == RowScaling::common ? 1.0 : std::max(tau, 1.0);
}

void become_row_factors(std::vector<double>& sizes, RowScaling rows) {
  const double largest = *std::max_element(sizes.begin(), sizes.end());
  const int top = largest == 0.0 ? 0 : std::ilogb(largest);
  const double top_mantissa = std::ldexp(largest, -top);
  for (double& size : sizes) {
    if (size == 0.0 || rows == RowScaling::common) {
      size = power_of_two(-top);
      continue;
    }
    const int exponent = std::ilogb(size);
    size = power_of_two(-exponent + (std::ldexp(size, -exponent) < top_mantissa ? 1 : 0));
  }
}

}  // namespace sfdae::core
