// Mechanisms that pass singular configurations: the motion goes on smoothly where that is asked for.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "multibody/callbacks.h"
#include "multibody/recorded.h"
#include "multibody/singular_mechanisms.h"
#include "multibody_run.h"
#include "sfdae/branches.h"

namespace sfdae::test {
namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
const double upright = 0.5 * std::acos(-1.0);

template <class System>
sfdae_multibody_problem recorded(System& system) {
  sfdae_multibody_problem problem = multibody_problem_of(system.sizes.positions, system.sizes.holonomic);
  problem.equations = &RecordedMultibody<System>::multibody;
  problem.user = &system;
  return problem;
}

template <class System>
sfdae_multibody_problem by_callbacks(System& system) {
  sfdae_multibody_problem problem = multibody_problem_of(system.sizes.positions, system.sizes.holonomic);
  MultibodyCallbacks<System>::fill(system, problem);
  problem.user = &system;
  return problem;
}

sfdae_singular_point point_of(const MultibodyRun& run) {
  sfdae_singular_point point;
  sfdae_singular_point_init(&point, sizeof point);
  EXPECT_EQ(sfdae_get_singular_point(run.solver.get(), &point), SFDAE_OK) << run.message();
  return point;
}

double angle_of_windows(int windows, double speed, double time) {
  const double rate = Windows::gravity * (windows + 0.5 * (windows + 1)) / (windows + (windows + 1) / 3.0);
  return angle_after(upright, speed, time, [rate](double phi, double) { return -rate * std::cos(phi); });
}

// The reference of the benchmark library, to 10 digits; 20 singular configurations on the way. Where a trajectory near
// one of them is not known accurately enough, the integration stops there by name: at a fifth of these tolerances.
TEST(Mechanisms, OfTwoWindowsPassTheirSingularConfigurations) {
  EXPECT_NEAR(std::cos(angle_of_windows(2, -1.0, 20.0)), 0.8397465743, 1e-8);
  Windows windows(2);
  int runs = 0, finished = 0;
  for (const int method : methods)
    for (double tolerance = 1.6e-8; tolerance > 6e-10; tolerance *= 0.6) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance);
      MultibodyRun run(recorded(windows), options_of(method, tolerance));
      ASSERT_GE(run.start(0.0, 20.0, windows.start(upright, -1.0)), SFDAE_OK) << run.message();
      ASSERT_EQ(sfdae_pass_singular_points(run.solver.get(), 1000), SFDAE_OK);
      ++runs;
      if (run.advance(0.8) == SFDAE_OK) {
        const sfdae_singular_point first = point_of(run);
        EXPECT_NEAR(first.t, 0.7143555264, 1e-6);
        EXPECT_EQ(first.kind, SFDAE_SINGULAR_CROSSING);
        EXPECT_EQ(first.part, SFDAE_PART_CONSTRAINTS);
      }
      if (run.status != SFDAE_OK || run.advance(20.0) != SFDAE_OK) {
        EXPECT_EQ(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message();
        continue;
      }
      ++finished;
      EXPECT_NEAR(run.x[0], 0.8397465743, 5e3 * tolerance);
      EXPECT_NEAR(run.x[1], 0.5429785364, 5e3 * tolerance);
      // All windows stay parallel.
      for (std::size_t k = 1; k <= 2; ++k) EXPECT_NEAR(run.x[2 * k] - run.x[2 * k - 2], 1.0, 1e-8);
      EXPECT_GE(point_of(run).count, 20);
    }
  EXPECT_GE(finished, 3 * runs / 4);
}

