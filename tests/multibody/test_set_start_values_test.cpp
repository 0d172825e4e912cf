// Start values of the mechanical systems of the literature: positions and velocities stay, forces are found.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "multibody/models.h"
#include "multibody/multibody_run.h"

namespace {

using namespace sfdae_test;

// From the published values, which may be rounded, to consistent ones without a warning, and from these with forces
// unknown back to the same point.
TEST(StartValuesOfTheTestSet, StayWhereTheyAreConsistent) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    for (const MultibodyForm form : {MultibodyForm::recorded, MultibodyForm::callbacks}) {
      if (p.name == "fekete" && form == MultibodyForm::callbacks) continue;  // callbacks with series take long
      SCOPED_TRACE(testing::Message() << p.name << ", form " << static_cast<int>(form));
      MultibodyRun run(system, form, multibody_options(1e-6, SFDAE_METHOD_RADAU));
      const int status = run.start(p.t0, p.tf, p.x0);
      ASSERT_EQ(status, SFDAE_OK) << run.text(status);
      const std::vector<double> consistent = run.x;
      const std::size_t size = static_cast<std::size_t>(2 * system.sizes.positions);
      const std::vector<double> without_forces(consistent.begin(), consistent.begin() + static_cast<long>(size));
      ASSERT_EQ(run.start(p.t0, p.tf, without_forces), SFDAE_OK) << run.text(-1);
      double largest = 1.0;
      for (std::size_t i = 0; i < size; ++i) largest = std::max(largest, std::abs(consistent[i]));
      // Rounding errors of positions and velocities, times the condition of the constraints.
      for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(run.x[i], consistent[i], 1e-13 * largest) << i;
      double force = 1.0;
      for (const double value : consistent) force = std::max(force, std::abs(value));
      for (std::size_t i = size; i < run.x.size(); ++i) EXPECT_NEAR(run.x[i], consistent[i], 1e-9 * force) << i;
    }
  });
}

}  // namespace
