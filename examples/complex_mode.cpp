// SPDX-License-Identifier: BSD-3-Clause
//
// Complex problems as real ones of twice the size: an amplitude a that a real gain g keeps at |a|^2 = 1 + t,
//
//     a' = (i w + g) a,   0 = |a|^2 - (1 + t) + i im g,
//
// with a = sqrt(1 + t) e^(i w t), g = 1 / (2 (1 + t)); the equation that determines re g is hidden: strangeness index
// 1. And E z' = A z with complex matrices: z1' = i z2, 0 = z1 - (1 + i) z2.
// Check: both against their solutions.
#include <algorithm>
#include <cmath>
#include <complex>
#include <iostream>
#include <vector>

#include <sfdae/complex.hpp>
#include <sfdae/sfdae.hpp>

using Numbers = std::vector<std::complex<double>>;

constexpr std::complex<double> i{0.0, 1.0};
constexpr double w = 3.0, tolerance = 1e-8;

double error_of_amplitude() {
  sfdae::NonlinearProblem problem = sfdae::complex_problem(2, 2, [](auto& t, auto& x, auto& xdot, auto& F) {
    const sfdae::ComplexExpression &a = x[0], &g = x[1];
    F[0] = xdot[0] - (i * w + g) * a;
    F[1] = {norm(a) - (1.0 + t), imag(g)};
  });
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, sfdae::real_form({1.0, 0.0}), {}};
  solver.start(point, 2);  // finds g
  solver.advance(2, point);
  const Numbers x = sfdae::complex_form(point.x);
  std::cout << "mu = " << solver.characteristics().strangeness_index << ", a(2) = " << x[0] << ", g(2) = " << x[1]
            << '\n';
  return std::max(std::abs(x[0] - std::polar(std::sqrt(3.0), 2 * w)), std::abs(x[1] - 1.0 / 6.0));
}

double error_of_matrices() {
  sfdae::LinearProblem problem(4, 4);
  problem.E = [](double, int order, auto E) {
    if (order == 0) sfdae::write_real_form({1.0, 0.0, 0.0, 0.0}, E);
  };
  problem.A = [](double, int order, auto A) {
    if (order == 0) sfdae::write_real_form({0.0, 1.0, i, -(1.0 + i)}, A);
  };
  problem.constant_E = problem.constant_A = 1;
  sfdae::Options options;
  options.rtol = options.atol = tolerance;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, sfdae::real_form({1.0 + i, 1.0}), {}};
  solver.start(point, 2);
  solver.advance(2, point);
  const Numbers z = sfdae::complex_form(point.x);
  const std::complex<double> exact = std::exp(2.0 * i / (1.0 + i));  // z2
  std::cout << "z(2) = " << z[0] << ", " << z[1] << '\n';
  return std::max(std::abs(z[1] - exact), std::abs(z[0] - (1.0 + i) * exact));
}

int main() try {
  const double error = std::max(error_of_amplitude(), error_of_matrices());
  std::cout << "error " << error << '\n';
  return !(error < 100 * tolerance);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
