// SPDX-License-Identifier: BSD-3-Clause
// Singular points of nonlinear equations: what they are, and which of them are passed. Every smooth solution is known.
//
// SFDAE_SINGULAR_SYSTEMS: how many random systems (default: a few).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "nonlinear_run.h"
#include "sfdae/branches.h"
#include "singular_system.h"

namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
constexpr double tolerances[] = {1e-4, 1e-6, 1e-8};

sfdae_singular_point point_of(NonlinearRun& run) {
  sfdae_singular_point point;
  sfdae_singular_point_init(&point, sizeof point);
  EXPECT_EQ(sfdae_get_singular_point(run.solver(), &point), SFDAE_OK) << run.message();
  return point;
}

struct Smooth {
  const char* name;
  NonlinearEquations equations;
  double start, end, at;
  int part;  // that has to be said, or SFDAE_PART_UNDETERMINED: none has to
  std::vector<double> (*solution)(double t);
};

std::vector<Smooth> smooth_solutions() {
  std::vector<Smooth> all;
  // Another branch is x = 1, y = 0.
  all.push_back({"circle",
                 equations_of(2, 2,
                              [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                F[0] = xdot[0] - x[1];
                                F[1] = x[0] * x[0] + x[1] * x[1] - 1.0;
                              }),
                 0.0, 3.0, 0.5 * std::acos(-1.0), SFDAE_PART_DIFFERENTIAL, [](double t) {
                   return std::vector{std::sin(t), std::cos(t)};
                 }});
  // Another one is y = |t - 1|.
  all.push_back({"crossing lines",
                 equations_of(2, 2,
                              [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                F[0] = xdot[0] - x[1];
                                F[1] = x[1] * x[1] - (t - 1.0) * (t - 1.0);
                              }),
                 0.0, 2.0, 1.0, SFDAE_PART_CONSTRAINTS, [](double t) {
                   return std::vector{0.5 * t * t - t, t - 1.0};
                 }});
  // x x' = t - 1: x^2 = (t - 1)^2 + c; for c = 0 another one is |t - 1|.
  all.push_back(
      {"x x' = t - 1",
       equations_of(
           1, 1, [](const auto& t, const auto* x, const auto* xdot, auto* F) { F[0] = x[0] * xdot[0] - (t - 1.0); }),
       0.0, 2.0, 1.0, SFDAE_PART_DIFFERENTIAL, [](double t) { return std::vector{1.0 - t}; }});
  // All solutions meet at t = 1; one of them goes on without a kink.
  all.push_back({"t x' = x",
                 equations_of(2, 2,
                              [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                F[0] = (t - 1.0) * xdot[0] - x[0] * (1.0 + (t - 1.0) * x[1]);
                                F[1] = xdot[1] + x[1];
                              }),
                 0.0, 2.0, 1.0, SFDAE_PART_UNDETERMINED, [](double t) {
                   return std::vector{(1.0 - t) * std::exp(-std::exp(-t)), std::exp(-t)};
                 }});
  return all;
}

TEST(Branches, AreFollowedSmoothly) {
  for (const Smooth& problem : smooth_solutions())
    for (const int method : methods)
      for (const double tolerance : tolerances) {
        SCOPED_TRACE(testing::Message() << problem.name << ", method " << method << ", tolerance " << tolerance);
        NonlinearRun run(problem.equations, options_with(tolerance, method));
        ASSERT_EQ(run.start(problem.start, problem.end, problem.solution(problem.start)), SFDAE_OK) << run.message();
        ASSERT_EQ(sfdae_pass_singular_points(run.solver(), 1), SFDAE_OK);
        // Outputs on the way, some of them beside the point and at it.
        for (const double tout : {0.5 * problem.at, problem.at - 1e-5, problem.at, problem.at + 0.01, problem.end}) {
          ASSERT_EQ(run.advance(tout), SFDAE_OK) << run.message();
          const std::vector<double> exact = problem.solution(tout);
          for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(run.x[i], exact[i], 300.0 * tolerance) << tout;
        }
        const sfdae_singular_point point = point_of(run);
        EXPECT_EQ(point.count, 1);
        EXPECT_EQ(point.passed, 1);
        EXPECT_EQ(point.kind, SFDAE_SINGULAR_CROSSING);
        EXPECT_NEAR(point.t, problem.at, 100.0 * tolerance);
        EXPECT_LE(point.t_before, point.t_after);
        EXPECT_GT(point.t_after, problem.at);
        if (problem.part != SFDAE_PART_UNDETERMINED && point.part != SFDAE_PART_UNDETERMINED) {
          EXPECT_EQ(point.part, problem.part);
        }
      }
}

