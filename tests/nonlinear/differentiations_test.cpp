// SPDX-License-Identifier: BSD-3-Clause
// Minimal extension: equations that are differentiated less often than others.
#include <gtest/gtest.h>

#include <cmath>

#include "checkpoint_of.h"
#include "nonlinear_run.h"
#include "test_set/andrews.h"
#include "test_set/car_axis.h"
#include "test_set/pendulum.h"

namespace {

using namespace sfdae_test;

struct Case {
  TestProblem data;
  NonlinearEquations equations;
  std::vector<int> enough;  // as often as the index asks for: kinematics once, constraints twice, forces never
};

std::vector<int> concatenated(std::initializer_list<std::pair<int, int>> counted) {
  std::vector<int> counts;
  for (const auto& [number, count] : counted) counts.insert(counts.end(), static_cast<std::size_t>(number), count);
  return counts;
}

template <class Residual>
Case case_of(TestProblem data, Residual residual, std::vector<int> enough) {
  NonlinearEquations equations = equations_of(data.m, data.n, residual);
  return {std::move(data), std::move(equations), std::move(enough)};
}

Case pendulum_case() {
  return case_of(
      pendulum(), [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); },
      concatenated({{2, 1}, {2, 0}, {1, 2}}));
}
Case car_axis_case() {
  return case_of(
      car_axis(), [](const auto& t, const auto* x, const auto* xdot, auto* F) { car_axis_residual(t, x, xdot, F); },
      concatenated({{4, 1}, {4, 0}, {2, 2}}));
}
Case andrews_case() {
  return case_of(
      andrews(), [](const auto& t, const auto* x, const auto* xdot, auto* F) { andrews_residual(t, x, xdot, F); },
      concatenated({{7, 1}, {14, 0}, {6, 2}}));
}

NonlinearEquations limited(const NonlinearEquations& equations, std::vector<int> counts) {
  NonlinearEquations result = equations;
  result.differentiations = std::move(counts);
  return result;
}

// Errors of both integrations, at most a hundred tolerances each, and of x' by the size that x' has.
constexpr double tolerance = 1e-7, allowed = 200.0 * tolerance;

double size_of(const std::vector<double>& x) {
  double size = 1.0;
  for (const double value : x) size = std::max(size, std::fabs(value));
  return size;
}

TEST(MinimalExtension, HasTheCharacteristicValuesAndTheInitialSlopeOfTheWholeArray) {
  for (const Case& c : {pendulum_case(), car_axis_case(), andrews_case()}) {
    SCOPED_TRACE(c.data.name);
    NonlinearRun whole(c.equations, options_with(tolerance)),
        less(limited(c.equations, c.enough), options_with(tolerance));
    ASSERT_EQ(less.created, SFDAE_OK);
    ASSERT_EQ(whole.start(c.data.t0, c.data.tf, c.data.x0), SFDAE_OK) << whole.message();
    ASSERT_EQ(less.start(c.data.t0, c.data.tf, c.data.x0), SFDAE_OK) << less.message();
    EXPECT_EQ(less.values(), c.data.values);
    EXPECT_EQ(whole.values(), less.values());
    for (std::size_t i = 0; i < whole.x.size(); ++i) {
      EXPECT_NEAR(less.x[i], whole.x[i], 1e-11 * size_of(whole.x)) << i;
      EXPECT_NEAR(less.xdot[i], whole.xdot[i], 1e-9 * size_of(whole.xdot)) << i;
    }
  }
}

TEST(MinimalExtension, MovesAsTheWholeSystemDoes) {
  for (const Case& c : {pendulum_case(), car_axis_case()})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      SCOPED_TRACE(testing::Message() << c.data.name << ", method " << method);
      NonlinearRun whole(c.equations, options_with(tolerance, method)),
          less(limited(c.equations, c.enough), options_with(tolerance, method));
      ASSERT_EQ(whole.integrate(c.data.t0, 1.0, c.data.x0), SFDAE_OK) << whole.message();
      ASSERT_EQ(less.integrate(c.data.t0, 1.0, c.data.x0), SFDAE_OK) << less.message();
      for (std::size_t i = 0; i < whole.x.size(); ++i)
        EXPECT_NEAR(less.x[i], whole.x[i], allowed * size_of(whole.x)) << i;
      EXPECT_LT(static_cast<double>(less.statistics().steps), 1.5 * static_cast<double>(whole.statistics().steps));
    }
}