TEST(Mechanisms, StopAtThemOtherwise) {
  Windows windows(2);
  for (const int method : methods) {
    MultibodyRun run(recorded(windows), options_of(method, 1e-7));
    ASSERT_GE(run.start(0.0, 20.0, windows.start(upright, -1.0)), SFDAE_OK) << run.message();
    EXPECT_EQ(run.advance(20.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
    const sfdae_singular_point point = point_of(run);
    EXPECT_NEAR(point.t, 0.7143555264, 1e-5);
    EXPECT_EQ(point.part, SFDAE_PART_CONSTRAINTS);
    EXPECT_EQ(point.passed, 0);
    EXPECT_NE(point.kind, SFDAE_SINGULAR_FOLD);
    EXPECT_NE(point.kind, SFDAE_SINGULAR_UNBOUNDED);
  }
}

// Where they get they are right; with loose tolerances they may stop.
TEST(Mechanisms, OfWindowsAreRightInAllUnitsOfTime) {
  int runs = 0, finished = 0;
  for (const int count : {1, 2, 3})
    for (const double second : {1e-3, 1.0, 1e3})
      for (const int method : methods)
        for (const double tolerance : {1e-6, 1e-8}) {
          SCOPED_TRACE(testing::Message() << count << " windows, second " << second << ", method " << method);
          Windows windows(count, second);
          sfdae_options options = options_of(method, tolerance);
          std::vector<double> atol(static_cast<std::size_t>(windows.sizes.unknowns()), tolerance);
          // Velocities and multipliers in their units.
          const auto nq = static_cast<std::size_t>(windows.sizes.positions);
          for (std::size_t i = nq; i < atol.size(); ++i) atol[i] /= i < 2 * nq ? second : second * second;
          options.atol_vector = atol.data();
          MultibodyRun run(recorded(windows), options);
          ASSERT_GE(run.start(0.0, 5.0 * second, windows.start(upright, -1.0)), SFDAE_OK) << run.message();
          sfdae_pass_singular_points(run.solver.get(), 1000);
          run.advance(5.0 * second);
          ++runs;
          finished += run.status == SFDAE_OK ? 1 : 0;
          if (run.status != SFDAE_OK) {
            EXPECT_TRUE(run.status == SFDAE_CHARACTERISTICS_CHANGED || run.status == SFDAE_STEP_TOO_SMALL)
                << run.message();
          }
          const double phi = angle_of_windows(count, -1.0, run.t / second);
          EXPECT_NEAR(run.x[0], std::cos(phi), 2e3 * tolerance);
          EXPECT_NEAR(run.x[1], std::sin(phi), 2e3 * tolerance);
        }
  RecordProperty("finished", finished);
  EXPECT_GE(finished, runs * 3 / 4);
}

// Recorded, and as callbacks.
TEST(Mechanisms, OfACrankAndAnEqualRodPassTheUprightPosition) {
  EqualSliderCrank crank;
  const double speed = 1.0, phi = angle_after(0.3, speed, 6.0, [](double angle, double rate) {
                              const double s = std::sin(angle), c = std::cos(angle);
                              return -4.0 * s * c * rate * rate / (1.0 + 4.0 * s * s);
                            });
  const auto expect_passed = [&](const sfdae_multibody_problem& problem, int method, double tolerance) {
    SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance);
    MultibodyRun run(problem, options_of(method, tolerance));
    ASSERT_GE(run.start(0.0, 6.0, EqualSliderCrank::start(0.3, speed)), SFDAE_OK) << run.message();
    sfdae_pass_singular_points(run.solver.get(), 10);
    ASSERT_EQ(run.advance(6.0), SFDAE_OK) << run.message();
    EXPECT_EQ(point_of(run).count, 1);
    EXPECT_NEAR(run.x[0], std::cos(phi), 1e3 * tolerance);
    EXPECT_NEAR(run.x[1], std::sin(phi), 1e3 * tolerance);
    EXPECT_NEAR(run.x[2], 2.0 * std::cos(phi), 1e3 * tolerance);
  };
  for (const int method : methods)
    for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
      expect_passed(recorded(crank), method, tolerance);
      expect_passed(by_callbacks(crank), method, tolerance);
    }
}

// Crank and rod of length 1; the slider is pulled away with constant speed and gets to x2 = 2 at t = 1.
struct PulledCrank : MechanicalSystem {
  PulledCrank() : MechanicalSystem({2, 2, 0}) {}
  template <class V>
  void mass(const V&, const V*, V* M) const {
    M[0] = M[3] = V(1.0);
  }
  template <class V>
  void force(const V&, const V*, const V*, V*) const {}
  template <class V>
  void constraints(const V& t, const V* q, V* g) const {
    g[0] = square(q[0]) + square(q[1]) - 1.0;
    g[1] = square(q[0] - (1.0 + t)) + square(q[1]) - 1.0;
  }
};

TEST(Mechanisms, ThatAreStretchedEndInAFold) {
  PulledCrank crank;
  for (const int method : methods)
    for (const double tolerance : {1e-5, 1e-8}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance);
      MultibodyRun run(recorded(crank), options_of(method, tolerance));
      ASSERT_GE(run.start(0.0, 2.0, {0.5, std::sqrt(0.75)}), SFDAE_OK) << run.message();
      sfdae_pass_singular_points(run.solver.get(), 10);
      EXPECT_LT(run.advance(2.0), 0);
      EXPECT_LE(run.t, 1.0 + 1e-6);
      if (run.status != SFDAE_CHARACTERISTICS_CHANGED) continue;
      const sfdae_singular_point point = point_of(run);
      EXPECT_EQ(point.count, 0);
      EXPECT_EQ(point.part, SFDAE_PART_CONSTRAINTS);
      EXPECT_NE(point.kind, SFDAE_SINGULAR_CROSSING) << run.message();
    }
}

}  // namespace
}  // namespace sfdae::test
