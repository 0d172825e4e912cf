// SPDX-License-Identifier: BSD-3-Clause
// The minimal extension beside the whole array: objects of the theory, checkpoints of one given to the other.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "nonlinear_run.h"
#include "sparse_system.h"

namespace sfdae_test {

namespace {

sfdae_options with_structure(int structure) {
  sfdae_options options = options_with(1e-6);
  options.structure = structure;
  return options;
}

// In units of time in which it takes `unit` of them for what takes 1 otherwise.
NonlinearEquations in_units(const SparseSystem& system, double unit) {
  return equations_of(system.n(), system.n(),
                      [&system, unit](const auto& t, const auto* x, const auto* xdot, auto* F) {
                        std::vector<std::decay_t<decltype(*x)>> slopes;
                        for (int i = 0; i < system.n(); ++i) slopes.push_back(xdot[i] * unit);
                        system.residual(t * (1.0 / unit), x, slopes.data(), F);
                      });
}

}  // namespace

// What is confirmed in one unit is confirmed in others: microseconds, hours.
TEST(ExtensionObjects, HaveTheIndexInAnyUnitOfTime) {
  int confirmed = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const SparseSystem system(seed, false);
    bool is_confirmed = true;
    for (const double unit : {1.0, 1e-3, 1e-5, 1e2}) {
      SCOPED_TRACE(testing::Message() << seed << ", " << unit);
      NonlinearRun run(in_units(system, unit), with_structure(SFDAE_STRUCTURE_REQUIRED));
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
      const SparseSystem system(seed, false);
      NonlinearRun run(in_units(system, unit), with_structure(SFDAE_STRUCTURE_REQUIRED));
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

}  // namespace sfdae_test
