// SPDX-License-Identifier: BSD-3-Clause
// Pryce's chain of P pendula, each as long as the tension of the one before says: strangeness index 2 P, d = 2 P.
//
//     x_k' = u_k,   y_k' = v_k,   u_k' = -l_k x_k,   v_k' = -l_k y_k - g,   x_k^2 + y_k^2 = (r_k)^2,
//     r_1 = L,   r_(k+1) = L (1 + l_k / 10)
//
// g = L: all lengths are in units of L.
#ifndef SFDAE_TESTS_PENDULUM_CHAIN_H
#define SFDAE_TESTS_PENDULUM_CHAIN_H

#include <cmath>
#include <cstddef>
#include <vector>

#include "nonlinear_run.h"

namespace sfdae_test {

inline NonlinearEquations pendulum_chain(int pendula, double L = 1.0) {
  return {5 * pendula, 5 * pendula,
          [pendula, L](sfdae_record*, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
            for (int k = 0; k < pendula; ++k, x += 5, xdot += 5, F += 5) {
              F[0] = xdot[0] - x[2];
              F[1] = xdot[1] - x[3];
              F[2] = xdot[2] + x[4] * x[0];
              F[3] = xdot[3] + x[4] * x[1] + L;
              const Expression radius = k == 0 ? Expression(L) : L * (1.0 + 0.1 * x[-1]);
              F[4] = x[0] * x[0] + x[1] * x[1] - radius * radius;
            }
          }};
}

// All rods at one angle to the horizontal, at rest, with the multiplier given.
inline std::vector<double> chain_at_rest(int pendula, double angle, double multiplier, double L = 1.0) {
  std::vector<double> x;
  for (int k = 0; k < pendula; ++k)
    for (const double value : {L * std::cos(angle), L * std::sin(angle), 0.0, 0.0, multiplier}) x.push_back(value);
  return x;
}

// Of the first pendulum, which does not know of the others, in units of L^2.
inline double energy(const std::vector<double>& x, double L = 1.0) {
  return (0.5 * (x[2] * x[2] + x[3] * x[3]) / L + x[1]) / L;
}

// The largest error of x_k^2 + y_k^2 = r_k^2, relative.
inline double error_of_lengths(const std::vector<double>& x, double L = 1.0) {
  double largest = 0.0;
  for (std::size_t b = 0; b < x.size(); b += 5) {
    const double radius = b == 0 ? L : L * (1.0 + 0.1 * x[b - 1]);
    largest = std::fmax(largest, std::fabs((x[b] * x[b] + x[b + 1] * x[b + 1]) / (radius * radius) - 1.0));
  }
  return largest;
}

}  // namespace sfdae_test

#endif
