// A jet: the Taylor coefficients of x at one t.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "linalg/units.h"

namespace sfdae::core {

// x_k, k = 0..order, at t.
struct Jet {
  // n x (order + 1). Declared first, as members are copied in order: without memory for them the sizes stay, too.
  std::vector<double> x;
  double t = 0.0;
  int n = 0, order = 0;
  double* column(int k) { return x.data() + static_cast<std::ptrdiff_t>(k) * n; }
  const double* column(int k) const { return x.data() + static_cast<std::ptrdiff_t>(k) * n; }
  // Coefficients above the order become 0.
  void set_order(int new_order);
  // The coefficients become those of the polynomial around t + h.
  void shift(double h);
  // Adds changes of x and of y_1, ..., y_highest (one column each), scaled as unknowns of the derivative array:
  // y_k = k tau^k x_k, in the given units.
  void add_scaled(const double* dx, const double* dy, int highest, double tau, const Units& units);
};

}  // namespace sfdae::core
