// SPDX-License-Identifier: BSD-3-Clause
// How far a point is from the constraints of a mechanical system.
#ifndef SFDAE_TESTS_MULTIBODY_RESIDUALS_H
#define SFDAE_TESTS_MULTIBODY_RESIDUALS_H

#include <algorithm>
#include <cmath>
#include <vector>

#include "callbacks.h"
#include "system.h"

namespace sfdae_test {

inline double largest_entry(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

// Of |g|, and of |g_t + G v| and |H v + h| relative to the fastest velocity (1 at least), each row in units of its
// gradient times the largest position (both 1 at least).
struct ConstraintResiduals {
  template <class System>
  ConstraintResiduals(const System& system, double t, const double* x) {
    const int n = system.sizes.positions, nl = system.sizes.holonomic, nk = system.sizes.nonholonomic;
    const double* v = x + n;
    double distance = 1.0, speed = 1.0;
    for (int i = 0; i < n; ++i)
      distance = std::max(distance, std::abs(x[i])), speed = std::max(speed, std::abs(v[i]));
    std::vector<double> G = zeros<double>(nl * n), H = zeros<double>(nk * n), h = zeros<double>(nk);
    system.gradient(t, x, G.data());
    system.nonholonomic(t, x, H.data(), h.data());
    std::vector<Jet> path, g(static_cast<std::size_t>(nl));
    for (int i = 0; i < n; ++i) path.push_back(along(x[i], v[i], 1));
    system.constraints(along(t, 1.0, 1), path.data(), g.data());
    for (int i = 0; i < nl; ++i) {
      double unit = 1.0;
      for (int j = 0; j < n; ++j) unit = std::max(unit, std::abs(G[static_cast<std::size_t>(i + j * nl)]));
      const Jet& row = g[static_cast<std::size_t>(i)];
      position = std::max(position, std::abs(row[0]) / (unit * distance));
      velocity = std::max(velocity, std::abs(row[1]) / (unit * speed));
    }
    for (int i = 0; i < nk; ++i) {
      double sum = h[static_cast<std::size_t>(i)];
      for (int j = 0; j < n; ++j) sum += H[static_cast<std::size_t>(i + j * nk)] * v[j];
      velocity = std::max(velocity, std::abs(sum) / speed);
    }
  }
  double position = 0.0, velocity = 0.0;
};

}  // namespace sfdae_test

#endif
