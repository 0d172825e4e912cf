// SPDX-License-Identifier: BSD-3-Clause
// Singular points of the system Jacobian between steps of the minimal extension are named, and none where there is
// none.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "checkpoint_of.h"
#include "nonlinear_run.h"
#include "singular_system.h"

namespace sfdae_test {

namespace {

sfdae_options required(int method, double tolerance) {
  sfdae_options options = options_with(tolerance, method);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  options.max_steps = 5000;
  return options;
}

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
constexpr double tolerances[] = {1e-3, 1e-6, 1e-9};

// From t = 0: at the time given, to a hundred tolerances; the point returned lies before it.
void expect_named(const NonlinearEquations& equations, double end, const std::vector<double>& guess, double time) {
  for (const int method : methods)
    for (const double tolerance : tolerances) {
      NonlinearRun run(equations, required(method, tolerance));
      const int status = run.integrate(0.0, end, guess);
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance << ": "
                                      << status_text(run, status));
      EXPECT_EQ(status, SFDAE_CHARACTERISTICS_CHANGED);
      EXPECT_NE(run.message().find("of the system Jacobian"), std::string::npos);
      // Whether the whole array would help is not known, and none of its rows were left out.
      EXPECT_NE(run.message().find("If structure alone misleads"), std::string::npos);
      sfdae_change change;
      sfdae_change_init(&change, sizeof change);
      ASSERT_EQ(sfdae_get_change(run.solver(), &change), SFDAE_OK);
      EXPECT_NEAR(change.t, time, 100.0 * tolerance + 1e-6);
      EXPECT_NEAR(run.t, change.t, 1e-4);
      EXPECT_LE(run.t, change.t);
    }
}

// (t - 0.5)^power (y - sin t) = 0 beside x' = y - x^2.
NonlinearEquations factor_of_constraint(int power) {
  return equations_of(2, 2, [power](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] + x[0] * x[0] - x[1];
    F[1] = x[1] - sin(t);
    for (int k = 0; k < power; ++k) F[1] = (t - 0.5) * F[1];
  });
}

}  // namespace

// x = sin t, y = cos t up to pi/2, where x = 1, y = 0 is another solution.
TEST(ExtensionSingularPoints, OfTheCircleAreNamed) {
  const auto circle = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[1];
    F[1] = x[0] * x[0] + x[1] * x[1] - 1.0;
  });
  expect_named(circle, 3.0, {0.0, 1.0}, 0.5 * std::acos(-1.0));
}

TEST(ExtensionSingularPoints, OfFactorsAreNamed) {
  expect_named(factor_of_constraint(1), 1.0, {0.0, 0.0}, 0.5);
  expect_named(factor_of_constraint(2), 1.0, {0.0, 0.0}, 0.5);
  expect_named(factor_of_constraint(3), 1.0, {0.0, 0.0}, 0.5);
}

// The sign of the determinant of all blocks together stays.
TEST(ExtensionSingularPoints, OfTwoBlocksAtOnceAreNamed) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] + x[0] * x[0] - x[1];
    F[1] = (t - 0.5) * (x[1] - sin(t));
    F[2] = (t - 0.5) * (x[2] - x[0] * x[1]);
  });
  expect_named(equations, 1.0, {0.0, 0.0, 0.0}, 0.5);
}

TEST(ExtensionSingularPoints, OfBlocksOfSeveralEquationsAreNamed) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin, std::cos;
    F[0] = xdot[0] + x[0] * x[0] - x[1];
    F[1] = (x[1] - sin(t)) + (t + 0.5) * (x[2] - cos(t));
    F[2] = (t + 0.5) * (x[1] - sin(t)) + (x[2] - cos(t));
  });
  expect_named(equations, 1.0, {0.0, 0.0, 1.0}, 0.5);
}

// x_3 = sin t + (x_1'' - x_1') / (t - 0.5) is infinite there; without differential equations one step would go to the
// end.
TEST(ExtensionSingularPoints, OfProblemsWithoutStatesAreNamed) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] - (t - 0.5) * (x[2] - sin(t)) - x[1];
    F[2] = x[0] - 0.5 * sin(t);
  });
  expect_named(equations, 1.0, {0.0, 0.5, 0.0}, 0.5);
}

TEST(ExtensionSingularPoints, WhereSolutionsEndAreNamed) {
  const auto equations = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 1.0;
    F[1] = x[1] * x[1] - x[0];
  });
  expect_named(equations, 2.0, {1.0, 1.0}, 1.0);
}

