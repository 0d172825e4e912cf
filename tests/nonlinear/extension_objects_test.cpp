// SPDX-License-Identifier: BSD-3-Clause
// The minimal extension beside the whole array: objects of the theory, checkpoints of one given to the other.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "checkpoint_of.h"
#include "sparse_run.h"

namespace sfdae_test {

// What is confirmed in one unit is confirmed in others: microseconds, hours.
TEST(ExtensionObjects, HaveTheIndexInAnyUnitOfTime) {
  int confirmed = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SparseSystem system(seed, SparseSystem::Mixing::none);
    bool is_confirmed = true;
    for (const double unit : {1.0, 1e-3, 1e-5, 1e2}) {
      SCOPED_TRACE(testing::Message() << seed << ", " << unit);
      NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_REQUIRED));
      const int status = run.analyze(0.2 * unit, unit, system.exact(0.2));
      if (unit == 1.0) is_confirmed = status == SFDAE_OK;
      if (!is_confirmed) continue;
      ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
      EXPECT_EQ(run.values(), system.values());
      ++confirmed;
    }
  }
  EXPECT_GT(confirmed, 150);
}

// Arrays that are as large as the characteristic values say are enough, or untouched.
TEST(ExtensionObjects, FitTheCharacteristicValues) {
  constexpr double guard = 7.25;
  for (unsigned seed = 1; seed <= 40; ++seed)
    for (const double unit : {1e-9, 1e-5, 1.0, 1e5, 1e9}) {
      SCOPED_TRACE(testing::Message() << seed << ", " << unit);
      const SparseSystem system(seed, SparseSystem::Mixing::none);
      NonlinearRun run(in_units(system, unit), options_of(SFDAE_STRUCTURE_REQUIRED));
      if (run.analyze(0.2 * unit, unit, system.exact(0.2)) < 0) continue;
      const std::size_t n = static_cast<std::size_t>(system.n()), a = static_cast<std::size_t>(run.values().a),
                        rows = (static_cast<std::size_t>(run.values().mu) + 1) * n;
      std::vector<double> Z2(2 * rows * a + 4 * n * a, guard);
      const int status =
          sfdae_get_projectors(run.solver(), 0.2 * unit, nullptr, Z2.data(), nullptr, nullptr, nullptr);
      const std::size_t written = status >= 0 ? rows * a : 0;
      for (std::size_t i = written; i < Z2.size(); ++i) ASSERT_EQ(Z2[i], guard) << i;
      if (status < 0) {
        EXPECT_EQ(status, SFDAE_RANK_UNCLEAR) << status_text(run, status);
      }
    }
}

TEST(ExtensionObjects, CheckpointsThatAreRefusedChangeNothing) {
  const std::vector<double> start = {0.6, -0.8, 0.0, 0.0, 0.0};
  const int structures[] = {SFDAE_STRUCTURE_REQUIRED, SFDAE_STRUCTURE_OFF};
  for (const int own : structures)
    for (const int other : structures) {
      NonlinearRun from({5, 5, pendulum_equations}, options_of(other)),
          run({5, 5, pendulum_equations}, options_of(own)), alone({5, 5, pendulum_equations}, options_of(own));
      ASSERT_GE(from.integrate(0.0, 0.5, start), 0);
      std::vector<double> checkpoint = checkpoint_of(from.solver());
      checkpoint[checkpoint.size() / 2] += 1.0;
      ASSERT_GE(run.integrate(0.0, 0.3, start), 0);
      ASSERT_GE(alone.integrate(0.0, 0.3, start), 0);
      EXPECT_EQ(sfdae_restore_checkpoint(run.solver(), checkpoint.data(), checkpoint.size()), SFDAE_ILLEGAL_ARGUMENT);
      std::vector<char> text(10000);
      EXPECT_EQ(sfdae_report(run.solver(), text.data(), text.size(), nullptr), SFDAE_OK);
      ASSERT_EQ(run.advance(1.0), SFDAE_OK) << run.message();
      ASSERT_EQ(alone.advance(1.0), SFDAE_OK);
      EXPECT_EQ(std::memcmp(run.x.data(), alone.x.data(), 5 * sizeof(double)), 0);
    }
}

// Values that are consistent are the nearest ones, whatever is fixed.
TEST(ExtensionObjects, ConsistentValuesStayWhereSomeAreFixed) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const SparseSystem system(seed, SparseSystem::Mixing::none);
    const std::vector<double> exact = system.exact(0.3);
    sfdae_options options = options_of(SFDAE_STRUCTURE_REQUIRED);
    options.rtol = options.atol = 1e-9;
    std::vector<int> fixed(exact.size(), 0);
    fixed[seed % exact.size()] = 1;
    options.initial_values = SFDAE_INITIAL_FIXED;
    options.fixed = fixed.data();
    NonlinearRun run(in_units(system, 1.0), options);
    if (run.start(0.3, 1.0, exact) != SFDAE_OK) continue;
    for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(run.x[i], exact[i], 1e-9) << seed << ", " << i;
  }
}

// Outputs within the last step, which was made before.
TEST(ExtensionObjects, CheckpointsKnowPointsWithinTheLastStep) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const int structure : {SFDAE_STRUCTURE_REQUIRED, SFDAE_STRUCTURE_OFF}) {
      SCOPED_TRACE(testing::Message() << method << ", " << structure);
      sfdae_options options = options_of(structure);
      options.method = method;
      const std::vector<double> start = {0.6, -0.8, 0.0, 0.0, 0.0};
      NonlinearRun run({5, 5, pendulum_equations}, options), restored({5, 5, pendulum_equations}, options);
      ASSERT_GE(run.integrate(0.0, 0.5, start), 0);
      const std::vector<double> checkpoint = checkpoint_of(run.solver());
      ASSERT_EQ(sfdae_restore_checkpoint(restored.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK);
      const sfdae_statistics statistics = run.statistics();
      const double t = statistics.t_internal - 0.4 * statistics.last_step;
      std::vector<double> x(5), xdot(5), again(5), slope(5);
      ASSERT_EQ(sfdae_interpolate(run.solver(), t, x.data(), xdot.data()), SFDAE_OK);
      ASSERT_EQ(sfdae_interpolate(restored.solver(), t, again.data(), slope.data()), SFDAE_OK);
      EXPECT_EQ(x, again);
      EXPECT_EQ(xdot, slope);
    }
}

}  // namespace sfdae_test
