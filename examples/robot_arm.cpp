// SPDX-License-Identifier: BSD-3-Clause
//
// Which torques u move the hand of a robot arm with two links, one of its joints elastic, along a given path?
//
//     x1' = v1,  x2' = v2,  x3' = v3        x1, x3: angles of the links, x2: of the motor beyond the elastic joint
//     v1' = 2 c (v1+v3)^2 + d v1^2 + (2 x3 - x2)(a + 2 b) + a (u1 - u2)
//     v2' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(1 - 3 a - 2 b) - a u1 + (a + 1) u2
//     v3' = -2 c (v1+v3)^2 - d v1^2 + (2 x3 - x2)(a - 9 b) - 2 c v1^2 - d (v1+v3)^2 - (a + b)(u1 - u2)
//     cos x1 + cos(x1+x3) = cos(1 - e^t) + cos(1 - t),  the same with sines
//     a = 2 / (2 - cos^2 x3),  b = a/2 cos x3,  c = a/2 sin x3,  d = c cos x3
//
// Strangeness index 4 (differentiation index 5), and the path determines everything: d = 0, a = 8. x1 = 1 - e^t and
// x3 = e^t - t. De Luca, Isidori (1987); Campbell, Griepentrog (1995).
#include <algorithm>
#include <cmath>
#include <iostream>

#include <sfdae/sfdae.hpp>

int main() try {
  sfdae::NonlinearProblem problem(8, 8);
  problem.equations = [](const sfdae::Expression& t, auto q, auto qdot, auto F) {
    const auto x1 = q[0], x2 = q[1], x3 = q[2], v1 = q[3], v2 = q[4], v3 = q[5], u1 = q[6], u2 = q[7];
    const auto a = 2 / (2 - pow(cos(x3), 2)), b = a / 2 * cos(x3), c = a / 2 * sin(x3), d = c * cos(x3);
    const auto first = v1 * v1, both = (v1 + v3) * (v1 + v3), spring = 2 * x3 - x2;
    F[0] = qdot[0] - v1;
    F[1] = qdot[1] - v2;
    F[2] = qdot[2] - v3;
    F[3] = qdot[3] - (2 * c * both + d * first + spring * (a + 2 * b) + a * (u1 - u2));
    F[4] = qdot[4] - (-2 * c * both - d * first + spring * (1 - 3 * a - 2 * b) - a * u1 + (a + 1) * u2);
    F[5] = qdot[5] - (-2 * c * both - d * first + spring * (a - 9 * b));
    F[5] += 2 * c * first + d * both + (a + b) * (u1 - u2);
    F[6] = cos(x1) + cos(x1 + x3) - cos(1 - exp(t)) - cos(1 - t);
    F[7] = sin(x1) + sin(x1 + x3) - sin(1 - exp(t)) - sin(1 - t);
  };
  sfdae::Solver solver(problem);
  sfdae::Point point{0.0, {0, 1, 1, 0, 0, 0, 0, 0}, {}};  // roughly: the start finds the consistent values
  solver.start(point, 1.0);
  double error = 0;
  for (int k = 1; k <= 4; ++k) {
    solver.advance(0.25 * k, point);
    const double e = std::exp(point.t), exact[] = {1 - e, e - point.t, -e, e - 1};
    const std::size_t index[] = {0, 2, 3, 5};
    for (int i = 0; i < 4; ++i) error = std::max(error, std::abs(point.x[index[i]] - exact[i]));
    std::cout << "t = " << point.t << "   torques " << point.x[6] << ", " << point.x[7] << '\n';
  }
  const sfdae::Characteristics c = solver.characteristics();
  std::cout << "mu = " << c.strangeness_index << ", error " << error << ", " << solver.statistics().steps
            << " steps\n";
  error = std::max(error, std::abs(point.x[6] - 13.59126060175974609888));
  return !(error < 1e-10 && c.strangeness_index == 4 && c.differential == 0 && c.algebraic == 8);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
