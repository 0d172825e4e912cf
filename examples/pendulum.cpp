// SPDX-License-Identifier: BSD-3-Clause
//
// pendulum.c in C++, as a template that serves numbers, too:
//
//     x1' = x3,   x2' = x4,   x3' = -2 x1 x5,   x4' = -2 x2 x5 - g,   0 = x1^2 + x2^2 - 1
//
// Strangeness index 2 (differentiation index 3), d = 2, a = 3. The energy is an invariant; at any point x and x' fulfil
// the equations.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include <sfdae/sfdae.hpp>

template <class Number, class Vector, class Result>
void pendulum(const Number& g, const Vector& x, const Vector& xdot, Result& F) {
  F[0] = xdot[0] - x[2];
  F[1] = xdot[1] - x[3];
  F[2] = xdot[2] + 2 * x[0] * x[4];
  F[3] = xdot[3] + 2 * x[1] * x[4] + g;
  F[4] = x[0] * x[0] + x[1] * x[1] - 1;
}

int main() try {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    pendulum(sfdae::parameter(t, "g", 9.81), x, xdot, F);
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(problem, options);
  double worst = 0;
  for (double g : {9.81, 1.62}) {  // on the earth and on the moon
    solver.set_parameter("g", g);
    sfdae::Point point{0.0, {0.6, -0.8, 0, 0, 0}, {}};  // at rest; 0 stands for the force
    solver.start(point, 10);
    for (int k = 1; k <= 10; ++k) {
      solver.advance(k, point);
      const std::vector<double>& x = point.x;
      std::vector<double> F(5);
      pendulum(g, x, point.xdot, F);
      for (double entry : F) worst = std::max(worst, 1e-2 * std::abs(entry));  // the error of x' is that of x over h
      worst = std::max(worst, std::abs((x[2] * x[2] + x[3] * x[3]) / 2 + g * (x[1] + 0.8)));
      worst = std::max(worst, std::abs(x[0] * x[2] + x[1] * x[3]));
    }
    std::cout << "g = " << g << ": x(10) = (" << point.x[0] << ", " << point.x[1] << "), "
              << solver.statistics().steps << " steps\n";
  }
  const sfdae::Characteristics c = solver.characteristics();
  std::cout << "mu = " << c.strangeness_index << ", worst error " << worst << '\n';
  return !(worst < 1e-6 && c.strangeness_index == 2 && c.differential == 2 && c.algebraic == 3);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