// The coefficient jumps from 1 to -2 where x does not care, or comes near zero.
TEST(ExtensionSingularPoints, AreNotWhereDeterminantsJumpOrStayAwayFromZero) {
  const auto jump = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin, sfdae::choose;
    F[0] = xdot[0] + x[0] * x[0] - x[1];
    F[1] = choose(x[1] < 0.479, Expression(1.0), Expression(-2.0)) * (x[1] - sin(t));
  });
  const auto near = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] + x[0] * x[0] - x[1];
    F[1] = ((t - 0.5) * (t - 0.5) + 1e-6) * (x[1] - sin(t));
  });
  for (const auto& equations : {jump, near})
    for (const int method : methods)
      for (const double tolerance : tolerances) {
        NonlinearRun run(equations, required(method, tolerance));
        const int status = run.integrate(0.0, 1.0, {0.0, 0.0});
        EXPECT_EQ(status, SFDAE_OK) << status_text(run, status);
        EXPECT_NEAR(run.x[1], std::sin(1.0), 10.0 * tolerance);
      }
}

// Determinants that touch zero without changing their sign, at whatever points steps end.
TEST(ExtensionSingularPoints, ThatTouchZeroAreNamedAsARule) {
  int named = 0, passed = 0;
  for (unsigned seed = 1; seed < 1200; ++seed) {
    const SingularSystem system(seed, true);
    if (system.kind() != Singularity::square) continue;
    const auto equations = equations_of(
        system.n(), system.n(),
        [&system](const auto& t, const auto* x, const auto* xdot, auto* F) { system.residual(t, x, xdot, F); });
    for (const int method : methods)
      for (const double tolerance : tolerances) {
        NonlinearRun run(equations, required(method, tolerance));
        const int status = run.integrate(system.start(), system.end(), system.exact(system.start()));
        if (status == SFDAE_CHARACTERISTICS_CHANGED) ++named;
        if (status == SFDAE_OK) ++passed;
      }
  }
  EXPECT_GT(named, 150);
  EXPECT_LE(passed, named / 20);  // 9 of 214
}

// The watch goes on as well.
TEST(ExtensionSingularPoints, AreNamedInTheSameBitsAfterCheckpoints) {
  for (const int method : methods)
    for (const double t : {0.1, 0.3, 0.45}) {
      NonlinearRun first(factor_of_constraint(2), required(method, 1e-6)),
          second(factor_of_constraint(2), required(method, 1e-6));
      ASSERT_EQ(first.integrate(0.0, t, {0.0, 0.0}), SFDAE_OK);
      const std::vector<double> checkpoint = checkpoint_of(first.solver());
      ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
          << second.message();
      second.x.resize(2);
      EXPECT_EQ(first.advance(1.0), SFDAE_CHARACTERISTICS_CHANGED) << t;
      EXPECT_EQ(second.advance(1.0), SFDAE_CHARACTERISTICS_CHANGED) << t;
      EXPECT_EQ(first.t, second.t);
      EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), 2 * sizeof(double)), 0);
    }
}

// Entries of the system Jacobian are numbers, and blocks are judged once; of one unknown, and of so many that they
// are sparse. x_i = p x_(i + 1) for unknowns in a circle.
TEST(ExtensionSingularPoints, OfConstantBlocksAreFoundWhenParametersChange) {
  for (const int count : {1, 130}) {
    const NonlinearEquations circle{
        count + 1, count + 1,
        [count](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
          const Expression p = sfdae::parameter(t, "p", 0.5);
          F[0] = xdot[0] + x[0] * x[1];
          for (int i = 1; i <= count; ++i) F[i] = x[i] - p * x[i % count + 1] - sin(t);
        }};
    for (const int method : methods) {
      NonlinearRun run(circle, required(method, 1e-6));
      std::vector<double> guess(static_cast<std::size_t>(count) + 1, 0.0);
      guess[0] = 1.0;
      for (const double p : {0.5, 1.0, 0.25, 1.0}) {
        SCOPED_TRACE(testing::Message() << count << " unknowns, method " << method << ", p = " << p);
        ASSERT_EQ(sfdae_set_parameter(run.solver(), "p", p), SFDAE_OK);
        const int status = run.integrate(0.0, 1.0, guess);
        if (p == 1.0) {
          EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES)
              << status_text(run, status);
          continue;
        }
        ASSERT_EQ(status, SFDAE_OK) << status_text(run, status);
        EXPECT_NEAR(run.x[1], std::sin(1.0) / (1.0 - p), 1e-8);
        EXPECT_NEAR(run.x[0], std::exp((std::cos(1.0) - 1.0) / (1.0 - p)), 1e-5);
      }
    }
  }
}

// Values given that are consistent are not searched for, and singular equations are named none the less.
TEST(ExtensionSingularPoints, AtConsistentStartsAreNamed) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] - x[1];
    F[1] = x[1] * x[1] - t * x[0];
  });
  for (const int method : methods) {
    NonlinearRun run(equations, required(method, 1e-6));
    const int status = run.integrate(0.0, 1.0, {1.0, 0.0});
    EXPECT_TRUE(status == SFDAE_RANK_UNCLEAR || status == SFDAE_NO_CONSISTENT_VALUES) << status_text(run, status);
  }
}

}  // namespace sfdae_test
