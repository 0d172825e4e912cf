// SPDX-License-Identifier: BSD-3-Clause
// Gravity g and length L of a pendulum from positions that a camera has seen: Gauss-Newton by LAPACK's dgels.
//
//     x1' = x3,   x2' = x4,   x3' = -2 x1 x5,   x4' = -2 x2 x5 - g,   0 = x1^2 + x2^2 - L^2,   x(0) = L (0.6, -0.8)
//
// Strangeness index 2 (differentiation index 3); S = dx/d(g, L) fulfils the hidden constraints as x does.
#include <cmath>
#include <iostream>
#include <vector>

#include <sfdae/sfdae.hpp>

extern "C" void dgels_(const char* trans, const int* m, const int* n, const int* nrhs, double* A, const int* lda,
                       double* B, const int* ldb, double* work, const int* lwork, int* info, std::size_t);

constexpr int rows = 40, columns = 2, one = 1, length = 1000;

// Measured less simulated positions for p = (g, L), one below the other, and J: the latter differentiated by p.
void compare(sfdae::Solver& solver, const double* p, const sfdae::Matrix& measured, sfdae::Matrix& b,
             sfdae::Matrix& J) {
  solver.set_parameter("g", p[0]);
  solver.set_parameter("L", p[1]);
  sfdae::Point point{0.0, {0.6 * p[1], -0.8 * p[1], 0, 0, 0}, {}};
  solver.start(point, 3);
  for (int k = 0; k < rows; ++k) {
    if (k % 2 == 0) solver.advance(3.0 * (k + 2) / rows, point);
    const sfdae::Matrix S = solver.sensitivities(point.t, false).S;
    b(k, 0) = measured(k, 0) - point.x[std::size_t(k % 2)];
    for (int j = 0; j < columns; ++j) J(k, j) = S(k % 2, j);
  }
}

int main() {
  sfdae::NonlinearProblem problem(5, 5);
  problem.equations = [](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2 * x[0] * x[4];
    F[3] = xdot[3] + 2 * x[1] * x[4] + sfdae::parameter(t, "g", 9.0);
    F[4] = x[0] * x[0] + x[1] * x[1] - pow(sfdae::parameter(t, "L", 1.0), 2);
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(problem, options);
  sfdae::Sensitivities wanted{{"g", "L"}, sfdae::Matrix(5, 2), false, {}};
  wanted.directions(0, 1) = 0.6, wanted.directions(1, 1) = -0.8;  // of the start values, by L
  solver.set_sensitivities(wanted);
  const double truth[] = {9.81, 1.2};
  double p[] = {9.0, 1.0}, work[length];
  sfdae::Matrix J(rows, columns), b(rows, 1), measured(rows, 1);
  compare(solver, truth, measured, b, J);
  for (int k = 0; k < rows; ++k) measured(k, 0) = -b(k, 0);
  for (int iteration = 0, info = 0; iteration < 6; ++iteration) {
    compare(solver, p, measured, b, J);
    dgels_("N", &rows, &columns, &one, J.data(), &rows, b.data(), &rows, work, &length, &info, 1);
    for (int j = 0; j < columns; ++j) p[j] += b(j, 0);
    std::cout << "g = " << p[0] << ", L = " << p[1] << '\n';
  }
  return !(std::hypot(p[0] - truth[0], p[1] - truth[1]) < 1e-6);
}
