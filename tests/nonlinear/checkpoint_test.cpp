// SPDX-License-Identifier: BSD-3-Clause
// Checkpoints of nonlinear integrations.
#include <gtest/gtest.h>

#include "checkpoint_of.h"
#include "nonlinear_run.h"
#include "test_set/pendulum.h"

namespace {

using namespace sfdae_test;

// Steps after a checkpoint differ in their last bits at first, which decides now and then what steps follow.
TEST(NonlinearCheckpoints, ContinueWithinTheTolerance) {
  constexpr double tolerance = 1e-6;
  const TestProblem p = pendulum();
  const auto equations = equations_of(
      5, 5, [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); });
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double saved_at : {0.01, 0.7, 3.1, 6.0}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", saved at " << saved_at);
      NonlinearRun whole(equations, options_with(tolerance, method)),
          continued(equations, options_with(tolerance, method));
      ASSERT_EQ(whole.start(p.t0, p.tf, p.x0), SFDAE_OK);
      ASSERT_EQ(whole.advance(saved_at), SFDAE_OK);
      const std::vector<double> checkpoint = checkpoint_of(whole.solver());
      ASSERT_EQ(sfdae_restore_checkpoint(continued.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
          << continued.message();
      continued.x.resize(5);
      for (const double t : {6.5, 8.0, 10.0}) {
        ASSERT_EQ(whole.advance(t), SFDAE_OK);
        ASSERT_EQ(continued.advance(t), SFDAE_OK) << continued.message();
        // Errors grow along the pendulum's motion by some hundreds.
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(continued.x[i], whole.x[i], 1e3 * tolerance) << t;
      }
    }
}

}  // namespace
