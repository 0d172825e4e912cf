// Tolerances and the weighted norm.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/error_weights.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <limits>

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

// An error estimate that could not be computed must not accept a step, wherever it stands among others.
TEST(ErrorWeights, AnErrorThatIsNotANumberIsTooLarge) {
  ErrorWeights weights;
  weights.set({{1e-6, 1e-3, 1e-6}, {1e-6, 1e-6, 1e-3}}, Tightening::sixth_root);
  const double x[] = {2.0, 0.0, 1.0};
  weights.update(x);
  for (int place = 0; place < 3; ++place) {
    for (const double other : {0.0, 1e-9, 1.0}) {
      double e[] = {other, other, other};
      e[place] = std::numeric_limits<double>::quiet_NaN();
      EXPECT_GT(weights.norm(e), 1e100) << place;
      EXPECT_GT(weights.norm(e, 0.7), 1e100) << place;
      EXPECT_TRUE(std::isfinite(weights.norm(e)) && std::isfinite(weights.norm(e, 0.7))) << place;
    }
  }
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

TEST(ErrorWeights, SpeedsThatAreNoneDoNotLimitTheFirstStep) {
  ErrorWeights weights;
  weights.set({{1e-6, 1e-6}, {1e-6, 1e-6}}, Tightening::none);
  const double x[] = {1.0, 1.0}, none[] = {0.0, 1e-310}, some[] = {1.0, 1e-310};
  std::feclearexcept(FE_ALL_EXCEPT);
  EXPECT_EQ(weights.first_step(x, none, 0.5), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(weights.first_step(x, some, 0.5)));
  EXPECT_FALSE(std::fetestexcept(FE_OVERFLOW | FE_DIVBYZERO | FE_INVALID));
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

// One number for all components gives the bits of as many that are equal.
TEST(ErrorWeights, OfOneToleranceAreThoseOfManyThatAreEqual) {
  using sfdae::core::PerComponent;
  for (Tightening tightening : {Tightening::none, Tightening::sixth_root})
    for (double rtol : {1e-5, 0.0}) {
      ErrorWeights one, many;
      one.set({PerComponent::same(3, rtol), PerComponent::same(3, 1e-7)}, tightening, 0.2);
      many.set({{rtol, rtol, rtol}, {1e-7, 1e-7, 1e-7}}, tightening, 0.2);
      const double x[] = {2.0, -30.0, 0.0}, e[] = {1e-4, -3e-5, 1e-6}, scale[] = {4.0, 30.0, 1.0};
      for (ErrorWeights* weights : {&one, &many}) weights->update(x);
      EXPECT_EQ(one.norm(e), many.norm(e));
      EXPECT_EQ(one.norm(e, 0.75), many.norm(e, 0.75));
      EXPECT_EQ(one.first_step(x, e, 0.5), many.first_step(x, e, 0.5));
      EXPECT_EQ(one.tightest(x), many.tightest(x));
      for (ErrorWeights* weights : {&one, &many}) weights->update(x, scale);
      EXPECT_EQ(one.norm(e, 0.75), many.norm(e, 0.75));
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(one.inverse()[i], many.inverse()[i]);
    }
  PerComponent grown = PerComponent::same(2, 3.0);
  grown.push_back(4.0);
  EXPECT_EQ(grown, PerComponent({3.0, 3.0, 4.0}));
  EXPECT_EQ(PerComponent::same(5, 2.0).different(), std::vector<double>{2.0});
  EXPECT_EQ(grown.mapped([](double value) { return 2.0 * value; }), PerComponent({6.0, 6.0, 8.0}));
}

TEST(ErrorWeights, SafetyTightensAllTolerances) {
  for (Tightening tightening : {Tightening::none, Tightening::sixth_root}) {
    ErrorWeights weights, safe;
    weights.set({{1e-6, 0.0}, {1e-3, 1e-4}}, tightening);
    safe.set({{1e-6, 0.0}, {1e-3, 1e-4}}, tightening, 0.1);
    const double x[] = {2.0, 30.0}, e[] = {1e-4, -3e-5};
    weights.update(x);
    safe.update(x);
    EXPECT_NEAR(safe.norm(e), 10.0 * weights.norm(e), 1e-12 * safe.norm(e));
    EXPECT_EQ(safe.tolerance(1, x), weights.tolerance(1, x));  // as the user gave it
  }
}

// weight = max(1e-6 |x| + 1e-9, floor), floors read anew at every update.
TEST(ErrorWeights, WeightsDoNotFallBelowTheFloor) {
  ErrorWeights weights;
  weights.set({{1e-6, 1e-6, 1e-6}, {1e-9, 1e-9, 1e-9}}, Tightening::none);
  double floor[] = {1e-5, 0.0, 1e-8};
  weights.set_floor(floor);
  const double x[] = {1.0, 1.0, 0.0};
  weights.update(x);
  const double inverse[] = {1e5, 1.0 / (1e-6 + 1e-9), 1e8};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(weights.inverse()[i], inverse[i], 1e-12 * inverse[i]) << i;
  EXPECT_NEAR(weights.floor_ratio(), 1e-8 / 1e-9, 1e-12);
  floor[0] = floor[2] = 1e-10;
  weights.update(x);
  EXPECT_NEAR(weights.inverse()[0], inverse[1], 1e-12 * inverse[1]);
  EXPECT_NEAR(weights.inverse()[2], 1e9, 1e-3);
  EXPECT_NEAR(weights.floor_ratio(), 0.1, 1e-12);
  weights.set_floor(nullptr);
  weights.update(x);
  EXPECT_EQ(weights.floor_ratio(), 0.0);
}

// x = 0 without atol: the weight is the floor, and how far it is above nothing at all is told by a finite number.
TEST(ErrorWeights, AFloorMakesUpForNoToleranceAtAll) {
  ErrorWeights weights;
  weights.set({{1e-6}, {0.0}}, Tightening::none);
  const double floor[] = {1e-12}, x[] = {0.0}, e[] = {1e-12};
  weights.set_floor(floor);
  weights.update(x);
  EXPECT_NEAR(weights.norm(e), 1.0, 1e-12);
  EXPECT_GT(weights.floor_ratio(), 1e100);
  EXPECT_TRUE(std::isfinite(weights.floor_ratio()));
}

}  // namespace
