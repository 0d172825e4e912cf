// SPDX-License-Identifier: BSD-3-Clause
// Whether steps show what event functions do, by values where they began.
#include "watch/event_resolution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace sfdae::core {

namespace {

constexpr double pi = 3.14159265358979323846;

// After steps that began at four times, uneven as steps are.
template <class Function>
EventResolution after_steps(double h, Function g) {
  EventResolution resolution;
  resolution.resize(1);
  resolution.start();
  for (const double t : {0.3 * h, 1.0 * h, 2.2 * h, 3.0 * h}) resolution.begin_step(t, {g(t)});
  return resolution;
}

}  // namespace

TEST(EventResolution, ExpectsCubicPolynomials) {
  const auto cubic = [](double t) { return 2.0 - t * (1.0 - t * (0.3 + 0.1 * t)); };
  const EventResolution resolution = after_steps(1.0, cubic);
  EXPECT_TRUE(resolution.expects(4.1, {cubic(4.1)}));
  EXPECT_FALSE(resolution.expects(4.1, {1.5 * cubic(4.1)}));
}

// Short steps show a sine; of steps of a third of a period nothing is to be expected.
TEST(EventResolution, ExpectsWhatStepsResolve) {
  const auto sine = [](double t) { return std::sin(2.0 * pi * t + 0.4); };
  EXPECT_TRUE(after_steps(0.01, sine).expects(0.04, {sine(0.04)}));
  EXPECT_FALSE(after_steps(0.35, sine).expects(1.4, {sine(1.4)}));
}

// Where an event function fails, the search of a step begins once more.
TEST(EventResolution, TakesAStepOnce) {
  EventResolution resolution = after_steps(1.0, [](double t) { return 1.0 + t; });
  resolution.begin_step(3.0, {4.0});
  EXPECT_TRUE(resolution.expects(4.0, {5.0}));
}

TEST(EventResolution, AsksForPointsByRates) {
  EventResolution resolution = after_steps(1.0, [](double) { return 1.0; });
  EXPECT_EQ(resolution.halvings(), 0);
  EXPECT_FALSE(resolution.is_suspicious(1e3));
  resolution.start_rates();
  resolution.add_rate(1e-5, {1.0}, {1.0 + 200.0 * 1e-5});  // changes by its size in a 200th
  resolution.take_rates(2.0);
  EXPECT_GE(std::exp2(resolution.halvings()), 2.0 * 200.0);
  EXPECT_LE(resolution.halvings(), 12);
  EXPECT_TRUE(resolution.is_suspicious(-0.6));
  EXPECT_FALSE(resolution.is_suspicious(0.4));
  EXPECT_TRUE(resolution.is_misleading(2.0));
  EXPECT_FALSE(resolution.is_misleading(1.9));
  resolution.begin_step(4.0, {1.0});
  EXPECT_EQ(resolution.halvings(), 0);
  EXPECT_TRUE(resolution.is_suspicious(0.6));
  // A step as long that is slow.
  resolution.start_rates();
  resolution.add_rate(1e-5, {1.0}, {1.0 + 0.1 * 1e-5});
  resolution.take_rates(2.0);
  EXPECT_FALSE(resolution.is_misleading(3.0));
  EXPECT_TRUE(resolution.is_misleading(4.0));
}

}  // namespace sfdae::core
