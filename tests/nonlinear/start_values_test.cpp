// SPDX-License-Identifier: BSD-3-Clause
// Start values of nonlinear problems: what is differentiated stays, x' may be guessed, guesses may be poor.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "nonlinear_run.h"
#include "test_set/pendulum.h"

namespace {

using namespace sfdae_test;

constexpr double g = Pendulum::gravity;

NonlinearEquations pendulum_equations() {
  return equations_of(
      5, 5, [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); });
}

// Angle from the vertical below, and speed.
std::vector<double> pendulum_at(double angle, double speed) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {s, -c, speed * c, speed * s, speed * speed + g * c};
}

sfdae_options options_with_guessed_slopes() {
  sfdae_options options = default_options();
  options.xdot_is_guess = 1;
  return options;
}

NonlinearEquations square_of_slope() {
  return equations_of(1, 1,
                      [](const auto&, const auto*, const auto* xdot, auto* F) { F[0] = xdot[0] * xdot[0] - 1.0; });
}

// Kvaerno: (t^4 e^-t, (4 - t) t^3 e^-t) solves it, and y2' has either sign as far as the equations are concerned.
NonlinearEquations kvaerno() {
  return equations_of(2, 2, [](const auto& t, const auto* y, const auto* ydot, auto* F) {
    const auto s = sin(ydot[0]), c = cos(y[1]), decay = exp(-t), sum = y[0] + y[1];
    F[0] = (s * s + c * c) * ydot[1] * ydot[1] - (t - 6.0) * (t - 6.0) * (t - 2.0) * (t - 2.0) * y[0] * decay;
    F[1] = (4.0 - t) * sum * sum * sum - 64.0 * t * t * decay * y[0] * y[1];
  });
}

std::vector<double> kvaerno_at(double t) {
  return {std::pow(t, 4) * std::exp(-t), (4.0 - t) * std::pow(t, 3) * std::exp(-t)};
}

std::vector<double> kvaerno_slope_at(double t) {
  return {(4.0 - t) * std::pow(t, 3) * std::exp(-t), t * t * (t - 2.0) * (t - 6.0) * std::exp(-t)};
}

}  // namespace

// Positions and velocities exact, force unknown, at no symmetric position: they do not change, and nothing is said.
TEST(StartValues, KeepPositionsAndVelocitiesWhereTheForceIsUnknown) {
  for (const double angle : {0.6435, 0.1, -1.3, 2.0, 3.0})
    for (const double speed : {0.0, 0.7, -3.0})
      for (const double force : {0.0, -50.0, 1e4}) {
        SCOPED_TRACE(testing::Message() << "angle " << angle << ", speed " << speed << ", force " << force);
        const std::vector<double> exact = pendulum_at(angle, speed);
        std::vector<double> guess = exact;
        guess[4] = force;
        NonlinearRun run(pendulum_equations(), default_options());
        ASSERT_EQ(run.start(0.0, 1.0, guess), SFDAE_OK) << run.message();
        EXPECT_EQ(run.message(), "");
        EXPECT_LE(distance(run.x, exact), 100.0 * rounding(5) * std::max(1.0, std::fabs(exact[4])));
        EXPECT_NEAR(run.xdot[0], exact[2], 1e-13);
        EXPECT_NEAR(run.xdot[3], -2.0 * 0.0 - exact[4] * exact[1] - g, 1e-11);
      }
}

// A velocity that is reversed and halved fits the constraints: it stays when the integration goes on from there.
TEST(StartValues, ImpactsAreNotUndone) {
  NonlinearRun run(pendulum_equations(), default_options());
  ASSERT_EQ(run.start(0.0, 1.0, pendulum_at(0.3, 1.0)), SFDAE_OK);
  ASSERT_EQ(run.advance(0.4), SFDAE_OK) << run.message();
  std::vector<double> after = run.x;
  after[2] *= -0.5;
  after[3] *= -0.5;
  const double speed_squared = after[2] * after[2] + after[3] * after[3];
  ASSERT_EQ(run.start(0.4, 1.0, after), SFDAE_OK) << run.message();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.x[i], after[i], 10.0 * rounding(5)) << i;
  EXPECT_NEAR(run.x[4], speed_squared - g * after[1], 100.0 * rounding(5));
}

// Off by 30 % in the directions normal to |p| = 1 and p v = 0, which are (p, 0) and (v, p): with equal tolerances the
// exact values are the nearest ones, and the force, given as 0, follows.
TEST(StartValues, MoveNoFartherThanTheConstraints) {
  sfdae_options options = default_options();
  options.rtol = 1e-12;
  options.atol = 1e-6;
  for (const double amount : {0.3, 0.01}) {
    NonlinearRun run(pendulum_equations(), options);
    const std::vector<double> exact = pendulum_at(0.6435, 0.7);
    std::vector<double> guess = exact;
    for (std::size_t i : {0u, 1u}) {
      guess[i] += amount * (exact[i] + exact[i + 2]);
      guess[i + 2] += amount * exact[i];
    }
    guess[4] = 0.0;
    ASSERT_EQ(run.start(0.0, 1.0, guess), SFDAE_VALUES_CHANGED) << run.message();
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.x[i], exact[i], 1e-6) << i;
    EXPECT_NEAR(run.x[4], exact[4], 1e-5);
    EXPECT_NE(run.message().find("x[0] changed from "), std::string::npos) << run.message();
    EXPECT_LE(run.initial_report().residual_after, 1e-12);
  }
}

