// SPDX-License-Identifier: BSD-3-Clause
// Motions whose course is known: exact solutions, energies, redundant constraints, many bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "family_run.h"
#include "multibody/chain.h"
#include "multibody/four_bar.h"
#include "multibody/knife_edge.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "multibody/residuals.h"

namespace {

using namespace sfdae_test;

constexpr std::array<int, 2> methods = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

// Released at rest from the horizontal it is there again after T = 4 K(sin 45 deg) / sqrt(g). Errors of the energy,
// 0, add up over some 10 steps a radian; those of the phase are errors of the energy, added up once more.
TEST(LongPendulum, KeepsEnergyAndPhaseOverAThousandPeriods) {
  constexpr double K = 1.8540746773013719;
  const double periods = scaled_count(1000);
  const double period = 4.0 * K / std::sqrt(Pendulum::gravity), radians = periods * 2.0 * std::acos(-1.0);
  const DirectSystem<Pendulum> system;
  for (const int method : methods)
    for (const double tolerance : {1e-6, 1e-8}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", " << tolerance);
      MultibodyRun run(system, MultibodyForm::recorded, multibody_options(tolerance, method));
      const int status = run.integrate(0.0, periods * period, {1.0, 0.0});
      ASSERT_EQ(status, SFDAE_OK) << run.text(status);
      const std::vector<double>& x = run.x;
      const double energy = 0.5 * (x[2] * x[2] + x[3] * x[3]) + Pendulum::gravity * x[1];
      EXPECT_LE(std::fabs(energy), 10.0 * radians * tolerance);
      // v = -g (t - 1000 T): time lost, while the phase is not lost altogether.
      if (periods * radians * tolerance < 1.0) {
        EXPECT_LE(std::fabs(x[3] / Pendulum::gravity), 100.0 * radians * tolerance);
      }
      const ConstraintResiduals residuals(system, run.t, x.data());
      EXPECT_LE(residuals.position, 1e-13);
      EXPECT_LE(residuals.velocity, 1e-12);
      RecordProperty("partitions_" + std::to_string(method), std::to_string(run.report().partitions));
    }
}

TEST(KnifeEdge, GlidesAlongItsExactSolution) {
  const KnifeEdge system;
  for (const MultibodyForm form : {MultibodyForm::recorded, MultibodyForm::callbacks, MultibodyForm::extended})
    for (const int method : methods)
      for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
        SCOPED_TRACE(testing::Message() << "form " << static_cast<int>(form) << ", method " << method << ", "
                                        << tolerance);
        MultibodyRun run(system, form, multibody_options(tolerance, method));
        std::vector<double> x0 = KnifeEdge::exact(0.0);
        ASSERT_EQ(run.start(0.0, 10.0, x0), SFDAE_OK) << run.text(-1);
        EXPECT_EQ(run.values(), (CharacteristicValues{1, 5, 2, 0, 0}));
        for (int k = 1; k <= 20; ++k) {
          const int status = run.advance(0.5 * k);
          ASSERT_EQ(status, SFDAE_OK) << run.text(status);
          const std::vector<double> exact = KnifeEdge::exact(run.t);
          for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(run.x[i], exact[i], 300.0 * tolerance * 10.0) << i;
          EXPECT_LE(ConstraintResiduals(system, run.t, run.x.data()).velocity, 1e-12);
        }
      }
}

