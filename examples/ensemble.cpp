// SPDX-License-Identifier: BSD-3-Clause
//
// Two hundred pendula in Cartesian coordinates, each of its own length L and gravity g, on all processors:
//
//     x1' = x3,   x2' = x4,   x3' = -2 x1 x5,   x4' = -2 x2 x5 - g,   0 = x1^2 + x2^2 - L^2
//
// Swings by a small angle have the period 2 pi sqrt(L / g) (1 + angle^2 / 16 + ...): after it each is where it began.
// It is measured here by the passage of the lowest point, at times around a quarter of it.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <random>

#include <sfdae/sfdae.hpp>

int main() try {
  constexpr int instances = 200;
  constexpr double angle = 0.1;
  sfdae::NonlinearProblem pendulum(5, 5);
  pendulum.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const sfdae::Expression g = parameter(t, "g", 9.81), L = parameter(t, "L", 1.0);
    F[0] = xdot[0] - x[2], F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2.0 * x[0] * x[4], F[3] = xdot[3] + 2.0 * x[1] * x[4] + g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  };
  sfdae::Ensemble ensemble;
  ensemble.parameter_names = {"g", "L"};
  ensemble.parameters = sfdae::Matrix(2, instances);
  ensemble.x0 = sfdae::Matrix(5, instances);
  std::minstd_rand generator(1);
  for (int i = 0; i < instances; ++i) {
    const auto random = [&] { return 1.0 + static_cast<double>(generator()) / generator.max(); };
    const double L = ensemble.parameters(1, i) = random();
    ensemble.parameters(0, i) = 5.0 * random();
    ensemble.x0(0, i) = L * std::sin(angle), ensemble.x0(1, i) = -L * std::cos(angle);
  }
  for (int k = 0; k <= 100; ++k) ensemble.times.push_back(0.01 * k);

  sfdae::Solver solver(pendulum);
  const sfdae::EnsembleSolution solution = solver.solve_ensemble(ensemble);
  double worst = 0.0;
  for (int i = 0; i < instances; ++i) {
    int k = 1;
    while (solution.x(i, k)[0] > 0.0) ++k;  // beyond the lowest point
    const double before = solution.x(i, k - 1)[0], after = solution.x(i, k)[0];
    const double quarter = 0.01 * (k - 1 + before / (before - after));
    const double g = ensemble.parameters(0, i), L = ensemble.parameters(1, i);
    const double expected = 0.5 * std::numbers::pi * std::sqrt(L / g) * (1.0 + angle * angle / 16.0);
    worst = std::max(worst, std::abs(quarter / expected - 1.0));
  }
  std::cout << instances << " pendula on " << solution.num_threads << " threads, " << solution.num_analyses
            << " index analyses, worst error of a period " << worst << '\n';
  return solution.status == SFDAE_OK && worst < 1e-4 ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return EXIT_FAILURE;
}
