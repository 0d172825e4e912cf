// Tolerances and the weighted norm.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/error_weights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using sfdae::core::ErrorWeights;
using sfdae::core::Tightening;

TEST(ErrorWeights, NormIsTheLargestErrorInTermsOfReducedTolerances) {
  ErrorWeights weights;
  weights.set({{1e-6, 1e-6}, {1e-6, 1e-3}}, Tightening::sixth_root);
  const double x[] = {2.0, 0.0};
  weights.update(x);
  // 4 (1e-6)^(1/6) = 0.4
  const double first[] = {3e-6, 0.0}, second[] = {0.0, 1e-3};
  EXPECT_NEAR(weights.norm(first), 1.0 / 0.4, 1e-12);
  EXPECT_NEAR(weights.norm(second), 1.0 / 0.4, 1e-12);
  const double both[] = {3e-6, -2e-3};
  EXPECT_EQ(weights.worst(both), 1);
  EXPECT_DOUBLE_EQ(weights.tolerance(0, x), 3e-6);
}

TEST(ErrorWeights, LooseTolerancesAreNotReduced) {
  ErrorWeights weights;
  weights.set({{0.1}, {0.0}}, Tightening::sixth_root);
  const double x[] = {5.0}, e[] = {0.5};
  weights.update(x);
  EXPECT_NEAR(weights.norm(e), 1.0, 1e-12);
}

TEST(ErrorWeights, AZeroToleranceAllowsNoErrorButDoesNotOverflow) {
  ErrorWeights weights;
  weights.set({{1e-3}, {0.0}}, Tightening::sixth_root);
  const double zero[] = {0.0}, none[] = {0.0}, some[] = {1e-3};
  weights.update(zero);
  EXPECT_EQ(weights.norm(none), 0.0);
  EXPECT_GT(weights.norm(some), 1e100);
  EXPECT_TRUE(std::isfinite(weights.norm(some)));
}

TEST(ErrorWeights, TolerancesBelowRoundingAreNoticed) {
  ErrorWeights weights;
  weights.set({{1e-15}, {0.0}}, Tightening::sixth_root);
  const double x[] = {1.0};
  EXPECT_GT(weights.rounding(x), 1.0);
  weights.set({{1e-12}, {0.0}}, Tightening::sixth_root);
  EXPECT_LT(weights.rounding(x), 1.0);
  weights.set({{0.0}, {1e-9}}, Tightening::sixth_root);
  const double large[] = {1e9};
  EXPECT_GT(weights.rounding(large), 1.0);
}

}  // namespace
