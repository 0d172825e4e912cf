// SPDX-License-Identifier: BSD-3-Clause
// Starts of the minimal extension do not depend on the unit of time.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "random_system.h"
#include "sparse_run.h"

namespace sfdae_test {

// Derivatives are 1e32 times as large, or as small, with respect to x.
TEST(ExtensionUnits, OfTimeDoNotMatterToStartValues) {
  int compared = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const SparseSystem system(seed, SparseSystem::Mixing::none);
    RandomNumbers numbers(seed);
    std::vector<double> guess = system.exact(0.2);
    for (double& x : guess) x += numbers.uniform(-1e-2, 1e-2);
    NonlinearRun reference(in_units(system, 1.0), options_of(SFDAE_STRUCTURE_REQUIRED));
    const int expected = reference.start(0.2, 1.0, guess);
    for (const double unit : {1e-12, 1e-8, 1e-5, 1e-2, 1e2, 1e5, 1e8}) {
      SCOPED_TRACE(testing::Message() << seed << ", " << unit);
      NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_REQUIRED));
      const int status = run.start(0.2 * unit, unit, guess);
      ASSERT_EQ(status, expected) << status_text(run, status);
      if (status < 0) continue;
      EXPECT_LE(error_in_tolerances(run.x, reference.x), 1e-3);
      ++compared;
    }
  }
  EXPECT_GT(compared, 600);
}

}  // namespace sfdae_test