TEST(StartValues, FollowTheGuessOfTheSlope) {
  for (const double guess : {1.0, -1.0, 0.4, -3.0}) {
    NonlinearRun run(square_of_slope(), options_with_guessed_slopes());
    run.xdot = {guess};
    ASSERT_EQ(run.start(0.0, 2.0, {0.5}), SFDAE_OK) << run.message();
    const double slope = guess > 0.0 ? 1.0 : -1.0;
    EXPECT_NEAR(run.xdot[0], slope, rounding(10));
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.x[0], 0.5 + 2.0 * slope, 1e-5);
    // The other branch from the same point, with the analysis that is there.
    run.xdot = {-guess};
    ASSERT_EQ(run.start(0.0, 2.0, {0.5}), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.xdot[0], -slope, rounding(10));
    ASSERT_EQ(run.advance(2.0), SFDAE_OK) << run.message();
    EXPECT_NEAR(run.x[0], 0.5 - 2.0 * slope, 1e-5);
  }
}

TEST(StartValues, GuessesOfTheSlopeThatAreNoNumbersAreRefused) {
  NonlinearRun run(square_of_slope(), options_with_guessed_slopes());
  run.xdot = {NAN};
  EXPECT_EQ(run.start(0.0, 2.0, {0.5}), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(run.message().find("xdot"), std::string::npos);
  NonlinearRun without(square_of_slope(), default_options());
  without.xdot = {NAN};
  EXPECT_NE(without.start(0.0, 2.0, {0.5}), SFDAE_ILLEGAL_ARGUMENT);
}

// Only v_y = -0.15 is missing besides the force: at x = 0 no other change fulfils the derivative of the constraint.
TEST(StartValues, AreNotLedAstrayByZerosAndLooseTolerances) {
  for (const double tol : {1e-2, 1e-6}) {
    sfdae_options options = default_options();
    options.rtol = options.atol = tol;
    NonlinearRun run(equations_of(5, 5,
                                  [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                    const auto a = x[0] - sin(3.0 * t);
                                    F[0] = xdot[0] - x[2];
                                    F[1] = xdot[1] - x[3];
                                    F[2] = xdot[2] + x[4] * a;
                                    F[3] = xdot[3] + x[4] * x[1] + 9.81;
                                    F[4] = a * a + x[1] * x[1] - 1.0 - 0.3 * sin(t);
                                  }),
                     options);
    ASSERT_EQ(run.start(0.0, 3.0, {0.0, -1.0, 3.0, 0.0, 0.0}), SFDAE_VALUES_CHANGED) << run.message();
    EXPECT_NEAR(run.x[3], -0.15, 1e-6);
    for (const double change : {run.x[0], run.x[1] + 1.0, run.x[2] - 3.0}) EXPECT_NEAR(change, 0.0, 1e-6);
  }
}

// However large other values are that were given.
TEST(StartValues, SayThatWhatIsDifferentiatedChanged) {
  const auto equations = equations_of(3, 3, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] + x[1];
    F[2] = x[0] - sin(t);
  });
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
    for (const double given : {1.0, 1e8, 1e14}) {
      SCOPED_TRACE(testing::Message() << "structure " << structure << ", " << given << " given");
      sfdae_options options = default_options();
      options.structure = structure;
      NonlinearRun run(equations, options);
      EXPECT_EQ(run.start(0.0, 1.0, {0.5, 1.0, given}), SFDAE_VALUES_CHANGED) << run.message();
      EXPECT_NE(run.message().find("x[0] changed from 0.5"), std::string::npos) << run.message();
      EXPECT_NEAR(run.x[1], 1.0, 1e-8);
    }
}

TEST(StartValues, ReachTheBranchOfKvaernosProblem) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tol : {1e-4, 1e-8}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tol);
      sfdae_options options = options_with_guessed_slopes();
      options.method = method;
      options.rtol = options.atol = tol;
      NonlinearRun run(kvaerno(), options);
      run.xdot = kvaerno_slope_at(0.5);
      ASSERT_EQ(run.start(0.5, 1.0, kvaerno_at(0.5)), SFDAE_OK) << run.message();
      EXPECT_LE(distance(run.x, kvaerno_at(0.5)), 1e-13);
      EXPECT_LE(distance(run.xdot, kvaerno_slope_at(0.5)), 1e-10);
      ASSERT_EQ(run.advance(1.0), SFDAE_OK) << run.message();
      const std::vector<double> exact = kvaerno_at(1.0);
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_LE(std::fabs(run.x[i] - exact[i]), 10.0 * tol * (1.0 + exact[i])) << i;
    }
}

