// Problems whose starts are timed: equations with the values they start from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sfdae/sfdae.hpp>
#include <vector>

#include "linalg/index.h"
#include "test_set/test_set.h"

namespace sfdae_bench {

struct StartProblem {
  sfdae::NonlinearProblem equations;
  std::vector<double> guess, xdot;  // xdot: empty, or guessed as well
  double t0 = 0.0, tf = 1.0;
};

// x_i' = -x_i + 0.3 x_(i+1) z_i - 0.1 z_(i+3), 0 = z_i + 0.1 z_i^3 - sin x_i - 0.2 z_(i+1): strangeness index 0, n / 2
// of each, z unknown.
inline StartProblem semi_explicit(int n) {
  const int h = n / 2;
  StartProblem start{sfdae::NonlinearProblem(n, n), std::vector<double>(sfdae::core::index(n), 0.0), {}};
  start.equations.equations = [h](const sfdae::Expression&, auto x, auto xdot, auto F) {
    for (int i = 0; i < h; ++i) {
      const auto z = x[h + i];
      F[i] = xdot[i] + x[i] - 0.3 * x[(i + 1) % h] * z + 0.1 * x[h + (i + 3) % h];
      F[h + i] = z + 0.1 * z * z * z - sin(x[i]) - 0.2 * x[h + (i + 1) % h];
    }
  };
  for (int i = 0; i < h; ++i) start.guess[sfdae::core::index(i)] = 0.5 + 0.01 * i;
  return start;
}

// u' = (k(u) u_x)_x, k = 1 + u^2, on n points with insulated ends: strangeness index 0, no algebraic equations.
inline StartProblem heat(int n) {
  StartProblem start{sfdae::NonlinearProblem(n, n), std::vector<double>(sfdae::core::index(n)), {}};
  start.equations.equations = [n](const sfdae::Expression&, auto u, auto udot, auto F) {
    const double inverse_h2 = static_cast<double>(n) * n;
    const auto flux = [&](int i) {  // between i and i + 1
      const auto mean = 0.5 * (u[i] + u[i + 1]);
      return inverse_h2 * (1.0 + mean * mean) * (u[i + 1] - u[i]);
    };
    for (int i = 0; i < n; ++i) {
      if (i == 0) F[i] = udot[i] - flux(i);
      else if (i == n - 1) F[i] = udot[i] + flux(i - 1);
      else F[i] = udot[i] - flux(i) + flux(i - 1);
    }
  };
  for (int i = 0; i < n; ++i) {
    const double s = (i + 0.5) / n;
    start.guess[sfdae::core::index(i)] = s * s * (3.0 - 2.0 * s);
  }
  return start;
}

// Stokes' equations u' = nu Laplace u - B p + f, B^T u = 0, on a square of cells x cells with velocities on the sides
// of the cells and a lid that moves; p = 0 in the first cell. Strangeness index 1, n = 2 cells (cells - 1) + cells^2.
inline StartProblem stokes(int cells) {
  const int N = cells, sides = N * (N - 1), n = 2 * sides + N * N;
  StartProblem start{sfdae::NonlinearProblem(n, n), std::vector<double>(sfdae::core::index(n), 0.0), {}};
  start.equations.equations = [N, sides](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    const double h = 1.0 / N, nu = 0.1 / (h * h);
    // u: between the cells (i, j) and (i + 1, j); v: between (i, j) and (i, j + 1).
    const auto u = [N](int i, int j) { return i + j * (N - 1); };
    const auto v = [N, sides](int i, int j) { return sides + i + j * N; };
    const auto p = [N, sides](int i, int j) { return 2 * sides + i + j * N; };
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N - 1; ++i) {
        const int row = u(i, j), row_v = v(j, i);
        auto r = xdot[row] + (x[p(i + 1, j)] - x[p(i, j)]) / h + 4.0 * nu * x[row];
        auto s = xdot[row_v] + (x[p(j, i + 1)] - x[p(j, i)]) / h + 4.0 * nu * x[row_v];
        if (i > 0) r = r - nu * x[u(i - 1, j)], s = s - nu * x[v(j, i - 1)];
        if (i < N - 2) r = r - nu * x[u(i + 1, j)], s = s - nu * x[v(j, i + 1)];
        if (j > 0) r = r - nu * x[u(i, j - 1)], s = s - nu * x[v(j - 1, i)];
        else r = r + nu * x[row], s = s + nu * x[row_v];
        if (j < N - 1) r = r - nu * x[u(i, j + 1)], s = s - nu * x[v(j + 1, i)];
        else r = r + nu * x[row] - 2.0 * nu * sin(t), s = s + nu * x[row_v];
        F[row] = r;
        F[row_v] = s;
      }
    for (int j = 0; j < N; ++j)
      for (int i = 0; i < N; ++i) {
        sfdae::Expression flow = 0.0;
        if (i < N - 1) flow = flow + x[u(i, j)];
        if (i > 0) flow = flow - x[u(i - 1, j)];
        if (j < N - 1) flow = flow + x[v(i, j)];
        if (j > 0) flow = flow - x[v(i, j - 1)];
        F[p(i, j)] = i + j == 0 ? sfdae::Expression(x[p(0, 0)]) : flow / h;
      }
  };
  return start;
}

// One of the test set.
template <class Residual>
StartProblem of_test_set(const sfdae_test::TestProblem& problem, Residual residual) {
  StartProblem start{sfdae::NonlinearProblem(problem.m, problem.n), problem.x0, {}, problem.t0, problem.tf};
  start.equations.equations = [residual](const sfdae::Expression& t, auto x, auto xdot, auto F) {
    residual(t, x.data(), xdot.data(), F.data());
  };
  return start;
}

inline StartProblem pendulum() {
  return of_test_set(sfdae_test::pendulum(), [](auto... a) { sfdae_test::pendulum_residual(a...); });
}
inline StartProblem andrews() {
  return of_test_set(sfdae_test::andrews(), [](auto... a) { sfdae_test::andrews_residual(a...); });
}
inline StartProblem transistor_amplifier() {
  return of_test_set(sfdae_test::transistor_amplifier(),
                     [](auto... a) { sfdae_test::transistor_amplifier_residual(a...); });
}

}  // namespace sfdae_bench