TEST(Branches, AreNotFollowedUnlessAskedFor) {
  for (const Smooth& problem : smooth_solutions())
    for (const int method : methods) {
      SCOPED_TRACE(testing::Message() << problem.name << ", method " << method);
      NonlinearRun run(problem.equations, options_with(1e-6, method));
      ASSERT_EQ(run.start(problem.start, problem.end, problem.solution(problem.start)), SFDAE_OK) << run.message();
      EXPECT_EQ(run.advance(problem.end), SFDAE_CHARACTERISTICS_CHANGED);
      EXPECT_NE(run.message().find("smooth"), std::string::npos) << run.message();
      const sfdae_singular_point point = point_of(run);
      EXPECT_EQ(point.passed, 0);
      EXPECT_EQ(point.count, 0);
      EXPECT_NE(point.kind, SFDAE_SINGULAR_FOLD);
      EXPECT_NE(point.kind, SFDAE_SINGULAR_UNBOUNDED);
    }
}

struct Ending {
  const char* name;
  NonlinearEquations equations;
  double end;
  int component;
  std::vector<double> start;
};

std::vector<Ending> endings() {
  std::vector<Ending> all;
  all.push_back({"y^2 = 1 - t",
                 equations_of(2, 2,
                              [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                F[0] = xdot[0] + 1.0;
                                F[1] = x[1] * x[1] - x[0];
                              }),
                 2.0,
                 1,
                 {1.0, 1.0}});
  all.push_back(
      {"x x' = -1/2",
       equations_of(1, 1, [](const auto&, const auto* x, const auto* xdot, auto* F) { F[0] = x[0] * xdot[0] + 0.5; }),
       2.0,
       0,
       {1.0}});
  // In one of many unknowns, with a smooth one beside it: y = 2 + sqrt(1 - t).
  all.push_back({"beside others",
                 equations_of(3, 3,
                              [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                using std::cos;
                                F[0] = xdot[0] - x[1] + x[2] * 0.1;
                                F[1] = (x[1] - 2.0) * (x[1] - 2.0) - (1.0 - t);
                                F[2] = x[2] - 1.0 * cos(t) * x[0];
                              }),
                 2.0,
                 1,
                 {1.0, 3.0, 1.0}});
  return all;
}

TEST(Branches, EndAtFolds) {
  for (const Ending& problem : endings())
    for (const int method : methods)
      for (const double tolerance : tolerances)
        for (const int passes : {0, 5}) {
          SCOPED_TRACE(testing::Message() << problem.name << ", method " << method << ", tolerance " << tolerance);
          NonlinearRun run(problem.equations, options_with(tolerance, method));
          ASSERT_EQ(run.start(0.0, problem.end, problem.start), SFDAE_OK) << run.message();
          sfdae_pass_singular_points(run.solver(), passes);
          ASSERT_EQ(run.advance(problem.end), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
          EXPECT_NEAR(run.t, 1.0, 100.0 * tolerance);
          const sfdae_singular_point point = point_of(run);
          EXPECT_EQ(point.kind, SFDAE_SINGULAR_FOLD) << run.message();
          EXPECT_EQ(point.component, problem.component);
          EXPECT_NEAR(point.exponent, 0.5, 0.15);
          EXPECT_EQ(point.count, 0);
          EXPECT_NE(run.message().find("fold"), std::string::npos) << run.message();
          EXPECT_EQ(run.message().find("not passed") != std::string::npos, passes > 0) << run.message();
        }
}

// y = x before t = 1; after it, y is not determined: u = 1 instead of a = 2.
TEST(Branches, EndWhereOtherValuesHoldBeyond) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    const auto left = 1.0 - t + abs(1.0 - t);
    F[0] = xdot[0] - 1.0;
    F[1] = left * left * (x[1] - x[0]);
  });
  for (const int method : methods) {
    NonlinearRun run(equations, options_with(1e-6, method));
    ASSERT_EQ(run.start(0.0, 2.0, {0.0, 0.0}), SFDAE_OK) << run.message();
    sfdae_pass_singular_points(run.solver(), 5);
    EXPECT_LT(run.advance(2.0), 0) << run.message();
    EXPECT_LE(run.t, 1.0 + 1e-3);
  }
}

