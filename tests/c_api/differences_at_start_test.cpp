// SPDX-License-Identifier: BSD-3-Clause
//
// Consistent values with derivatives by differences: as accurate as the tolerances ask for, or said not to be.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

// x0 = sin(k t + 1), x1 = x0', ..., x_mu = x0^(mu): one constraint, differentiated mu times.
sfdae::LinearProblem chain(int mu, double k) {
  const int n = mu + 1;
  sfdae::LinearProblem problem(n, n);
  problem.E = [=](double, int order, sfdae::MatrixRef E) {
    for (int i = 0; i < mu && order == 0; ++i) E(i, i) = 1.0;
  };
  problem.A = [=](double, int order, sfdae::MatrixRef A) {
    for (int i = 0; i < mu && order == 0; ++i) A(i, i + 1) = 1.0;
    if (order == 0) A(mu, 0) = -1.0;
  };
  problem.f = [=](double t, int order, sfdae::VectorRef f) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    f[mu] = std::sin(k * t + 1.0);
    return 0;
  };
  return problem;
}

// Beyond a hundred tolerances, which the campaign for differences counts as wrong, nothing comes with SFDAE_OK; and
// both outcomes happen. Values come with either status.
TEST(DifferencesAtStart, AreNamedWhereTheyAreNotAccurate) {
  int accurate = 0, named = 0;
  for (int mu : {1, 2, 3})
    for (double k : {0.5, 2.0, 7.0, 30.0})
      for (double tol : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
        sfdae::Options options;
        options.difference_derivatives = 1;
        options.rtol = options.atol = tol;
        sfdae::Solver solver(chain(mu, k), options);
        sfdae::Point point{0.2, std::vector<double>(static_cast<std::size_t>(mu + 1), 0.0), {}};
        double allowed = 100.0;
        try {
          ASSERT_GE(solver.make_consistent(point), SFDAE_OK);
          ++accurate;
        } catch (const sfdae::Error& error) {
          if (error.status() == SFDAE_RANK_UNCLEAR) continue;
          ASSERT_EQ(error.status(), SFDAE_TOLERANCE_TOO_SMALL) << error.what();
          EXPECT_NE(std::string(error.what()).find("derivatives by differences"), std::string::npos);
          allowed = 1e-2 / tol;
          ++named;
        }
        for (int i = 0; i <= mu; ++i) {
          const double exact = std::pow(k, i) * std::sin(k * 0.2 + 1.0 + i * std::acos(0.0));
          const double size = tol * (1.0 + std::pow(k, i));
          EXPECT_NEAR(point.x[static_cast<std::size_t>(i)], exact, allowed * size) << mu << " " << k << " " << tol;
        }
      }
  EXPECT_GE(accurate, 20);
  EXPECT_GE(named, 8);
}

}  // namespace
