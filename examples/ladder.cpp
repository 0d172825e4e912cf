// SPDX-License-Identifier: BSD-3-Clause
//
// A cable as a ladder of 200 sections, in SI units: 601 unknowns, which sparse matrices make a matter of a fraction
// of a second. Coils with resistance, capacitors, a source v_0 and a load Z; section k = 1, ..., N:
//
//     v_0 = V sin(w t),   u_k = v_k-1 - R i_k,   L i_k' = u_k - v_k,   C v_k' = i_k - i_k+1,   i_N+1 = v_N / Z
//
// Strangeness index 0, d = 2 N, a = N + 1. Check: transients die out like exp(-R t / (2 L)), and what remains is
// known by complex arithmetic, from the load back to the source, which is the continued fraction of the ladder.
#include <algorithm>
#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>
#include <vector>

#include <sfdae/sfdae.hpp>

int main() try {
  constexpr int N = 200, n = 3 * N + 1;
  constexpr double V = 10, R = 1, L = 1e-6, C = 1e-9, Z = 31.6, w = 2 * std::numbers::pi * 1e5;
  constexpr auto i = [](int k) { return 3 * k - 2; };  // unknowns: v_0, then i_k, u_k, v_k of each section
  constexpr auto u = [](int k) { return 3 * k - 1; };
  constexpr auto v = [](int k) { return 3 * k; };

  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [&](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    F[0] = x[0] - V * sin(w * t);
    for (int k = 1; k <= N; ++k) {
      F[i(k)] = x[v(k - 1)] - R * x[i(k)] - x[u(k)];
      F[u(k)] = L * xdot[i(k)] - x[u(k)] + x[v(k)];
      F[v(k)] = C * xdot[v(k)] - x[i(k)] + (k < N ? x[i(k + 1)] : x[v(N)] / Z);
    }
  };

  sfdae::Options options;
  options.rtol = 1e-6;
  options.atol = 1e-9;
  options.method = SFDAE_METHOD_RADAU;
  options.structure = SFDAE_STRUCTURE_REQUIRED;  // a problem as large as this has sparse matrices without it, too
  sfdae::Solver solver(problem, options);
  constexpr double tend = 52.5e-6;
  sfdae::Point point{0.0, std::vector<double>(n), {}};
  solver.start(point, tend);
  solver.advance(tend, point);

  // Phasors, that of v_N being 1: back through capacitor, coil and resistor of each section.
  const std::complex<double> s(0, w);
  std::complex<double> voltage = 1, current = 1 / Z;
  for (int k = N; k >= 1; --k) {
    current += s * C * voltage;
    voltage += (R + s * L) * current;
  }
  const std::complex<double> load = V / voltage, source = load * current, now = std::exp(s * tend);
  const double error = std::max(std::abs(point.x[i(1)] - std::imag(source * now)) / std::abs(source),
                                std::abs(point.x[v(N)] - std::imag(load * now)) / std::abs(load));
  const sfdae::Characteristics c = solver.characteristics();
  std::cout << solver.statistics().steps << " steps; current of the source " << point.x[i(1)]
            << " A, voltage of the load " << point.x[v(N)] << " V, relative error " << error << '\n';
  return !(error < 1e-4 && c.strangeness_index == 0 && c.differential == 2 * N && c.algebraic == N + 1);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
