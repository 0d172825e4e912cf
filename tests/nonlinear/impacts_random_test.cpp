// SPDX-License-Identifier: BSD-3-Clause
//
// Random mechanical systems that constraints catch: as first-order equations of index 3 and as multibody systems,
// against M (v+ - v-) = -G^T p, G v+ = 0 solved here.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "random.h"

namespace {

using sfdae_test::Random;
using Values = std::vector<double>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// M = L L^T + diag(2 + sin q_i), g_k = b_k q + 0.3 sin(w_k q) - c_k, forces -q - 0.1 v; positions in units of `length`.
struct System {
  System(Random& random, int positions, int constraints, double unit) : n(positions), nl(constraints), length(unit) {
    L = random.reals(n * n, -1.0, 1.0);
    b = random.reals(n * nl, -1.0, 1.0);
    w = random.reals(n * nl, -1.0, 1.0);
    for (int k = 0; k < nl; ++k) b[at(k * n + k)] += 2.0;  // independent
    q = random.reals(n, -1.0, 1.0);
    v = random.reals(n, -1.0, 1.0);
    for (int k = 0; k < nl; ++k) c.push_back(dot(b, k, q) + 0.3 * std::sin(dot(w, k, q)));
  }
  // Of row k with n entries.
  template <class Number>
  Number dot(const Values& rows, int k, const std::vector<Number>& x) const {
    Number sum = rows[at(k * n)] * x[0];
    for (int j = 1; j < n; ++j) sum = sum + rows[at(k * n + j)] * x[at(j)];
    return sum;
  }
  double square(int i, int j) const {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) sum += L[at(i * n + k)] * L[at(j * n + k)];
    return sum;
  }

  // (v+, p), by elimination with pivots.
  Values exact() const {
    const int size = n + nl;
    std::vector<Values> K(at(size), Values(at(size + 1), 0.0));
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) K[at(i)][at(j)] = square(i, j) + (i == j ? 2.0 + std::sin(q[at(i)]) : 0.0);
      for (int k = 0; k < nl; ++k)
        K[at(i)][at(n + k)] = K[at(n + k)][at(i)] =
            b[at(k * n + i)] + 0.3 * std::cos(dot(w, k, q)) * w[at(k * n + i)];
      for (int j = 0; j < n; ++j) K[at(i)][at(size)] += K[at(i)][at(j)] * v[at(j)];
    }
    for (int k = 0; k < size; ++k) {
      int pivot = k;
      for (int i = k; i < size; ++i)
        if (std::fabs(K[at(i)][at(k)]) > std::fabs(K[at(pivot)][at(k)])) pivot = i;
      std::swap(K[at(k)], K[at(pivot)]);
      for (int i = 0; i < size; ++i) {
        if (i == k) continue;
        const double factor = K[at(i)][at(k)] / K[at(k)][at(k)];
        for (int j = k; j <= size; ++j) K[at(i)][at(j)] -= factor * K[at(k)][at(j)];
      }
    }
    Values solution;
    for (int i = 0; i < size; ++i) solution.push_back(K[at(i)][at(size)] / K[at(i)][at(i)]);
    return solution;
  }

  // x = (length q, length v, lambda)
  Values before() const {
    Values x;
    for (double value : q) x.push_back(length * value);
    for (double value : v) x.push_back(length * value);
    x.resize(at(2 * n + nl), 0.0);
    return x;
  }

  int n, nl;
  double length;
  Values L, b, w, c, q, v;
};

