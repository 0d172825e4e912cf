// SPDX-License-Identifier: BSD-3-Clause
// What the whole derivative array says, and solutions with it, do not depend on the unit of time: nanoseconds,
// millions of years.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "family_run.h"
#include "sparse_run.h"

namespace sfdae_test {

namespace {

constexpr SparseSystem::Mixing mixings[] = {SparseSystem::Mixing::none, SparseSystem::Mixing::any};

}  // namespace

TEST(UnitsOfTime, DoNotMatterToCharacteristicValues) {
  const int count = scaled_count(200);
  for (const SparseSystem::Mixing mixing : mixings)
    for (int seed = 1; seed <= count; ++seed) {
      const SparseSystem system(static_cast<unsigned>(seed), mixing);
      for (const double unit : {1e-15, 1e-8, 1e-3, 1.0, 1e3, 1e5, 1e8, 1e12, 1e15}) {
        SCOPED_TRACE(testing::Message() << seed << ", " << unit);
        NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_OFF));
        ASSERT_EQ(run.analyze(0.2 * unit, unit, system.exact(0.2)), SFDAE_OK) << run.message();
        EXPECT_EQ(run.values(), system.values());
      }
    }
}

TEST(UnitsOfTime, DoNotMatterToSolutions) {
  const int count = scaled_count(60);
  for (const SparseSystem::Mixing mixing : mixings)
    for (int seed = 1; seed <= count; ++seed) {
      const SparseSystem system(static_cast<unsigned>(seed), mixing);
      for (const double unit : {1e-9, 1e8})
        for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
          SCOPED_TRACE(testing::Message() << seed << ", " << unit << ", " << method);
          NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_OFF, method));
          const int status = run.integrate(0.2 * unit, 1.5 * unit, system.exact(0.2));
          ASSERT_TRUE(is_known(status)) << status_text(run, status);
          EXPECT_LT(error_in_tolerances(run.x, system.exact(1.5)), 10.0);
        }
    }
}

}  // namespace sfdae_test
