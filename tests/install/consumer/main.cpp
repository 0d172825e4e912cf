// SPDX-License-Identifier: BSD-3-Clause
// x1' = x2,  0 = x1 - sin t;  index 2:  x1 = sin t,  x2 = cos t, exact up to rounding errors.
#include <cmath>
#include <cstdio>

#include <sfdae/sfdae.hpp>

int main() try {
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double, int order, sfdae::MatrixRef E) {
    if (order == 0) E(0, 0) = 1;
  };
  problem.A = [](double, int order, sfdae::MatrixRef A) {
    if (order == 0) A(0, 1) = 1, A(1, 0) = 1;
  };
  problem.f = [](double t, int order, sfdae::VectorRef f) { f[1] = -std::sin(t + order * std::acos(0.0)); };

  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {0.0, 0.0}, {}};
  solver.start(point, 2.0);
  solver.advance(2.0, point);
  const double error = std::abs(point.x[0] - std::sin(point.t)) + std::abs(point.x[1] - std::cos(point.t));
  std::printf("sfdae %s: x(%g) = (%g, %g), error %g\n", sfdae::version(), point.t, point.x[0], point.x[1], error);
  return !(point.t == 2.0 && error <= 1e-12);
} catch (const sfdae::Error& error) {
  std::printf("%s: %s\n", sfdae::status_name(error.status()), error.what());
  return 1;
}
