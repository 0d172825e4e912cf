// SPDX-License-Identifier: BSD-3-Clause
// Singular points of nonlinear systems: named where they are, and none where there is none.
//
// SFDAE_SINGULAR_SYSTEMS: how many random systems of either kind (default: a few; a campaign has 2000).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "family_run.h"
#include "nonlinear_run.h"
#include "singular_system.h"

namespace {

using namespace sfdae_test;

unsigned count_of_systems(int usual) {
  const char* wanted = std::getenv("SFDAE_SINGULAR_SYSTEMS");
  return static_cast<unsigned>(wanted != nullptr ? std::atoi(wanted) : sfdae_test::scaled_count(usual, usual / 4));
}

struct SingularOutcome {
  int started = 0, status = 0;
  bool has_change = false;
  double t = 0.0, named = 0.0;
  std::vector<double> x;
  std::string text;
};

template <class Run>
SingularOutcome outcome_of(Run& run, double start, double end, const std::vector<double>& guess) {
  SingularOutcome outcome;
  outcome.started = run.created < 0 ? run.created : run.start(start, end, guess);
  outcome.status = outcome.started < 0 ? outcome.started : run.advance(end);
  outcome.t = run.t;
  outcome.x = run.x;
  outcome.text = status_text(run, outcome.status);
  sfdae_change change;
  sfdae_change_init(&change, sizeof change);
  outcome.has_change = outcome.started >= 0 && sfdae_get_change(run.solver(), &change) == 0;
  outcome.named = change.t;
  return outcome;
}

SingularOutcome run_equations(const NonlinearEquations& equations, int method, double tolerance, double start,
                              double end, const std::vector<double>& guess, int most_steps = 2000) {
  sfdae_options options = options_with(tolerance, method);
  options.max_steps = most_steps;
  NonlinearRun run(equations, options);
  return outcome_of(run, start, end, guess);
}

constexpr int both_methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
constexpr double run_tolerances[] = {1e-3, 1e-5, 1e-8};

// Expected at the time given, to a hundred tolerances; the point returned lies just before what is named.
void expect_singular_point(const NonlinearEquations& equations, double end, const std::vector<double>& guess,
                           double time) {
  for (const int method : both_methods)
    for (const double tolerance : run_tolerances) {
      const SingularOutcome o = run_equations(equations, method, tolerance, 0.0, end, guess);
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance << ": " << o.text);
      EXPECT_EQ(o.status, SFDAE_CHARACTERISTICS_CHANGED);
      ASSERT_TRUE(o.has_change);
      EXPECT_NEAR(o.named, time, 100.0 * tolerance);
      EXPECT_NEAR(o.t, o.named, 1e-5);
      EXPECT_LE(o.t, o.named);
    }
}

// x = sin t, y = cos t up to pi/2, where y = 0 takes E T2 away and x = 1, y = 0 is another solution.
TEST(SingularPoints, OfTheCircleAreNamed) {
  const auto circle = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] * x[0] + x[1] * x[1] - 1.0;
  });
  expect_singular_point(circle, 3.0, {0.0, 1.0}, 0.5 * std::acos(-1.0));
}

// x' = y, y = cos t - x: x = (sin t + cos t - exp(-t)) / 2 passes 0.37.
double time_of_factor() {
  double low = 0.4, high = 0.6;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high);
    ((std::sin(t) + std::cos(t) - std::exp(-t)) / 2.0 < 0.37 ? low : high) = t;
  }
  return low;
}

TEST(SingularPoints, OfDifferentialEquationsThatVanishAreNamed) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::cos;
    F[0] = (x[0] - 0.37) * (xdot[0] - x[1]);
    F[1] = x[1] + x[0] - 1.0 * cos(t);
  });
  expect_singular_point(equations, 3.0, {0.0, 1.0}, time_of_factor());
}

TEST(SingularPoints, OfConstraintsThatVanishAreNamed) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::cos;
    F[0] = xdot[0] - x[1];
    F[1] = (x[0] - 0.37) * (x[1] + x[0] - 1.0 * cos(t));
  });
  expect_singular_point(equations, 3.0, {0.0, 1.0}, time_of_factor());
}

