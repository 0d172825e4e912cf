// SPDX-License-Identifier: BSD-3-Clause
// Start values of random nonlinear problems whose algebraic unknowns are not known: the others stay, or move least.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "linalg/dense.h"
#include "matrix_checks.h"
#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;
using sfdae::core::Matrix;
using Numbers = std::vector<double>;

// SFDAE_TEST_CASES raises it.
int num_cases(int usual) {
  const char* cases = std::getenv("SFDAE_TEST_CASES");
  return cases != nullptr ? std::atoi(cases) : usual;
}

// x = (p, y, z):   p_i' = sum a_ij sin p_j + sum q_ik y_k + sum (b_il + 0.2 sin p_i) z_l
//                  0 = y_k + 0.3 sin y_k - sum c_kj cos p_j
//                  0 = gamma_l(p) - gamma_l(p*),  gamma_l = sum (b_jl + 0.1 h_lj) p_j + 0.2 h_lj sin 2 p_j
// y follows from p, z from the derivative of the last equations: mu = 1.
struct RandomProblem {
  explicit RandomProblem(std::uint64_t seed) {
    RandomNumbers numbers(seed);
    n_p = 3 + static_cast<int>(numbers.uniform(0.0, 3.0));
    n_y = 1 + static_cast<int>(numbers.uniform(0.0, 2.0));
    n_z = 1 + static_cast<int>(numbers.uniform(0.0, 2.0));
    a = random_matrix(n_p, n_p, seed + 1);
    q = random_matrix(n_p, n_y, seed + 2);
    b = sfdae_test::sum(1.0, random_matrix(n_p, n_z, seed + 3), 0.0, Matrix(n_p, n_z));
    for (int l = 0; l < n_z; ++l) b(l, l) += 2.5;
    c = random_matrix(n_y, n_p, seed + 4);
    h = random_matrix(n_z, n_p, seed + 5);
    p_exact = random_vector(n_p, seed + 6);
    for (int l = 0; l < n_z; ++l) level.push_back(gamma(l, p_exact.data()));
  }
  int n() const { return n_p + n_y + n_z; }

  template <class V>
  V gamma(int l, const V* p) const {
    using std::sin;
    V sum = 0.0 * p[0];
    for (int j = 0; j < n_p; ++j) sum = sum + (b(j, l) + 0.1 * h(l, j)) * p[j] + 0.2 * h(l, j) * sin(2.0 * p[j]);
    return sum;
  }
  double slope_of_gamma(int l, int j, double p_j) const {
    return b(j, l) + 0.1 * h(l, j) + 0.4 * h(l, j) * std::cos(2.0 * p_j);
  }
  NonlinearEquations equations() const {
    const RandomProblem self = *this;
    return equations_of(n(), n(), [self](const auto&, const auto* x, const auto* xdot, auto* F) {
      const int np = self.n_p, ny = self.n_y, nz = self.n_z;
      for (int i = 0; i < np; ++i) {
        F[i] = xdot[i];
        for (int j = 0; j < np; ++j) F[i] = F[i] - self.a(i, j) * sin(x[j]);
        for (int k = 0; k < ny; ++k) F[i] = F[i] - self.q(i, k) * x[np + k];
        for (int l = 0; l < nz; ++l) F[i] = F[i] - (self.b(i, l) + 0.2 * sin(x[i])) * x[np + ny + l];
      }
      for (int k = 0; k < ny; ++k) {
        F[np + k] = x[np + k] + 0.3 * sin(x[np + k]);
        for (int j = 0; j < np; ++j) F[np + k] = F[np + k] - self.c(k, j) * cos(x[j]);
      }
      for (int l = 0; l < nz; ++l) F[np + ny + l] = self.gamma(l, x) - self.level[size(l)];
    });
  }
  Numbers guess(const Numbers& p, double amount, std::uint64_t seed) const {
    Numbers x(p);
    for (double value : random_vector(n_y + n_z, seed)) x.push_back(amount * value);
    return x;
  }

  int n_p, n_y, n_z;
  Matrix a, q, b, c, h;
  Numbers p_exact, level;
};

// The part of D^-1 change that no combination of the rows of the Jacobian of gamma, times D, explains.
double unexplained(const RandomProblem& problem, const Numbers& p, const Numbers& change, const Numbers& sizes) {
  Matrix normals(problem.n_p, problem.n_z);
  Numbers scaled(size(problem.n_p));
  for (int j = 0; j < problem.n_p; ++j) {
    scaled[size(j)] = change[size(j)] / sizes[size(j)];
    for (int l = 0; l < problem.n_z; ++l) normals(j, l) = problem.slope_of_gamma(l, j, p[size(j)]) * sizes[size(j)];
  }
  const Numbers shares = sfdae::core::least_squares(normals, scaled, 0.0);
  const Numbers explained = times(normals, shares.data());
  double rest = 0.0;
  for (std::size_t j = 0; j < scaled.size(); ++j) rest = std::max(rest, std::fabs(scaled[j] - explained[j]));
  return rest / largest(scaled);
}

}  // namespace

TEST(RandomStartValues, AlgebraicUnknownsAdaptAlone) {
  for (int trial = 0; trial < num_cases(150); ++trial) {
    SCOPED_TRACE(trial);
    const RandomProblem problem(1000 * static_cast<std::uint64_t>(trial));
    Numbers first;
    for (const double amount : {0.0, 1.0, 30.0}) {
      NonlinearRun run(problem.equations(), default_options());
      ASSERT_EQ(run.start(0.0, 1.0, problem.guess(problem.p_exact, amount, 7)), SFDAE_OK) << run.message();
      EXPECT_EQ(run.values().mu, 1);
      for (int j = 0; j < problem.n_p; ++j) EXPECT_NEAR(run.x[size(j)], problem.p_exact[size(j)], rounding(100)) << j;
      if (first.empty()) first = run.x;
      EXPECT_LE(distance(run.x, first), 1e3 * rounding(10));
    }
  }
}

// p off by 30 %: D^-2 change of p is a combination of the gradients of the constraints on p, D the tolerances.
TEST(RandomStartValues, WhatHasToMoveMovesLeast) {
  for (int trial = 0; trial < num_cases(150); ++trial) {
    SCOPED_TRACE(trial);
    const RandomProblem problem(1000 * static_cast<std::uint64_t>(trial) + 500);
    Numbers p = problem.p_exact;
    const Numbers off = random_vector(problem.n_p, 1000 * static_cast<std::uint64_t>(trial) + 501);
    for (std::size_t j = 0; j < p.size(); ++j) p[j] *= 1.0 + 0.3 * off[j];
    NonlinearRun run(problem.equations(), default_options());
    const int status = run.start(0.0, 1.0, problem.guess(p, 1.0, 7));
    ASSERT_EQ(status, SFDAE_VALUES_CHANGED) << run.message();
    Numbers change, sizes;
    for (std::size_t j = 0; j < p.size(); ++j) {
      change.push_back(run.x[j] - p[j]);
      sizes.push_back(1e-6 * std::fabs(p[j]) + 1e-6);
    }
    // The iteration is accurate to 1e-8 relative to x; changes are smaller by one or two digits.
    EXPECT_LE(unexplained(problem, run.x, change, sizes), 1e-5);
    for (int l = 0; l < problem.n_z; ++l)
      EXPECT_NEAR(problem.gamma(l, run.x.data()), problem.level[size(l)], rounding(100)) << l;
  }
}
