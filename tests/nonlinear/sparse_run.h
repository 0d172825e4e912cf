// SPDX-License-Identifier: BSD-3-Clause
// Runs of sparse systems and what is asked of them.
#ifndef SFDAE_TESTS_SPARSE_RUN_H
#define SFDAE_TESTS_SPARSE_RUN_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "nonlinear_run.h"
#include "sparse_system.h"

namespace sfdae_test {

// The system lives longer.
inline NonlinearEquations equations_of(const SparseSystem& system) {
  return equations_of(system.n(), system.n(), [&system](const auto& t, const auto* x, const auto* xdot, auto* F) {
    system.residual(t, x, xdot, F);
  });
}

// In a time of which the system's unit has `unit`: the system lives longer.
inline NonlinearEquations in_units(const SparseSystem& system, double unit) {
  return equations_of(system.n(), system.n(),
                      [&system, unit](const auto& t, const auto* x, const auto* xdot, auto* F) {
                        std::vector<std::decay_t<decltype(*x)>> slopes;
                        for (int i = 0; i < system.n(); ++i) slopes.push_back(xdot[i] * unit);
                        system.residual(t * (1.0 / unit), x, slopes.data(), F);
                      });
}

inline sfdae_options options_of(int structure, int method = SFDAE_METHOD_BDF) {
  sfdae_options options = options_with(1e-6, method);
  options.structure = structure;
  return options;
}

// In tolerances of 1e-6 + 1e-6 |x|.
inline double error_in_tolerances(const std::vector<double>& x, const std::vector<double>& exact) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest = std::max(largest, std::fabs(x[i] - exact[i]) / (1e-6 * std::fabs(exact[i]) + 1e-6));
  return largest;
}

inline void pendulum_equations(sfdae_record*, const Expression&, const Expression* x, const Expression* xdot,
                               Expression* F) {
  F[0] = xdot[0] - x[2];
  F[1] = xdot[1] - x[3];
  F[2] = xdot[2] + x[0] * x[4];
  F[3] = xdot[3] + x[1] * x[4] + 9.81;
  F[4] = x[0] * x[0] + x[1] * x[1] - 1.0;
}

inline bool is_known(int status) { return status == SFDAE_OK || status == SFDAE_VALUES_CHANGED; }

}  // namespace sfdae_test

#endif
