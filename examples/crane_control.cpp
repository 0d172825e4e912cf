// SPDX-License-Identifier: BSD-3-Clause
// How to push a crane so that trolley and load are at rest one metre further after six seconds: gradients by the
// adjoint.
//
//     s' = a, p' = b, q' = c,   M a' = u + (p - s) r,   m b' = -(p - s) r,   m c' = -q r - m g,   (p - s)^2 + q^2 = l^2
//
// with the force u(t) = sum_j u_j sin(j pi t / 6), j = 1 ... 8. Four conditions on the end values, gradients of four
// functionals: Newton's method, with the smallest step that solves its linear equations (LAPACK's dgels).
#include <cmath>
#include <iostream>
#include <vector>

#include <sfdae/sfdae.hpp>

extern "C" void dgels_(const char* trans, const int* m, const int* n, const int* nrhs, double* A, const int* lda,
                       double* B, const int* ldb, double* work, const int* lwork, int* info, std::size_t);

constexpr int waves = 8, conditions = 4, one = 1, length = 1000;

int main() {
  const double end = 6.0, M = 50, m = 200, l = 3, g = 9.81;  // s, kg, m
  const std::vector<std::string> names = {"u1", "u2", "u3", "u4", "u5", "u6", "u7", "u8"};
  sfdae::NonlinearProblem problem(7, 7);
  problem.equations = [&](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    const sfdae::Expression across = x[1] - x[0], r = x[6];
    sfdae::Expression u = 0.0 * t;
    for (int j = 0; j < waves; ++j)
      u = u + sfdae::parameter(t, names[std::size_t(j)], 0.0) * sin((j + 1) * std::acos(-1.0) / end * t);
    for (int i = 0; i < 3; ++i) F[i] = xdot[i] - x[3 + i];
    F[3] = M * xdot[3] - u - across * r;
    F[4] = m * xdot[4] + across * r;
    F[5] = m * xdot[5] + x[2] * r + m * g;
    F[6] = across * across + x[2] * x[2] - l * l;
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(problem, options);
  sfdae::Sensitivities wanted{names, {}, false, {}, true};
  solver.set_sensitivities(wanted);

  const int components[conditions] = {0, 1, 3, 4};  // s, p and their velocities
  const double target[conditions] = {1, 1, 0, 0};
  sfdae::Matrix weights(7, conditions);
  for (int k = 0; k < conditions; ++k) weights(components[k], k) = 1.0;
  std::vector<double> u(waves), step(waves), work(length);
  u[1] = 50;  // Steps are chosen for x: it has to move where its derivatives do.
  double miss = 1.0;
  for (int iteration = 0, info = 0; iteration < 4; ++iteration) {
    for (int j = 0; j < waves; ++j) solver.set_parameter(names[std::size_t(j)], u[std::size_t(j)]);
    sfdae::Point point{0.0, {0, 0, -l, 0, 0, 0, m * g / l}, {}};
    solver.start(point, end);
    solver.advance(end, point);
    for (int k = 0; k < conditions; ++k) step[std::size_t(k)] = target[k] - point.x[std::size_t(components[k])];
    std::cout << "misses by " << (miss = std::hypot(step[0], step[1], std::hypot(step[2], step[3]))) << '\n';
    sfdae::Matrix gradient = solver.gradient({end}, weights);  // a column for each condition
    dgels_("T", &waves, &conditions, &one, gradient.data(), &waves, step.data(), &waves, work.data(), &length, &info,
           1);
    for (int j = 0; j < waves; ++j) u[std::size_t(j)] += step[std::size_t(j)];
  }
  return miss < 1e-7 ? 0 : 1;
}
