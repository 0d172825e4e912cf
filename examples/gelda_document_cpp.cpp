// SPDX-License-Identifier: BSD-3-Clause
//
// gelda_document.c in C++:
//
//     0         = -x1 + t x2 + e^-t
//     x1' - t x2' = 0                        exact solution  x1 = (1 + t) e^-t,  x2 = e^-t
//
// Strangeness index 1, d = 0, a = 2: the equations leave no freedom, initial values cannot be chosen.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include <sfdae/sfdae.hpp>

int main() try {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double t, int order, sfdae::MatrixRef E) {
    if (order == 0) E(1, 0) = 1, E(1, 1) = -t;
    if (order == 1) E(1, 1) = -1;
  };
  problem.A = [](double t, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 0) = -1, A(0, 1) = t;
    if (order == 1) A(0, 1) = 1;
  };
  problem.f = [](double t, int order, sfdae::VectorRef f) { f[0] = order % 2 ? -std::exp(-t) : std::exp(-t); };

  sfdae::Options options;
  options.monitor = [](const sfdae::Progress& progress) {
    std::cout << "step " << progress.steps << " to t = " << progress.t << '\n';
    return false;  // do not stop
  };

  sfdae::Solver solver(std::move(problem), options);
  sfdae::Point point{0.0, {5.0, -3.0}, {}};  // anything: the start finds the consistent values
  solver.start(point, 2.0);
  double error = 0;
  for (int k = 1; k <= 4; ++k) {
    solver.advance(0.5 * k, point);
    const double exact = std::exp(-point.t);
    error = std::max({error, std::abs(point.x[0] - (1 + point.t) * exact), std::abs(point.x[1] - exact)});
    std::cout << "x(" << point.t << ") = (" << point.x[0] << ", " << point.x[1] << ")\n";
  }
  std::cout << solver.report() << "error " << error << '\n';
  const sfdae::Characteristics c = solver.characteristics();
  return !(error <= 1e-12 && c.strangeness_index == 1 && c.differential == 0 && c.algebraic == 2);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