// The mechanism in space, with a constraint that follows from the others, moves as the one in the plane.
TEST(FourBar, MovesAsIfNothingWereRedundant) {
  constexpr double tolerance = 1e-8;
  const FourBar system;
  const PlaneFourBar plane;
  for (const int method : methods) {
    SCOPED_TRACE(testing::Message() << "method " << method);
    const sfdae_options options = multibody_options(tolerance, method);
    MultibodyRun run(system, MultibodyForm::recorded, options), called(system, MultibodyForm::callbacks, options);
    MultibodyRun reference(plane, MultibodyForm::general, options);
    MultibodyRun in_plane(plane, MultibodyForm::recorded, options);
    ASSERT_EQ(in_plane.start(0.0, 5.0, four_bar_start(false)), SFDAE_OK) << in_plane.text(-1);
    ASSERT_EQ(reference.start(0.0, 5.0, in_plane.x), SFDAE_OK) << reference.text(-1);
    ASSERT_GE(run.start(0.0, 5.0, four_bar_start(true)), SFDAE_OK) << run.text(-1);
    ASSERT_GE(called.start(0.0, 5.0, four_bar_start(true)), SFDAE_OK) << called.text(-1);
    EXPECT_EQ(run.report().redundant, 1);
    EXPECT_EQ(run.report().degrees_of_freedom, 1);
    const double energy = FourBar::energy(run.x.data(), run.x.data() + 6);
    for (int k = 1; k <= 10; ++k) {
      for (int status : {run.advance(0.5 * k), called.advance(0.5 * k), reference.advance(0.5 * k)})
        ASSERT_GE(status, SFDAE_OK) << run.text(status) << reference.text(status);
      constexpr std::array<std::size_t, 8> in_space = {0, 1, 3, 4, 6, 7, 9, 10};
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(run.x[in_space[i]], reference.x[i], 3e3 * tolerance) << i << " at " << run.t;
        EXPECT_NEAR(called.x[in_space[i]], reference.x[i], 3e3 * tolerance) << i << " at " << run.t;
      }
      for (std::size_t i : {std::size_t{2}, std::size_t{5}, std::size_t{8}, std::size_t{11}})
        EXPECT_NEAR(run.x[i], 0.0, 1e-12);
      // The three bars carry what they carry in the plane; nothing presses across it.
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(run.x[12 + i], reference.x[8 + i], 1e4 * tolerance) << i;
      for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(run.x[12 + i], 0.0, 1e4 * tolerance) << i;
      EXPECT_NEAR(FourBar::energy(run.x.data(), run.x.data() + 6), energy, 1e3 * tolerance);
      const ConstraintResiduals residuals(system, run.t, run.x.data());
      EXPECT_LE(residuals.position, 1e-12);
      EXPECT_LE(residuals.velocity, 1e-12);
    }
  }
}

// One link is a pendulum, ten are compared with the general path, a hundred keep their energy. Before chaos sets in.
TEST(PendulumChain, MovesAsItShould) {
  for (const int links : {1, 10, scaled_count(100)})
    for (const int method : methods) {
      constexpr double tolerance = 1e-7;
      SCOPED_TRACE(testing::Message() << links << " links, method " << method);
      const PendulumChain system(links);
      const double end = links == 1 ? 10.0 : links == 10 ? 1.0 : 0.5;
      MultibodyRun run(system, MultibodyForm::recorded, multibody_options(tolerance, method));
      ASSERT_EQ(run.start(0.0, end, system.start()), SFDAE_OK) << run.text(-1);
      const std::vector<double> start = run.x;
      int status = run.advance(end);
      ASSERT_EQ(status, SFDAE_OK) << run.text(status);
      EXPECT_EQ(run.values(), (CharacteristicValues{2, 2 * links, 3 * links, 0, 0}));
      const double *q = run.x.data(), *v = q + 2 * links;
      EXPECT_NEAR(system.energy(q, v), 0.0, 1e3 * tolerance * std::max(1.0, largest_entry(run.x)));
      const ConstraintResiduals residuals(system, run.t, q);
      EXPECT_LE(residuals.position, 1e-12);
      EXPECT_LE(residuals.velocity, 1e-12);
      RecordProperty("partitions_" + std::to_string(links) + "_" + std::to_string(method),
                     std::to_string(run.report().partitions));
      if (links == 1) {
        const TestProblem p = pendulum();
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.x[i], p.references.back().x[i], 1e3 * tolerance) << i;
      }
      if (links != 10) continue;
      MultibodyRun general(system, MultibodyForm::extended, multibody_options(tolerance, method));
      status = general.integrate(0.0, end, start);
      ASSERT_EQ(status, SFDAE_OK) << general.text(status);
      for (std::size_t i = 0; i < general.x.size(); ++i)
        EXPECT_NEAR(run.x[i], general.x[i], 1e3 * tolerance * std::max(1.0, largest_entry(general.x))) << i;
    }
}

}  // namespace
