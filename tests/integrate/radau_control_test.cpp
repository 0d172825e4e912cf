// Choice of step size and number of stages for the Radau methods.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_control.h"
#include "system/strangeness_free_system.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace sfdae::core;

namespace {

StepOptions fixed(int stages) {
  StepOptions options;
  options.min_stages = options.max_stages = stages;
  return options;
}

RadauControl started(const StepOptions& options) {
  RadauControl control;
  control.start(options);
  return control;
}

ErrorTerms error_of(double error, int exponent) {
  ErrorTerms terms;
  terms.error = error;
  terms.exponent = exponent;
  return terms;
}

const StageCosts costs = [] {
  StageCosts result;
  for (int s = 1; s <= max_stages; ++s) result.work[static_cast<std::size_t>(s)] = cost_of_reduced_stages(10, 5, s);
  return result;
}();

// safety error^(-1/exponent)
TEST(RadauControl, TheNextStepHasTheErrorAllowedLessSafety) {
  StepOptions options = fixed(3);
  options.classical_control = true;
  EXPECT_NEAR(started(options).accepted(0.1, error_of(1.0, 6), costs, false), 0.09, 1e-15);
  EXPECT_NEAR(started(options).accepted(0.1, error_of(1.0 / 64.0, 6), costs, false), 0.18, 1e-15);
  EXPECT_NEAR(started(options).accepted(-0.1, error_of(1.0 / 16.0, 4), costs, false), -0.18, 1e-15);
}

// Errors that grow from step to step of equal size: the predictive control reckons with the same growth once more.
TEST(RadauControl, PredictiveControlFollowsTheTrendOfErrors) {
  StepOptions options = fixed(3);
  RadauControl predictive = started(options);
  options.classical_control = true;
  RadauControl classical = started(options);
  predictive.accepted(0.1, error_of(0.1, 6), costs, false);
  classical.accepted(0.1, error_of(0.1, 6), costs, false);
  const double ratio = predictive.accepted(0.1, error_of(0.4, 6), costs, false) /
                       classical.accepted(0.1, error_of(0.4, 6), costs, false);
  EXPECT_NEAR(ratio, std::pow(0.1 / 0.4, 1.0 / 6.0), 1e-12);
}

TEST(RadauControl, RatiosStayWithinTheirLimits) {
  StepOptions options = fixed(3);
  options.fastest_rise = 0.5;
  options.fastest_fall = 2.0;
  EXPECT_NEAR(started(options).accepted(0.1, error_of(1e-9, 6), costs, false), 0.2, 1e-15);
  RadauControl control = started(options);
  control.accepted(0.1, error_of(1.0, 6), costs, false);
  EXPECT_NEAR(control.rejected(0.1, error_of(1e9, 6)), 0.05, 1e-15);
  // Limits that would not let a failed step become shorter, or that make no sense.
  for (double fall : {1.0, 1.05, 1e300})
    for (double rise : {1.0, 1e-300, 0.0}) {
      options.fastest_fall = fall;
      options.fastest_rise = rise;
      RadauControl odd = started(options);
      const double next = odd.accepted(0.1, error_of(1e-12, 6), costs, false);
      EXPECT_TRUE(next >= 0.1 && std::isfinite(next)) << fall << " " << rise;
      const double after = odd.rejected(0.1, error_of(8.0, 6));
      EXPECT_TRUE(after > 0.0 && after <= 0.09) << fall << " " << rise;
    }
}

TEST(RadauControl, StepsAreNotRaisedAfterAFailure) {
  RadauControl control = started(fixed(3));
  control.rejected(0.2, error_of(5.0, 6));
  EXPECT_LE(control.accepted(0.1, error_of(1e-6, 6), costs, false), 0.1);
  EXPECT_EQ(control.failures_in_a_row(), 0);
  EXPECT_GT(control.accepted(0.1, error_of(1e-6, 6), costs, false), 0.1);
}

TEST(RadauControl, TwoFailuresInARowAreRough) {
  RadauControl control = started(fixed(3));
  control.rejected(0.2, error_of(5.0, 6));
  EXPECT_FALSE(control.is_rough());
  control.rejected(0.1, error_of(5.0, 6));
  EXPECT_TRUE(control.is_rough());
  control.accepted_without_error(0.1);
  EXPECT_FALSE(control.is_rough());
  EXPECT_EQ(control.failures_in_a_row(), 0);
}

TEST(RadauControl, AStepThatSavesFactorizationsIsKept) {
  StepOptions options = fixed(3);
  options.classical_control = true;
  options.keep_to = 1.3;
  const ErrorTerms slightly_larger = error_of(std::pow(0.75, 6), 6);  // ratio 0.9 / 0.75 = 1.2
  EXPECT_EQ(started(options).accepted(0.1, slightly_larger, costs, true), 0.1);
  EXPECT_NEAR(started(options).accepted(0.1, slightly_larger, costs, false), 0.12, 1e-15);
  options.keep_to = 1.1;
  EXPECT_NEAR(started(options).accepted(0.1, slightly_larger, costs, true), 0.12, 1e-15);
}

// Divided differences that fall fast call for many stages, slowly falling ones for few.
TEST(RadauControl, StagesFollowTheDecayOfDividedDifferences) {
  const auto stages_for = [](double scale, double ratio) {
    StepOptions options;
    RadauControl control = started(options);
    for (int step = 0; step < 6; ++step) {
      const int s = control.stages();
      ErrorTerms terms = error_of(0.5, s + 1);
      for (int k = 1; k <= s; ++k) terms.decay[static_cast<std::size_t>(k)] = scale * std::pow(ratio, k);
      control.accepted(0.1, terms, costs, false);
    }
    return control.stages();
  };
  EXPECT_GE(stages_for(1e9, 0.2), 5);   // nine digits, smooth
  EXPECT_LE(stages_for(10.0, 0.9), 3);  // one digit, rough
}

}  // namespace