// y^2 = x = 1 - t ends at t = 1, where steps become small.
TEST(SingularPoints, WhereSolutionsEndAreNamed) {
  const auto equations = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 1.0;
    F[1] = x[1] * x[1] - x[0];
  });
  expect_singular_point(equations, 2.0, {1.0, 1.0}, 1.0);
}

// sin(x3) x1' = x2, x3' = 1, x1 = sin t: x2 is smooth and unique where sin x3 = 0, and mu = 1 holds there, too.
TEST(SingularPoints, ThatAreNoneForTheHypothesisArePassed) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = sin(x[2]) * xdot[0] - x[1];
    F[1] = x[0] - 1.0 * sin(t);
    F[2] = xdot[2] - 1.0;
  });
  for (const int method : both_methods)
    for (const double tolerance : run_tolerances) {
      const SingularOutcome o = run_equations(equations, method, tolerance, 0.0, 3.0, {0.0, -0.9, -1.0});
      EXPECT_EQ(o.status, SFDAE_OK) << o.text;
    }
}

// Not an alarm: x' = 1e3 (cos t - x) y with y > 0 that comes near 0, a multiplier that changes its sign, and an
// equation whose size grows by e^30.
TEST(SingularPoints, AreNotSeenInSmoothSystems) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::cos, std::exp;
    F[0] = exp(5.0 * t) * (xdot[0] - 1e3 * (cos(t) - x[0]) * x[1]);
    F[1] = x[1] * x[1] - (1.05 + cos(3.0 * t)) * (1.05 + cos(3.0 * t));
    F[2] = x[2] - x[0] * x[1];
  });
  for (const int method : both_methods)
    for (const double tolerance : run_tolerances) {
      const SingularOutcome o = run_equations(equations, method, tolerance, 0.0, 6.0, {1.0, 2.05, 2.05});
      EXPECT_EQ(o.status, SFDAE_OK) << o.text;
    }
}

// Van der Pol's equation with its acceleration as an unknown, and an algebraic unknown that varies as much with one
// that does not: f3 turns by 1e4 and more against z, whose unit has nothing to do with that. The system Jacobian is
// the same everywhere, or varies with z alone.
TEST(SingularPoints, AreNotSeenWhereUnknownsAreInOtherUnits) {
  for (const double part : {0.0, 0.3}) {
    const auto equations = equations_of(3, 3, [part](const auto& t, const auto* x, const auto* xdot, auto* F) {
      using std::cos;
      F[0] = xdot[0] - x[1];
      F[1] = xdot[1] - x[2];
      F[2] = (1.0 + part * cos(t)) * x[2] - 100.0 * (1.0 - x[0] * x[0]) * x[1] + x[0];
    });
    for (const int method : both_methods)
      for (const double tolerance : run_tolerances) {
        const SingularOutcome o = run_equations(equations, method, tolerance, 0.0, 200.0, {2.0, 0.0, -2.0}, 10000);
        EXPECT_EQ(o.status, SFDAE_OK) << part << ": " << o.text;
      }
  }
}

// ---- Random systems --------------------------------------------------------------------------------------------

NonlinearEquations recorded(const SingularSystem& system) {
  return equations_of(system.n(), system.n(), [&system](const auto& t, const auto* x, const auto* xdot, auto* F) {
    system.residual(t, x, xdot, F);
  });
}

struct SingularCounts {
  int all = 0, named = 0, near = 0, stopped = 0, passed = 0, wrong = 0;
};

// Relative to sizes, at least 1.
double largest_error(const std::vector<double>& x, const std::vector<double>& exact) {
  double error = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    error = std::max(error, std::fabs(x[i] - exact[i]) / std::max(1.0, std::fabs(exact[i])));
  return error;
}