// A chain of n diodes behind resistors; voltages of up to 15 V are guessed where one diode takes 26 mV for a factor e.
TEST(StartValues, FindDiodesFromPoorGuesses) {
  for (const int n : {1, 2, 4}) {
    const auto equations = equations_of(1 + n, 1 + n, [n](const auto& t, const auto* x, const auto* xdot, auto* F) {
      const double thermal_voltage = 0.026, saturation = 1e-12;
      F[0] = xdot[0] + x[0] - 5.0 * cos(t);
      for (int k = 1; k <= n; ++k) {
        F[k] = (x[0] - x[k]) / (10.0 * k) - saturation * (exp(x[k] / thermal_voltage) - 1.0);
        if (k > 1) F[k] = F[k] - saturation * (exp((x[k] - x[k - 1]) / thermal_voltage) - 1.0);
      }
    });
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
      for (const double voltage : {0.5, 5.0, 15.0}) {
        SCOPED_TRACE(testing::Message() << n << " diodes, " << voltage << " V, seed " << seed);
        std::vector<double> guess = random_vector(1 + n, seed);
        for (double& v : guess) v *= voltage;
        guess[0] = 5.0;
        NonlinearRun run(equations, default_options());
        const int status = run.start(0.0, 1.0, guess);
        if (status == SFDAE_NOT_FINITE) {  // exp(710) overflows at the guess already, which is said
          EXPECT_NE(run.message().find("exp of "), std::string::npos) << run.message();
          EXPECT_EQ(voltage, 15.0);
          continue;
        }
        ASSERT_EQ(status, SFDAE_OK) << run.message();
        EXPECT_NEAR(run.x[0], 5.0, 1e-14);
        double current = (5.0 - run.x[1]) / 10.0;
        EXPECT_NEAR(1e-12 * (std::exp(run.x[1] / 0.026) - 1.0) / current, 1.0, 1e-9);
      }
  }
}

// Newton's steps lead to logarithms and roots of negative numbers: they are shortened.
TEST(StartValues, StayWhereTheEquationsAreDefined) {
  for (const double guess : {1e-3, 0.5, 5.0, 50.0}) {
    SCOPED_TRACE(guess);
    NonlinearRun run(equations_of(3, 3,
                                  [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                    F[0] = xdot[0] + x[0] * x[2];
                                    F[1] = sqrt(x[1]) - x[0];
                                    F[2] = sqrt(x[2] - x[1]) + exp(x[2]) - 5.0 - x[0];
                                  }),
                     default_options());
    ASSERT_EQ(run.start(0.0, 1.0, {0.1, guess, guess + 0.5}), SFDAE_OK) << run.message();
    EXPECT_EQ(run.x[0], 0.1);
    EXPECT_NEAR(run.x[1], 0.01, 1e-14);
    EXPECT_NEAR(std::sqrt(run.x[2] - run.x[1]) + std::exp(run.x[2]), 5.1, 1e-12);
  }
  for (const double guess : {1e-3, 1e3, 1e6})
    for (const double logarithm : {-3.0, 0.0, 3.0}) {
      NonlinearRun run(equations_of(2, 2,
                                    [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                      F[0] = xdot[0] + x[0];
                                      F[1] = log(x[1]) - x[0];
                                    }),
                       default_options());
      ASSERT_EQ(run.start(0.0, 1.0, {logarithm, guess}), SFDAE_OK) << run.message();
      EXPECT_NEAR(run.x[1] / std::exp(logarithm), 1.0, 1e-12);
    }
}

// exp(40 x2) + 1 = 0 has no solution; at the guess it is 1e173.
TEST(StartValues, MessagesHaveNoAbsurdResiduals) {
  NonlinearRun run(equations_of(2, 2,
                                [](const auto&, const auto* x, const auto* xdot, auto* F) {
                                  F[0] = xdot[0] + x[0];
                                  F[1] = exp(40.0 * x[1]) + 1.0 + x[0] * x[0];
                                }),
                   default_options());
  EXPECT_LT(run.start(0.0, 1.0, {1.0, 10.0}), 0);
  const std::string text = run.message();
  for (std::size_t e = text.find("e+"); e != std::string::npos; e = text.find("e+", e + 2))
    EXPECT_LE(std::stoi(text.substr(e + 2)), 6) << text;
}

// A formula that is not defined beside t0 = 0: the analysis looks there, and says that the point is its own.
TEST(StartValues, MessagesTellInternalPointsFromTimesGiven) {
  NonlinearRun run(equations_of(2, 2,
                                [](const auto& t, const auto* x, const auto* xdot, auto* F) {
                                  F[0] = xdot[0] + x[0];
                                  F[1] = x[1] * x[1] * x[1] + x[1] - sqrt(1e-9 - t);
                                }),
                   default_options());
  EXPECT_EQ(run.start(0.0, 1.0, {1.0, 0.0}), SFDAE_NOT_FINITE);
  EXPECT_NE(run.message().find("at the internal point t = "), std::string::npos) << run.message();
  EXPECT_NE(run.message().find(", beside t0 = 0: "), std::string::npos) << run.message();
}