TEST(MinimalExtension, ReachesTheReferenceOfAndrewsSqueezer) {
  const Case c = andrews_case();
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    NonlinearRun run(limited(c.equations, c.enough), options_with(1e-6, method));
    ASSERT_EQ(run.integrate(c.data.t0, c.data.tf, c.data.x0), SFDAE_OK) << run.message();
    EXPECT_GE(correct_digits(c.data, c.data.references.back(), run.x.data()), 3.5) << "method " << method;
  }
}

// With the counts of a whole array it is the whole array that is used.
TEST(MinimalExtension, WithAllEquationsIsTheWholeArray) {
  const Case c = pendulum_case();
  sfdae_options whole_array = options_with(1e-6);
  whole_array.structure = SFDAE_STRUCTURE_OFF;
  NonlinearRun whole(c.equations, whole_array), all(limited(c.equations, {12, 12, 12, 12, 12}), options_with(1e-6)),
      many(limited(c.equations, {2, 2, 2, 2, 2}), options_with(1e-6));
  for (NonlinearRun* run : {&whole, &all, &many})
    ASSERT_EQ(run->integrate(0.0, 2.0, c.data.x0), SFDAE_OK) << run->message();
  EXPECT_EQ(all.x, whole.x);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(many.x[i], whole.x[i], 1e-10 * size_of(whole.x));
}

// The constraint twice, and the second balance of forces twice: what is redundant need not be differentiated to be
// known.
template <class V>
void redundant_pendulum(const V& t, const V* x, const V* xdot, V* F) {
  pendulum_residual(t, x, xdot, F);
  F[5] = 3.0 * F[4];
  F[6] = F[3] - F[2];
}

TEST(MinimalExtension, FindsRedundantEquationsWhetherOrNotTheyAreDifferentiated) {
  const auto residual = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    redundant_pendulum(t, x, xdot, F);
  };
  const NonlinearEquations equations = equations_of(7, 5, residual);
  const TestProblem p = pendulum();
  NonlinearRun whole(pendulum_case().equations, options_with(tolerance));
  ASSERT_EQ(whole.integrate(0.0, 1.0, p.x0), SFDAE_OK);
  for (const std::vector<int>& counts :
       {std::vector<int>{1, 1, 0, 0, 2, 0, 0}, {1, 1, 0, 0, 2, 2, 2}, {1, 1, 0, 0, 1, 2, 0}}) {
    SCOPED_TRACE(testing::PrintToString(counts));
    NonlinearRun run(limited(equations, counts), options_with(tolerance));
    const int status = run.integrate(0.0, 1.0, p.x0);
    ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
    EXPECT_EQ(run.values(), (CharacteristicValues{2, 2, 3, 0, 2}));
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(run.x[i], whole.x[i], allowed * size_of(whole.x));
  }
}

// A force that nothing determines: u = 1.
TEST(MinimalExtension, KeepsFreeComponentsFree) {
  const auto residual = [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    pendulum_residual(t, x, xdot, F);
    F[2] = F[2] - x[5];
  };
  const NonlinearEquations equations = equations_of(5, 6, residual);
  const std::vector<double> x0 = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  NonlinearRun whole(equations, options_with(1e-6)), less(limited(equations, {1, 1, 0, 0, 2}), options_with(1e-6));
  ASSERT_EQ(whole.start(0.0, 1.0, x0), SFDAE_NOT_UNIQUE) << whole.message();
  ASSERT_EQ(less.start(0.0, 1.0, x0), SFDAE_NOT_UNIQUE) << less.message();
  EXPECT_EQ(less.values(), whole.values());
  EXPECT_EQ(less.values().u, 1);
}

