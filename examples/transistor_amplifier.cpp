// SPDX-License-Identifier: BSD-3-Clause
//
// A two-transistor amplifier as nodal analysis gives it, one equation for each of the nodes 1 ... 8, with the signal
// 0.1 V sin(200 pi t) at the input and 6 V supply. U: voltages of the nodes; currents into a node add up to zero:
//
//     node 1:  (U_in - U1) / R0 + C1 (U2 - U1)' = 0
//     node 2:  (6 - U2) / R - U2 / R + C1 (U1 - U2)' - 0.01 I(U2 - U3) = 0, and so on
//
// A transistor with the voltage U between base and emitter takes 0.01 I(U) from the base and 0.99 I(U) from the
// collector, I(U) = 1e-6 A (exp(U / 26 mV) - 1). Strangeness index 0, d = 5, a = 3.
// Reference values: test set for IVP solvers.

#include <algorithm>
#include <cmath>
#include <iostream>

#include <sfdae/sfdae.hpp>

using sfdae::Expression;

int main() try {
  sfdae::NonlinearProblem problem(8, 8);
  problem.equations = [](const Expression& t, auto U, auto Udot, auto F) {
    const double supply = 6, R0 = 1000, R = 9000, pi = std::acos(-1.0);
    const auto resistor = [&](const Expression& a, const Expression& b) { return (b - a) / R; };
    const auto transistor = [&](int base) { return 1e-6 * (exp((U[base] - U[base + 1]) / 0.026) - 1); };
    F[0] = (0.1 * sin(200 * pi * t) - U[0]) / R0;
    F[1] = resistor(U[1], supply) + resistor(U[1], 0) - 0.01 * transistor(1);
    F[2] = resistor(U[2], 0) + transistor(1) - 2e-6 * Udot[2];
    F[3] = resistor(U[3], supply) - 0.99 * transistor(1);
    F[4] = resistor(U[4], supply) + resistor(U[4], 0) - 0.01 * transistor(4);
    F[5] = resistor(U[5], 0) + transistor(4) - 4e-6 * Udot[5];
    F[6] = resistor(U[6], supply) - 0.99 * transistor(4);
    F[7] = resistor(U[7], 0);
    for (int k : {0, 3, 6}) {  // capacitors of 1, 3 and 5 microfarads from node k to node k + 1
      const int to = k == 6 ? 7 : k + 1;
      const double C = k == 0 ? 1e-6 : k == 3 ? 3e-6 : 5e-6;
      F[k] += C * (Udot[to] - Udot[k]);
      F[to] += C * (Udot[k] - Udot[to]);
    }
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-7;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, {0, 3, 3, 6, 3, 3, 6, 0}, {}};
  solver.start(point, 0.2);
  solver.advance(0.2, point);
  const double reference[] = {-0.5562145012262709e-2, 3.006522471903042, 2.849958788608128, 2.926422536206241,
                              2.704617865010554,      2.761837778393145, 4.770927631616772, 1.236995868091548};
  double error = 0;
  for (std::size_t i = 0; i < 8; ++i) error = std::max(error, std::abs(point.x[i] - reference[i]));
  std::cout << "output " << point.x[7] << " V, error " << error << ", " << solver.statistics().steps << " steps\n";
  return !(error < 1e-4);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