sfdae::NonlinearProblem raw(const System& s) {
  sfdae::NonlinearProblem problem(2 * s.n + s.nl, 2 * s.n + s.nl);
  problem.equations = [&s](const auto&, auto x, auto xdot, auto F) {
    const int n = s.n;
    std::vector<sfdae::Expression> q;
    for (int i = 0; i < n; ++i) q.push_back(x[i] / s.length);
    for (int i = 0; i < n; ++i) {
      F[i] = xdot[i] - x[n + i];
      sfdae::Expression row = (2.0 + sin(q[at(i)])) * xdot[n + i] + x[i] + 0.1 * x[n + i];
      for (int j = 0; j < n; ++j) row = row + s.square(i, j) * xdot[n + j];
      for (int k = 0; k < s.nl; ++k)
        row = row + s.length * (s.b[at(k * n + i)] + 0.3 * s.w[at(k * n + i)] * cos(s.dot(s.w, k, q))) * x[2 * n + k];
      F[n + i] = row;
    }
    for (int k = 0; k < s.nl; ++k) F[2 * n + k] = s.dot(s.b, k, q) + 0.3 * sin(s.dot(s.w, k, q)) - s.c[at(k)];
  };
  return problem;
}

sfdae::MultibodyProblem multibody(const System& s) {
  sfdae::MultibodyProblem problem(s.n, s.nl);
  problem.equations = [&s](const auto&, auto x, auto v, auto to) {
    const int n = s.n;
    std::vector<sfdae::Expression> q;
    for (int i = 0; i < n; ++i) q.push_back(x[i] / s.length);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) to.M(i, j) = s.square(i, j);
      to.M(i, i) = s.square(i, i) + 2.0 + sin(q[at(i)]);
      to.f[i] = -x[i] - 0.1 * v[i];
    }
    for (int k = 0; k < s.nl; ++k) to.g[k] = s.dot(s.b, k, q) + 0.3 * sin(s.dot(s.w, k, q)) - s.c[at(k)];
  };
  return problem;
}

// Of velocities and impulses relative to 1 in their units; < 0: named.
double error_of(sfdae::Solver& solver, const System& s, double unit_of_impulse) {
  const Values before = s.before(), exact = s.exact();
  sfdae::Jump jump;
  try {
    jump = solver.jump(0.0, 1.0, before, 2);
  } catch (const sfdae::Error& error) {
    std::printf("%s\n", error.what());
    return -1.0;
  }
  double largest = 0.0;
  for (int i = 0; i < s.n; ++i) {
    largest = std::max(largest, std::fabs(jump.after[at(i)] - before[at(i)]) / s.length);
    largest = std::max(largest, std::fabs(jump.after[at(s.n + i)] / s.length - exact[at(i)]));
  }
  for (int k = 0; k < s.nl; ++k)
    largest = std::max(largest, std::fabs(jump.impulses(2 * s.n + k, 0) / unit_of_impulse - exact[at(s.n + k)]));
  return largest;
}

TEST(Impacts, OfRandomSystemsFollowTheirImpulses) {
  Random random(7);
  double largest = 0.0;
  int named = 0, count = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const int n = random.integer(2, 5), nl = random.integer(1, std::min(n - 1, 2));
    const double unit = trial % 2 == 0 ? 1.0 : std::pow(10.0, random.integer(-4, 3));
    System system(random, n, nl, unit);
    // Some velocities fit already, or nearly.
    if (trial % 3 == 0) {
      const Values exact = system.exact();
      const double beside = trial % 2 == 0 ? 0.0 : 1e-9;
      for (int i = 0; i < n; ++i) system.v[at(i)] = exact[at(i)] + beside * random.real(-1.0, 1.0);
    }
    sfdae::Options options;
    options.rtol = 1e-8;
    options.atol = 1e-8 * unit;
    sfdae::Solver of_raw(raw(system), options), of_system(multibody(system), options);
    for (sfdae::Solver* solver : {&of_raw, &of_system}) {
      // M (v+ - v-) length = -length G^T p in the raw equations, -G^T p / length in the multibody system.
      const double error = error_of(*solver, system, solver == &of_raw ? 1.0 : unit * unit);
      ++count;
      if (error < 0.0) ++named;
      else EXPECT_LE(error, 1e-8) << trial << (solver == &of_raw ? " raw" : " multibody") << ", unit " << unit;
      largest = std::max(largest, error);
    }
  }
  std::printf("%d impacts, %d named, largest error %.2g\n", count, named, largest);
  EXPECT_LE(named, count / 50);
}

}  // namespace
