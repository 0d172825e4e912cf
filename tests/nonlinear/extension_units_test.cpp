// SPDX-License-Identifier: BSD-3-Clause
// Starts of the minimal extension do not depend on the unit of time.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "family_run.h"
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

// Nor to characteristic values: the strangeness index counts what equations of each level do to x, and rounding
// errors of zeros multiplied by powers of the unit are no effects.
TEST(ExtensionUnits, OfTimeDoNotMatterToCharacteristicValues) {
  struct Case {
    unsigned seed;
    double unit;
  };
  // Those that had another index once, and random ones.
  std::vector<Case> cases = {{2841, 1e9}, {3468, 1e-6}, {4092, 1e9},  {6069, 1e6},
                             {7488, 1e5}, {8542, 1e6},  {16656, 1e9}, {20128, 1e-8}};
  RandomNumbers numbers(1);
  for (int trial = scaled_count(10000); trial > 0; --trial)
    cases.push_back({static_cast<unsigned>(trial), std::pow(10.0, std::round(numbers.uniform(-9.0, 9.0)))});
  std::size_t known = 0;
  for (const auto& [seed, unit] : cases) {
    const auto mixing = seed % 3 == 0   ? SparseSystem::Mixing::constant
                        : seed % 3 == 1 ? SparseSystem::Mixing::any
                                        : SparseSystem::Mixing::none;
    const SparseSystem system(seed, mixing);
    for (const double t : {0.2, 1.5}) {
      SCOPED_TRACE(testing::Message() << seed << ", " << unit << ", " << t);
      NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_REQUIRED));
      if (!is_known(run.analyze(t * unit, (1.7 - t) * unit, system.exact(t)))) continue;
      EXPECT_EQ(run.values(), system.values());
      ++known;
    }
  }
  EXPECT_GT(known, 2 * cases.size() * 70 / 100);
}

}  // namespace sfdae_test
