// SPDX-License-Identifier: BSD-3-Clause
// Chains of pendula of any index: what is known of them, or a failure with a name.
#include "pendulum_chain.h"

#include <gtest/gtest.h>

#include <string>

#include "sparse_run.h"

namespace sfdae_test {

namespace {

sfdae_options required(int method = SFDAE_METHOD_BDF) { return options_of(SFDAE_STRUCTURE_REQUIRED, method); }

}  // namespace

// Jets of order 17 are guessed from polynomials of degree 8.
TEST(PendulumChain, HasOutputsWithinStepsOfRadau) {
  constexpr int pendula = 8;
  NonlinearRun run(pendulum_chain(pendula), required(SFDAE_METHOD_RADAU));
  ASSERT_TRUE(is_known(run.start(0.0, 3.0, chain_at_rest(pendula, -1.27, 1.0)))) << run.message();
  const double at_start = energy(run.x);
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(is_known(run.advance(0.1 * k))) << run.message();
    EXPECT_LT(error_of_lengths(run.x), 1e-13) << k;
    EXPECT_NEAR(energy(run.x), at_start, 1e-6) << k;
  }
  EXPECT_LT(run.statistics().steps, 25);
}

}  // namespace sfdae_test
