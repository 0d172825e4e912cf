// SPDX-License-Identifier: BSD-3-Clause
//
// Lyapunov exponents and the Sacker-Sell spectrum of a linear DAE E x' = A(t) x by continuous QR, which is a DAE
// itself: solutions X = Q R with Q^T Q = I and R upper triangular fulfil
//
//     E Q' = A Q - E Q B,   Q^T Q = I,   l' = diag B,      B = R' R^-1 upper triangular.
//
// Orthogonality is a constraint that the library keeps, where codes for differential equations let it drift.
// Exponents are l_i(t) / t for large t; the spectral interval i is that of the averages (l_i(t + H) - l_i(t)) / H for
// long windows H, after a transient. The problem: x = G(t) y with a rotation G by t and z = x1 + x2,
//
//     y' = [-5 + cos t, sin t; 0, cos 2t] y:   exponents 0 and -5, and the intervals are these points.
//
// Usage: lyapunov [tend]. Check: exponents and averages, both of which approach their limits like 1 / t.
//
// [LM09] V. H. Linh, V. Mehrmann: Lyapunov, Bohl and Sacker-Sell spectral intervals for differential-algebraic
// equations.
//      J. Dynam. Differential Equations 21 (2009), 153-194.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

#include <sfdae/sfdae.hpp>

using sfdae::Expression;

constexpr int n = 3, d = 2;
enum { B = n * d, L = B + d * (d + 1) / 2, N = L + d };  // Q by columns, B = (b11, b12, b22), l

void continuous_qr(const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
  const Expression c = cos(t), s = sin(t), b11 = c - 5.0, b12 = s, b22 = cos(2.0 * t);
  // G' G^T + G [b11, b12; 0, b22] G^T
  const Expression cross = c * s * (b11 - b22);
  const Expression A[2][2] = {{c * c * b11 - c * s * b12 + s * s * b22, cross + c * c * b12 - 1.0},
                              {cross - s * s * b12 + 1.0, s * s * b11 + c * s * b12 + c * c * b22}};
  const auto Q = [x](int i, int j) { return x[i + n * j]; };
  int row = 0;
  for (int j = 0; j < d; ++j) {
    for (int i = 0; i < 2; ++i) {
      const Expression growth = j == 0 ? Q(i, 0) * x[B] : Q(i, 0) * x[B + 1] + Q(i, 1) * x[B + 2];
      F[row++] = xdot[i + n * j] - (A[i][0] * Q(0, j) + A[i][1] * Q(1, j)) + growth;
    }
    F[row++] = Q(0, j) + Q(1, j) - Q(2, j);
  }
  for (int j = 0; j < d; ++j)
    for (int k = 0; k <= j; ++k)
      F[row++] = Q(0, k) * Q(0, j) + Q(1, k) * Q(1, j) + Q(2, k) * Q(2, j) - (k == j ? 1.0 : 0.0);
  F[row++] = xdot[L] - x[B];
  F[row++] = xdot[L + 1] - x[B + 2];
}

int main(int argc, char** argv) try {
  const double tend = argc > 1 ? std::atof(argv[1]) : 1000.0, window = 0.2 * tend, transient = 0.1 * tend;
  constexpr int samples = 200;
  sfdae::NonlinearProblem problem(N, N);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    continuous_qr(t, &x[0], &xdot[0], &F[0]);
  };
  sfdae::Options options;
  options.rtol = options.atol = 1e-7;
  options.max_steps = 100000000;
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, {0.5, 0.3, 0.8, 0.6, -0.7, -0.1, 0, 0, 0, 0, 0}, {}};  // Q is made orthonormal
  solver.start(point, tend);
  std::vector<std::array<double, d>> l;
  double orthogonality = 0;
  for (int k = 1; k <= samples; ++k) {
    solver.advance(k * tend / samples, point);
    const std::vector<double>& x = point.x;
    l.push_back({x[L], x[L + 1]});
    orthogonality = std::max(orthogonality, std::abs(x[0] * x[3] + x[1] * x[4] + x[2] * x[5]));
  }
  const double exact[d] = {0, -5};
  bool is_right = orthogonality < 1e-10;
  for (int i = 0; i < d; ++i) {
    double lowest = 1e9, highest = -1e9;
    const int first = static_cast<int>(transient / tend * samples), width = static_cast<int>(window / tend * samples);
    for (int k = first; k + width < samples; ++k) {
      const double mean = (l[k + width][i] - l[k][i]) / window;
      lowest = std::min(lowest, mean), highest = std::max(highest, mean);
    }
    const double exponent = l.back()[i] / tend;
    std::cout << "exponent " << i + 1 << ": " << exponent << ", spectral interval [" << lowest << ", " << highest
              << "]\n";
    is_right = is_right && std::abs(exponent - exact[i]) < 4 / tend && std::abs(lowest - exact[i]) < 4 / window &&
               std::abs(highest - exact[i]) < 4 / window;
  }
  const sfdae::Characteristics c = solver.characteristics();
  std::cout << "mu = " << c.strangeness_index << ", d = " << c.differential << ", " << solver.statistics().steps
            << " steps, Q^T Q = I to " << orthogonality << '\n';
  return !is_right;
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