SingularCounts integrate_all(unsigned systems, bool is_singular) {
  SingularCounts counts;
  const bool prints = std::getenv("SFDAE_SINGULAR_PRINT") != nullptr;
  for (unsigned seed = 0; seed < systems; ++seed) {
    const SingularSystem system(seed, is_singular);
    for (const int method : both_methods)
      for (const double tolerance : {1e-4, 1e-8}) {
        const SingularOutcome o = run_equations(recorded(system), method, tolerance, system.start(), system.end(),
                                                system.exact(system.start()));
        if (o.started < 0) continue;  // an analysis that says that it is not sure
        ++counts.all;
        const double distance = std::fabs(o.named - system.time()) / system.unit();
        if (o.has_change) ++counts.named;
        if (o.has_change && distance <= 1e-5 + 100.0 * tolerance) ++counts.near;
        if (!o.has_change && o.status < 0) ++counts.stopped;
        if (o.status == SFDAE_OK) ++counts.passed;
        if (o.status == SFDAE_OK && largest_error(o.x, system.exact(system.end())) > 1e3 * tolerance) ++counts.wrong;
        if (prints && (is_singular ? !o.has_change || distance > 1e-5 + 100.0 * tolerance : o.status != SFDAE_OK))
          std::printf("%d seed %u n %d mu %d kind %d method %d tol %.0e s %.5f (%.5f) distance %.1e: %s\n",
                      is_singular, seed, system.n(), system.mu(), static_cast<int>(system.kind()), method, tolerance,
                      (o.t - system.start()) / system.unit(), (system.time() - system.start()) / system.unit(),
                      distance, o.text.substr(0, 120).c_str());
      }
  }
  std::printf("%d runs: %d named, %d of them where it is; %d stopped otherwise, %d passed, %d of them wrong\n",
              counts.all, counts.named, counts.near, counts.stopped, counts.passed, counts.wrong);
  return counts;
}

// docs/design/singular_points.md has the shares of a large campaign.
TEST(RandomSingularPoints, AreNamed) {
  const SingularCounts counts = integrate_all(count_of_systems(80), true);
  EXPECT_GE(counts.named, 0.7 * counts.all);
  EXPECT_GE(counts.near, 0.8 * counts.named);
  // What only touches zero may be passed, on the solution chosen.
  EXPECT_LE(counts.passed, 0.08 * counts.all);
  EXPECT_EQ(counts.wrong, 0);
}

// At loose tolerances derivatives that are interpolated may be far from those of any solution, and extrapolated ones
// say nothing: what vanishes there does not at consistent values nearby.
TEST(RandomSingularPoints, AreNotSeenInInterpolatedDerivatives) {
  struct Run {
    unsigned seed;
    int method;
  };
  for (const Run& run : {Run{632, SFDAE_METHOD_RADAU}, Run{1015, SFDAE_METHOD_RADAU}, Run{1026, SFDAE_METHOD_RADAU},
                         Run{1033, SFDAE_METHOD_BDF}, Run{1355, SFDAE_METHOD_RADAU}, Run{1481, SFDAE_METHOD_BDF},
                         Run{1630, SFDAE_METHOD_BDF}}) {
    const SingularSystem system(run.seed, false);
    const SingularOutcome o =
        run_equations(recorded(system), run.method, 1e-4, system.start(), system.end(), system.exact(system.start()));
    EXPECT_GE(o.started, 0) << run.seed;
    EXPECT_FALSE(o.has_change) << run.seed << ": " << o.text;
  }
}

// At its output within a long step an iteration from the linearization there leads to derivatives of another solution.
TEST(RandomSingularPoints, OutputsKeepToTheirSolution) {
  const SingularSystem system(787, false);
  const SingularOutcome o = run_equations(recorded(system), SFDAE_METHOD_RADAU, 1e-8, system.start(), system.end(),
                                          system.exact(system.start()));
  ASSERT_EQ(o.status, SFDAE_OK) << o.text;
  EXPECT_LE(largest_error(o.x, system.exact(system.end())), 1e-7);
}

TEST(RandomSingularPoints, AreNotSeenWhereThereAreNone) {
  const SingularCounts counts = integrate_all(count_of_systems(160), false);
  // 2 of 3820 runs: systems whose integrations end with an error anyway. One of 160 may be.
  EXPECT_LE(counts.named, 0.002 * counts.all + 1.0);
  EXPECT_LE(counts.stopped, 0.02 * counts.all + 1.0);
  EXPECT_EQ(counts.wrong, 0);
}

}  // namespace