TEST(MinimalExtension, SaysSoWhereCountsAreTooSmall) {
  const Case c = pendulum_case();
  for (const std::vector<int>& counts :
       {std::vector<int>{1, 1, 0, 0, 1}, {0, 0, 0, 0, 2}, {0, 0, 0, 0, 0}, {12, 12, 12, 12, 1}, {1, 0, 0, 0, 2}}) {
    SCOPED_TRACE(testing::PrintToString(counts));
    NonlinearRun run(limited(c.equations, counts), options_with(1e-6));
    ASSERT_EQ(run.created, SFDAE_OK);
    EXPECT_EQ(run.start(0.0, 1.0, {0.6, -0.8, 0.0, 0.0, 0.0}), SFDAE_INDEX_TOO_HIGH) << run.message();
    EXPECT_NE(run.message().find("differentiations are too few"), std::string::npos) << run.message();
  }
}

// x1 = t^2, x2 = x1', x3 = x2': without x1'' there is nothing that determines x3, and d + a stays below 3.
TEST(MinimalExtension, IsNotContentWithAPartOfTheConstraints) {
  const NonlinearEquations equations =
      equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
        F[0] = xdot[0] - x[1];
        F[1] = xdot[1] - x[2];
        F[2] = x[0] - t * t;
      });
  NonlinearRun good(limited(equations, {1, 0, 2}), options_with(1e-6)),
      bad(limited(equations, {0, 0, 2}), options_with(1e-6));
  ASSERT_EQ(good.start(1.0, 2.0, {0.0, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << good.message();
  EXPECT_EQ(good.values(), (CharacteristicValues{2, 0, 3, 0, 0}));
  EXPECT_NEAR(good.x[0], 1.0, 1e-14);
  EXPECT_NEAR(good.x[1], 2.0, 1e-14);
  EXPECT_NEAR(good.x[2], 2.0, 1e-13);
  for (const double slope : {good.xdot[0] - 2.0, good.xdot[1] - 2.0, good.xdot[2]}) EXPECT_NEAR(slope, 0.0, 1e-12);
  EXPECT_EQ(bad.start(1.0, 2.0, {0.0, 0.0, 0.0}), SFDAE_INDEX_TOO_HIGH);
}

TEST(MinimalExtension, RefusesCountsThatAreNone) {
  const Case c = pendulum_case();
  for (const int count : {-1, 13}) {
    NonlinearRun run(limited(c.equations, {1, 1, 0, count, 2}), options_with(1e-6));
    EXPECT_EQ(run.created, SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_EQ(run.solver(), nullptr);
  }
}

TEST(MinimalExtension, IsReadBySingularValuesAsWell) {
  for (const Case& c : {pendulum_case(), car_axis_case()}) {
    sfdae_options options = options_with(1e-6);
    options.reduction = SFDAE_REDUCTION_SVD;
    NonlinearRun run(limited(c.equations, c.enough), options);
    ASSERT_EQ(run.integrate(c.data.t0, 1.0, c.data.x0), SFDAE_OK) << run.message();
    EXPECT_EQ(run.values(), c.data.values);
  }
}

TEST(MinimalExtension, SurvivesACheckpoint) {
  const Case c = pendulum_case();
  const NonlinearEquations equations = limited(c.equations, c.enough);
  NonlinearRun run(equations, options_with(1e-6)), other(equations, options_with(1e-6));
  ASSERT_EQ(run.integrate(0.0, 1.0, c.data.x0), SFDAE_OK);
  const std::vector<double> checkpoint = checkpoint_of(run.solver());
  ASSERT_EQ(sfdae_restore_checkpoint(other.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
      << other.message();
  other.x.resize(5);
  ASSERT_EQ(run.advance(2.0), SFDAE_OK);
  ASSERT_EQ(other.advance(2.0), SFDAE_OK);
  EXPECT_EQ(run.x, other.x);
}

}  // namespace