TEST(Branches, AreCounted) {
  const Smooth circle = smooth_solutions().front();
  NonlinearRun run(circle.equations, options_with(1e-7));
  ASSERT_EQ(run.start(0.0, 20.0, {0.0, 1.0}), SFDAE_OK);
  sfdae_pass_singular_points(run.solver(), 3);
  EXPECT_EQ(run.advance(20.0), SFDAE_CHARACTERISTICS_CHANGED) << run.message();
  EXPECT_NEAR(run.t, 3.5 * std::acos(-1.0), 1e-3);
  EXPECT_EQ(point_of(run).count, 3);
  // More of them may be passed from here on.
  sfdae_pass_singular_points(run.solver(), 10);
  EXPECT_EQ(run.advance(20.0), SFDAE_OK) << run.message();
  EXPECT_EQ(point_of(run).count, 6);
  EXPECT_NEAR(run.x[0], std::sin(20.0), 1e-3);
  EXPECT_NEAR(run.x[1], std::cos(20.0), 1e-3);
}

TEST(Branches, OfRandomSystemsAreTheRightOnes) {
  const char* wanted = std::getenv("SFDAE_SINGULAR_SYSTEMS");
  const unsigned systems = wanted != nullptr ? static_cast<unsigned>(std::atoi(wanted)) : 6;
  int runs = 0, passed = 0, silent = 0, wrong = 0;
  for (unsigned seed = 0; seed < systems; ++seed) {
    const SingularSystem system(seed, true);
    const auto equations = equations_of(
        system.n(), system.n(),
        [&system](const auto& t, const auto* x, const auto* xdot, auto* F) { system.residual(t, x, xdot, F); });
    for (const int method : methods)
      for (const double tolerance : {1e-4, 1e-8}) {
        sfdae_options options = options_with(tolerance, method);
        options.max_steps = 3000;
        NonlinearRun run(equations, options);
        if (run.created < 0 || run.start(system.start(), system.end(), system.exact(system.start())) < 0) continue;
        ++runs;
        sfdae_pass_singular_points(run.solver(), 10);
        if (run.advance(system.end()) != SFDAE_OK) continue;
        sfdae_singular_point point;
        sfdae_singular_point_init(&point, sizeof point);
        ++(sfdae_get_singular_point(run.solver(), &point) == SFDAE_OK && point.count > 0 ? passed : silent);
        const std::vector<double> exact = system.exact(system.end());
        double error = 0.0;
        for (std::size_t i = 0; i < exact.size(); ++i)
          error = std::max(error, std::fabs(run.x[i] - exact[i]) / std::max(1.0, std::fabs(exact[i])));
        if (error <= 3e3 * tolerance) continue;
        ++wrong;
        std::printf("seed %u, kind %d, mu %d, method %d, tolerance %.0e: error %.1e\n", seed,
                    static_cast<int>(system.kind()), system.mu(), method, tolerance, error);
      }
  }
  std::printf("%d runs: %d passed, %d came through without, %d wrong\n", runs, passed, silent, wrong);
  EXPECT_LE(wrong, runs / 500);
  EXPECT_GE(passed + silent, runs / 4);
}

}  // namespace
