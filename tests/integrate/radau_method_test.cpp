// Coefficients of the Radau IIA methods: defining properties.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_method.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "linalg/dense.h"

using namespace sfdae::core;

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();

class RadauMethods : public testing::TestWithParam<int> {
 protected:
  const RadauMethod& method = radau_method(GetParam());
  const StageMethod& stages = method.stages;
  const int s = GetParam();
  double c(int i) const { return stages.c[static_cast<std::size_t>(i)]; }
  // D is as large as s^2.
  const double tolerance = 100.0 * s * s * eps;

  // The Runge-Kutta matrix.
  Matrix A() const {
    Matrix lu(s, s);
    for (int j = 0; j < s; ++j)
      for (int i = 0; i < s; ++i) lu(i, j) = stages.D_at(i, j);
    std::vector<int> pivots(static_cast<std::size_t>(s));
    EXPECT_TRUE(factor_lu(lu, pivots.data()));
    Matrix inverse = identity(s);
    for (int j = 0; j < s; ++j) solve_lu(lu, pivots.data(), inverse.view().column(j));
    return inverse;
  }
};

// B(2s - 1): sum_i b_i c_i^(k-1) = 1/k, b the last row of A as the method is stiffly accurate.
TEST_P(RadauMethods, QuadratureHasOrderTwiceTheStagesLessOne) {
  const Matrix a = A();
  for (int k = 1; k <= 2 * s - 1; ++k) {
    double sum = 0.0;
    for (int i = 0; i < s; ++i) sum += a(s - 1, i) * std::pow(c(i), k - 1);
    EXPECT_NEAR(sum, 1.0 / k, tolerance) << k;
  }
  double next = 0.0;
  for (int i = 0; i < s; ++i) next += a(s - 1, i) * std::pow(c(i), 2 * s - 1);
  EXPECT_GT(std::fabs(next - 1.0 / (2 * s)), 1e3 * tolerance * (s < 7 ? 1.0 : 1e-3));
  EXPECT_EQ(c(s - 1), 1.0);
}

// C(s): sum_j a_ij c_j^(k-1) = c_i^k / k.
TEST_P(RadauMethods, StagesHaveOrderS) {
  const Matrix a = A();
  for (int i = 0; i < s; ++i)
    for (int k = 1; k <= s; ++k) {
      double sum = 0.0;
      for (int j = 0; j < s; ++j) sum += a(i, j) * std::pow(c(j), k - 1);
      EXPECT_NEAR(sum, std::pow(c(i), k) / k, tolerance) << i << " " << k;
    }
}

TEST_P(RadauMethods, SlopesArePreciseForPolynomials) {
  for (int k = 1; k <= s; ++k) {
    double at_start = 0.0;
    for (int j = 0; j < s; ++j) at_start += method.slope_at_start[static_cast<std::size_t>(j)] * std::pow(c(j), k);
    EXPECT_NEAR(at_start, k == 1 ? 1.0 : 0.0, tolerance * s) << k;
  }
}

// D T = T diag(gamma, [alpha beta; -beta alpha], ...)
TEST_P(RadauMethods, TransformationDecouplesTheStages) {
  const auto at = [this](const StageMatrix& m, int i, int j) { return m[static_cast<std::size_t>(i + j * s)]; };
  Matrix blocks(s, s);
  blocks(0, 0) = stages.gamma;
  for (int k = 0; 2 * k + 2 < s; ++k) {
    const std::complex<double> lambda = stages.lambda[static_cast<std::size_t>(k)];
    const int p = 2 * k + 1;
    blocks(p, p) = blocks(p + 1, p + 1) = lambda.real();
    blocks(p, p + 1) = lambda.imag();
    blocks(p + 1, p) = -lambda.imag();
  }
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < s; ++j) {
      double left = 0.0, right = 0.0, unit = 0.0;
      for (int k = 0; k < s; ++k) {
        left += stages.D_at(i, k) * at(stages.T, k, j);
        right += at(stages.T, i, k) * blocks(k, j);
        unit += at(stages.T, i, k) * at(stages.T_inverse, k, j);
      }
      EXPECT_NEAR(left, right, tolerance) << i << " " << j;
      EXPECT_NEAR(unit, i == j ? 1.0 : 0.0, tolerance) << i << " " << j;
    }
}

// One step for w' = lambda w: R(z) - e^z ~ error_constant z^(2s) / (2s)!.
TEST_P(RadauMethods, ErrorConstantIsThatOfTheStabilityFunction) {
  const double z = s == 1 ? -1e-3 : s == 3 ? -0.1 : s == 5 ? -0.4 : -0.8;
  Matrix M(s, s);
  std::vector<double> rhs(static_cast<std::size_t>(s));
  for (int i = 0; i < s; ++i)
    for (int j = 0; j < s; ++j) {
      M(i, j) = stages.D_at(i, j) - (i == j ? z : 0.0);
      rhs[static_cast<std::size_t>(i)] += stages.D_at(i, j);
    }
  std::vector<int> pivots(static_cast<std::size_t>(s));
  ASSERT_TRUE(factor_lu(M, pivots.data()));
  solve_lu(M, pivots.data(), rhs.data());
  const double error = std::fabs(rhs.back() - std::exp(z));
  const double predicted = method.error_constant * std::pow(std::fabs(z), 2 * s) / std::tgamma(2 * s + 1);
  // The next term of the series is about z times this one, or 5/3 z (one stage).
  EXPECT_NEAR(error, predicted, (s == 1 ? 2.0 : 1.2) * std::fabs(z) * predicted + 10.0 * eps);
}

INSTANTIATE_TEST_SUITE_P(Stages, RadauMethods, testing::Values(1, 3, 5, 7));

// The coefficients that everybody knows [HW96, table IV.5.6].
TEST(RadauMethod, ThreeStagesAreThoseOfTheLiterature) {
  const RadauMethod& method = radau_method(3);
  const double root = std::sqrt(6.0);
  EXPECT_NEAR(method.stages.c[0], (4.0 - root) / 10.0, eps);
  EXPECT_NEAR(method.stages.c[1], (4.0 + root) / 10.0, eps);
  EXPECT_NEAR(method.error_constant, 0.1, eps);
  // Embedded formula: e = (gamma0 / 3) (-13 - 7 sqrt 6, -13 + 7 sqrt 6, -1), gamma0 = 1 / gamma.
  EXPECT_NEAR(-method.slope_at_start[0], (-13.0 - 7.0 * root) / 3.0, 100.0 * eps);
  EXPECT_NEAR(-method.slope_at_start[1], (-13.0 + 7.0 * root) / 3.0, 100.0 * eps);
  EXPECT_NEAR(-method.slope_at_start[2], -1.0 / 3.0, 100.0 * eps);
}

}  // namespace
