// Choice of order and step size.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/step_control.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace sfdae::core;

// terms[q] = size * fall^q: a smooth solution if fall < 1.
LocalTerms terms_with(double size, double fall) {
  LocalTerms terms;
  for (int q = 0; q < max_bdf_order + 2; ++q) terms.of_order[q] = size * std::pow(fall, q);
  return terms;
}

TEST(StepControl, StartsByRaisingOrderAndStepWithEveryStep) {
  StepControl control;
  control.start(5);
  double h = 1e-3;
  for (int order = 1; order < 5; ++order) {
    EXPECT_EQ(control.order(), order);
    const double next = control.accepted(h, terms_with(1e-3, 0.1));
    EXPECT_DOUBLE_EQ(next, 2.0 * h);
    h = next;
  }
  EXPECT_EQ(control.order(), 5);
}

TEST(StepControl, TheOrderNeverExceedsTheLimit) {
  StepControl control;
  control.start(2);
  double h = 1e-3;
  for (int i = 0; i < 50; ++i) {
    h = control.accepted(h, terms_with(1e-3, 0.1));
    EXPECT_LE(control.order(), 2);
  }
}

TEST(StepControl, LowersTheOrderWhereTermsDoNotFall) {
  StepControl control;
  control.start(5);
  double h = 1e-3;
  for (int i = 0; i < 6; ++i) h = control.accepted(h, terms_with(1e-3, 0.1));
  ASSERT_EQ(control.order(), 5);
  control.accepted(h, terms_with(1e-3, 1.5));
  EXPECT_EQ(control.order(), 4);
}

TEST(StepControl, ARejectedFirstStepIsSizedFromItsError) {
  StepControl control;
  control.start(5);
  // The error of order 1 is half the term; h scales with its square root.
  const double next = control.rejected(1.0, terms_with(2e6, 1.0), true);
  EXPECT_NEAR(next, 0.7e-3, 1e-9);
  EXPECT_EQ(control.order(), 1);
}

TEST(StepControl, RepeatedRejectionsEndAtOrderOneWithSmallSteps) {
  StepControl control;
  control.start(5);
  double h = 1.0;
  for (int i = 0; i < 6; ++i) h = control.accepted(h, terms_with(1e-3, 0.1));
  for (int i = 0; i < 4; ++i) {
    const double next = control.rejected(h, terms_with(10.0, 0.9), true);
    EXPECT_LE(next, 0.9 * h);
    EXPECT_GE(next, 0.25 * h);
    h = next;
  }
  EXPECT_EQ(control.order(), 1);
  EXPECT_EQ(control.failures_in_a_row(), 4);
  control.accepted(h, terms_with(1e-3, 0.1));
  EXPECT_EQ(control.failures_in_a_row(), 0);
}

TEST(StepControl, AFailedEvaluationQuartersTheStep) {
  StepControl control;
  control.start(5);
  EXPECT_DOUBLE_EQ(control.failed(-0.4), -0.1);
}

}  // namespace
