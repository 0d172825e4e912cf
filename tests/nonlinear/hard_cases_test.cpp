// SPDX-License-Identifier: BSD-3-Clause
// Problems that end, jump, fail or scale badly: the right answer or an error that says what happened, and soon.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "matrix_checks.h"
#include "nonlinear_run.h"
#include "test_set/pendulum.h"

namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};

struct Span {
  double t0, tf;
};

// For all methods and the tolerances given: integrate, then check(run, status, tolerance). No success contains NaN.
template <class Check>
void for_all_methods(const NonlinearEquations& equations, Span span, const std::vector<double>& guess,
                     const std::vector<double>& tolerances, Check check) {
  for (const int method : methods)
    for (const double tolerance : tolerances) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance);
      NonlinearRun run(equations, options_with(tolerance, method));
      const int status = run.created < 0 ? run.created : run.integrate(span.t0, span.tf, guess);
      if (status < 0 && run.created == 0) {
        EXPECT_NE(run.message(), "");
      }
      if (status >= 0) {
        EXPECT_TRUE(std::isfinite(largest(run.x)));
      }
      SCOPED_TRACE(status_text(run, status));
      check(run, status, tolerance);
    }
}

// x = 1/(1 - t)
TEST(Ends, FiniteEscapeIsReportedWhereItIs) {
  const auto equations =
      equations_of(1, 1, [](const auto&, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] - x[0] * x[0]; });
  for_all_methods(equations, {0.0, 2.0}, {1.0}, {1e-2, 1e-4, 1e-7},
                  [](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_STEP_TOO_SMALL);
                    EXPECT_NEAR(run.t, 1.0, 10.0 * tol);
                  });
}

// x = (1 - t/2)^2 up to t = 2: the square root has no derivative there, and steps beyond have no value.
TEST(Ends, SquareRootsEndAtZero) {
  const auto equations =
      equations_of(1, 1, [](const auto&, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] + sqrt(x[0]); });
  for_all_methods(equations, {0.0, 3.0}, {1.0}, {1e-2, 1e-4, 1e-7},
                  [](const NonlinearRun& run, int status, double tol) {
                    // x is as small as the tolerance before, and 0 is the solution beyond: a step may land on it.
                    if (status < 0) {
                      EXPECT_EQ(status, SFDAE_NOT_FINITE);
                      EXPECT_NE(run.message().find("sqrt"), std::string::npos);
                      EXPECT_NEAR(run.t, 2.0, 0.3 + 4.0 * std::sqrt(tol));
                    }
                    EXPECT_NEAR(run.x[0], 0.0, tol);
                  });
}

// y^2 = x = 1 - t: the two roots meet at t = 1.
TEST(Ends, ImpasseIsReportedWhereItIs) {
  const auto equations = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 1.0;
    F[1] = x[1] * x[1] - x[0];
  });
  for_all_methods(equations, {0.0, 2.0}, {1.0, 1.0}, {1e-2, 1e-4, 1e-7},
                  [](const NonlinearRun& run, int status, double) {
                    EXPECT_TRUE(status == SFDAE_STEP_TOO_SMALL || status == SFDAE_CHARACTERISTICS_CHANGED);
                    EXPECT_NEAR(run.t, 1.0, 1e-4);
                  });
}

// x y' = y - 1 with x = cos t, y - 1 = 1/cos t + tan t, is an algebraic equation at pi/2, where y has a pole.
TEST(Ends, ChangesOfTheRankAreNotPassed) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::cos;
    F[0] = x[0] - cos(t);
    F[1] = x[0] * xdot[1] - x[1] + 1.0;
  });
  for_all_methods(equations, {0.0, 3.0}, {1.0, 2.0}, {1e-4, 1e-7}, [](const NonlinearRun& run, int status, double) {
    EXPECT_LT(status, 0);
    EXPECT_NEAR(run.t, 0.5 * std::acos(-1.0), 1e-3);
  });
}

// t x' = x is an algebraic equation at 0.
TEST(Ends, ExceptionalStartsAreNamed) {
  const auto equations =
      equations_of(1, 1, [](const auto& t, const auto* x, const auto* xdot, auto* F) { F[0] = xdot[0] * t - x[0]; });
  for_all_methods(equations, {0.0, 1.0}, {0.0}, {1e-4},
                  [](const NonlinearRun&, int status, double) { EXPECT_EQ(status, SFDAE_CHARACTERISTICS_CHANGED); });
}

NonlinearEquations logarithm() {
  return equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    F[0] = xdot[0] + x[0] - x[1] + 1.0;
    F[1] = log(x[1]) - sin(t);
  });
}

// Linear equations have no solution beyond t = 1, and say which one of them ends there.
TEST(Domains, OfLinearEquationsEndWhereTheirFormulasDo) {
  const auto equations = equations_of(2, 2, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    F[0] = x[1] - t * x[0];
    F[1] = xdot[0] - log(1.0 - t) * x[0];
  });
  for_all_methods(equations, {0.0, 2.0}, {1.0, 0.0}, {1e-6}, [](const NonlinearRun& run, int status, double) {
    EXPECT_EQ(status, SFDAE_NOT_FINITE);
    EXPECT_NEAR(run.t, 1.0, 1e-3);
    EXPECT_NE(run.message().find("log of"), std::string::npos) << run.message();
    EXPECT_NE(run.message().find("equation 1"), std::string::npos) << run.message();
  });
}

TEST(Domains, AreKeptFromGuessesFarAway) {
  for_all_methods(logarithm(), {0.0, 3.0}, {1.0, 20.0}, {1e-2, 1e-4, 1e-7},
                  [](const NonlinearRun& run, int status, double) {
                    EXPECT_EQ(status, SFDAE_OK);
                    EXPECT_NEAR(run.x[1], std::exp(std::sin(run.t)), 1e-12);
                  });
}

TEST(Domains, AreNamedWhereTheGuessIsOutside) {
  for_all_methods(logarithm(), {0.0, 3.0}, {1.0, -20.0}, {1e-4}, [](const NonlinearRun& run, int status, double) {
    EXPECT_EQ(status, SFDAE_NOT_FINITE);
    EXPECT_NE(run.message().find("log of -20 in equation 1"), std::string::npos);
  });
}

// x' = sign(sin 6t). (With Radau steps that see the same slope at all stages pass several switches.)
TEST(Jumps, AreFoundByBdf) {
  const auto equations = equations_of(1, 1, [](const auto& t, const auto*, const auto* xdot, auto* F) {
    F[0] = xdot[0] - choose(sin(6.0 * t), Expression(1.0), Expression(-1.0));
  });
  for (const double tolerance : {1e-2, 1e-4, 1e-7}) {
    NonlinearRun run(equations, options_with(tolerance));
    ASSERT_EQ(run.integrate(0.0, 5.0, {0.0}), SFDAE_OK) << run.message();
    const double half_period = std::acos(-1.0) / 6.0;  // 5 lies in the tenth one, where x falls
    EXPECT_NEAR(run.x[0], 10.0 * half_period - 5.0, 20.0 * tolerance);
  }
}

// Reference: F. Mazzia, C. Magherini: Test Set for IVP Solvers 2.4, problem vdpol: x' = y, eps y' = (1 - x^2) y - x.
TEST(StiffProblems, VanDerPolIsAccurate) {
  const auto equations = equations_of(2, 2, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] - x[1];
    F[1] = 1e-6 * xdot[1] - ((1.0 - x[0] * x[0]) * x[1] - x[0]);
  });
  for_all_methods(equations, {0.0, 2.0}, {2.0, -0.66}, {1e-4, 1e-6, 1e-8},
                  [](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_OK);
                    EXPECT_NEAR(run.x[0], 1.706167732170483, 100.0 * tol);
                    EXPECT_NEAR(run.x[1], -0.8928097010247975, 100.0 * tol);
                  });
}

// H. H. Robertson's reactions with a law of conservation; x(40) = 0.7158270687.
NonlinearEquations robertson() {
  return equations_of(3, 3, [](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + 0.04 * x[0] - 1e4 * x[1] * x[2];
    F[1] = xdot[1] - 0.04 * x[0] + 1e4 * x[1] * x[2] + 3e7 * x[1] * x[1];
    F[2] = x[0] + x[1] + x[2] - 1.0;
  });
}

TEST(StiffProblems, RobertsonConservesMass) {
  for_all_methods(robertson(), {0.0, 40.0}, {1.0, 0.0, 0.0}, {1e-6, 1e-8},
                  [](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_OK);
                    EXPECT_NEAR(run.x[0], 0.7158270687, 100.0 * tol);
                    EXPECT_NEAR(run.x[0] + run.x[1] + run.x[2], 1.0, 1e-14);
                  });
}

// To 1e11 in one call, where it begins with steps of 1e-7 and less: x1(1e11) = 2.083340e-8 (Test Set for IVP Solvers).
TEST(StiffProblems, RobertsonMayBeginInMuchShorterTimesThanItEnds) {
  for_all_methods(robertson(), {0.0, 1e11}, {1.0, 0.0, 0.0}, {1e-6, 1e-8, 1e-10},
                  [](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_OK) << run.message();
                    EXPECT_NEAR(run.x[0], 2.083340e-8, 10.0 * tol);
                    EXPECT_NEAR(run.x[0] + run.x[1] + run.x[2], 1.0, 1e-14);
                  });
}

// Pendulum of length L, where a unit of time is T seconds.
NonlinearEquations scaled_pendulum(double L, double T) {
  const double g = Pendulum::gravity * L * T * T;
  return equations_of(5, 5, [L, g](const auto&, const auto* x, const auto* xdot, auto* F) {
    for (int i = 0; i < 2; ++i) {
      F[i] = xdot[i] - x[2 + i];
      F[2 + i] = xdot[2 + i] + x[4] * x[i];
    }
    F[3] = F[3] + g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
  });
}

TEST(Units, MayBeGigameters) {
  for (const double L : {1e-9, 1e-3, 1e3}) {
    sfdae_options options = options_with(1e-6, SFDAE_METHOD_RADAU);
    options.atol = 1e-6 * L;
    NonlinearRun run(scaled_pendulum(L, 1.0), options);
    const int status = run.integrate(0.0, 10.0, {L, 0.0, 0.0, 0.0, 0.0});
    ASSERT_EQ(status, SFDAE_OK) << L << ": " << status_text(run, status);
    EXPECT_NEAR(run.x[0] / L, pendulum().references[0].x[0], 1e-3);
  }
}

// The same motion in units of length, mass and time that differ by four orders of magnitude and more. The force is not
// given: 0 is far from what it is.
TEST(Units, DoNotMatterToAPendulumWithoutItsForce) {
  int errors = 0, all = 0;
  for (const double L : {1e-4, 1e-2, 1.0, 1e2, 1e4})
    for (const double M : {1e-4, 1.0, 1e4})
      for (const double T : {1e-2, 1.0, 1e2}) {
        SCOPED_TRACE(testing::Message() << "L = " << L << ", M = " << M << ", T = " << T);
        const double g = 9.81 * L / (T * T), v = L / T, force = M / (T * T);
        const auto equations = equations_of(5, 5, [=](const auto&, const auto* x, const auto* xdot, auto* F) {
          F[0] = xdot[0] - x[2];
          F[1] = xdot[1] - x[3];
          F[2] = M * xdot[2] + 2.0 * x[0] * x[4];
          F[3] = M * xdot[3] + 2.0 * x[1] * x[4] + M * g;
          F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
        });
        sfdae_options options = options_with(1e-6);
        const std::vector<double> weights = {L, L, v, v, 1e6 * force};
        std::vector<double> atol = weights;
        for (double& a : atol) a *= 1e-6;
        options.atol_vector = atol.data();
        options.initial_weights = weights.data();
        NonlinearRun run(equations, options);
        const int status = run.start(0.0, T, {0.6 * L, -0.8 * L, 0.8 * v, 0.6 * v, 0.0});
        ++all;
        if (status < 0) {
          ++errors;
          EXPECT_TRUE(status == SFDAE_NO_CONSISTENT_VALUES || status == SFDAE_RANK_UNCLEAR)
              << status_text(run, status);
          continue;
        }
        EXPECT_EQ(run.values(), (CharacteristicValues{2, 2, 3, 0, 0}));
        const double x = run.x[0] / L, y = run.x[1] / L, speed = std::hypot(run.x[2], run.x[3]) / v;
        EXPECT_NEAR(x * x + y * y, 1.0, 1e-12);
        // 2 lambda L^2 = m (v^2 - g y)
        EXPECT_NEAR(2.0 * run.x[4] / force, speed * speed - 9.81 * y, 1e-6 * (1.0 + std::abs(run.x[4] / force)));
      }
  EXPECT_LE(errors, all / 5);
}

TEST(Contradictions, AreRefused) {
  const auto equations = [](double rate, double offset) {
    return equations_of(3, 2, [rate, offset](const auto& t, const auto* x, const auto* xdot, auto* F) {
      const auto circle = x[0] * x[0] + x[1] * x[1] - 2.0 - sin(t);
      F[0] = xdot[0] + x[0] - x[1];
      F[1] = circle;
      F[2] = 2.0 * circle - rate * t - offset;
    });
  };
  for (const auto& [rate, offset] : {std::pair(0.01, 0.0), std::pair(0.0, 0.1)})
    for_all_methods(equations(rate, offset), {0.0, 2.0}, {1.0, 1.0}, {1e-4},
                    [](const NonlinearRun&, int status, double) {
                      EXPECT_TRUE(status == SFDAE_NO_CONSISTENT_VALUES || status == SFDAE_INCONSISTENT_EQUATIONS);
                    });
}

NonlinearEquations plain_pendulum() {
  return equations_of(
      5, 5, [](const auto& t, const auto* x, const auto* xdot, auto* F) { pendulum_residual(t, x, xdot, F); });
}

TEST(Guesses, ThatAreNoNumbersOrTooLargeAreRefused) {
  for_all_methods(plain_pendulum(), {0.0, 1.0}, {NAN, 0.0, 0.0, 0.0, 0.0}, {1e-4},
                  [](const NonlinearRun&, int status, double) { EXPECT_EQ(status, SFDAE_ILLEGAL_ARGUMENT); });
  for_all_methods(plain_pendulum(), {0.0, 1.0}, {1e200, 1e200, 0.0, 0.0, 1e300}, {1e-4},
                  [](const NonlinearRun&, int status, double) { EXPECT_EQ(status, SFDAE_NOT_FINITE); });
  // It turns some 1e5 times in a unit of time.
  for_all_methods(plain_pendulum(), {0.0, 0.001}, {1e6, -3e5, 1e4, 7e5, 1e9}, {1e-4},
                  [](const NonlinearRun& run, int status, double) {
                    if (status == SFDAE_OK) {
                      EXPECT_NEAR(std::hypot(run.x[0], run.x[1]), 1.0, 1e-12);
                    }
                  });
}

TEST(Parameters, ThatAreNoNumbersAreRefused) {
  const NonlinearEquations equations = {
      1, 1, [](sfdae_record* record, const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
        F[0] = xdot[0] + sfdae::parameter(record, "k", NAN) * x[0] * x[0];
      }};
  EXPECT_EQ(NonlinearRun(equations, default_options()).created, SFDAE_ILLEGAL_ARGUMENT);
}

TEST(Tolerances, MayBeVeryTightOrVeryLoose) {
  const TestProblem p = pendulum();
  for_all_methods(plain_pendulum(), {0.0, 10.0}, p.x0, {1e-1, 1e-2, 1e-12},
                  [&p](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_OK);
                    EXPECT_NEAR(run.x[0], p.references[0].x[0], 1e3 * tol);
                    EXPECT_NEAR(std::hypot(run.x[0], run.x[1]), 1.0, 1e-12);
                  });
}

TEST(Directions, MayBeBackward) {
  const TestProblem p = pendulum();
  for_all_methods(plain_pendulum(), {10.0, 0.0}, p.references[0].x, {1e-4, 1e-6},
                  [&p](const NonlinearRun& run, int status, double tol) {
                    EXPECT_EQ(status, SFDAE_OK);
                    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(run.x[i], p.x0[i], 1e3 * tol);
                  });
}

// The support moves as sin 3t, the length is sqrt(1 + 0.3 sin t); the guess lacks the force.
TEST(TimeDependentConstraints, HoldAtTheEnd) {
  const auto equations = equations_of(5, 5, [](const auto& t, const auto* x, const auto* xdot, auto* F) {
    using std::sin;
    const auto a = x[0] - sin(3.0 * t);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[4] * a;
    F[3] = xdot[3] + x[4] * x[1] + 9.81;
    F[4] = a * a + x[1] * x[1] - 1.0 - 0.3 * sin(t);
  });
  for_all_methods(equations, {0.0, 3.0}, {0.0, -1.0, 3.0, 0.0, 0.0}, {1e-2, 1e-6},
                  [](const NonlinearRun& run, int status, double) {
                    EXPECT_EQ(status, SFDAE_OK);
                    const double a = run.x[0] - std::sin(3.0 * run.t), speed = run.x[2] - 3.0 * std::cos(3.0 * run.t);
                    EXPECT_NEAR(a * a + run.x[1] * run.x[1], 1.0 + 0.3 * std::sin(run.t), 1e-12);
                    EXPECT_NEAR(a * speed + run.x[1] * run.x[3], 0.15 * std::cos(run.t), 1e-11);
                  });
}

// x' + x^2 = 0, evaluated by a callback that fails now and then.
struct Unreliable {
  RandomNumbers numbers;
  double share;
  int answer;
  int failing = 0;  // the call that fails whatever the share is, none: 0
  int calls = 0;
};
int unreliable_derivative(double, int order, const double* x, double* F, double* F_x, double* F_xdot, void* user) {
  auto& self = *static_cast<Unreliable*>(user);
  if (++self.calls == self.failing || self.numbers.uniform(0.0, 1.0) < self.share) return self.answer;
  if (order == 0) F[0] = x[1] + x[0] * x[0];
  if (order == 1) F[0] = x[2] + 2.0 * x[0] * x[1];
  if (order > 1) return SFDAE_ORDER_NOT_AVAILABLE;
  if (F_x != nullptr) F_x[0] = 2.0 * x[order];
  if (F_xdot != nullptr && order == 0) F_xdot[0] = 1.0;
  return 0;
}

// To t = 1, where x = 1/(1 + t) is 1/2.
struct UnreliableResult {
  int status;
  std::string message;
  double x;
};
UnreliableResult integrate_unreliable(Unreliable& user, int method, double tolerance) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 1;
  problem.total_derivative = unreliable_derivative;
  problem.user = &user;
  const sfdae_options options = options_with(tolerance, method);
  sfdae_solver* solver = nullptr;
  UnreliableResult result{sfdae_create_nonlinear(&solver, &problem, &options), "", 1.0};
  double t = 0.0, xdot = 0.0;
  if (result.status == SFDAE_OK) result.status = sfdae_start(solver, 0.0, 1.0, &result.x, &xdot);
  if (result.status == SFDAE_OK) result.status = sfdae_advance(solver, 1.0, &t, &result.x, &xdot);
  result.message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return result;
}

TEST(Callbacks, MayFailAtRandom) {
  for (const int answer : {1, -1})
    for (const double share : {0.01, 0.1, 0.5})
      for (unsigned seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(testing::Message() << "answer " << answer << ", share " << share << ", seed " << seed);
        Unreliable user{RandomNumbers(seed), share, answer};
        const UnreliableResult result =
            integrate_unreliable(user, seed % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU, 1e-6);
        EXPECT_TRUE(result.status == SFDAE_OK ||
                    result.status == (answer > 0 ? SFDAE_CALLBACK_FAILED : SFDAE_CALLBACK_STOPPED))
            << sfdae_status_name(result.status) << ": " << result.message;
        EXPECT_TRUE(std::isfinite(result.x));
        if (result.status == SFDAE_OK) {
          EXPECT_NEAR(result.x, 0.5, 1e-4);
        }
      }
}

// Wherever one call fails, steps after it are as accurate as without: ten tolerances are allowed as without failures.
// (A linearization that could not be made once had its errors of steps come out as zero: up to 236 tolerances.)
TEST(Callbacks, MayFailOnceAnywhereWithoutLossOfAccuracy) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tolerance : {1e-4, 1e-6}) {
      Unreliable none{RandomNumbers(1), 0.0, 1};
      EXPECT_EQ(integrate_unreliable(none, method, tolerance).status, SFDAE_OK);
      for (int failing = 1; failing <= none.calls; ++failing) {
        SCOPED_TRACE(testing::Message() << "method " << method << ", tolerance " << tolerance << ", call "
                                        << failing);
        Unreliable user{RandomNumbers(1), 0.0, 1, failing};
        const UnreliableResult result = integrate_unreliable(user, method, tolerance);
        if (result.status == SFDAE_OK) {
          EXPECT_NEAR(result.x, 0.5, 10.0 * tolerance);
        } else {
          EXPECT_EQ(result.status, SFDAE_CALLBACK_FAILED) << result.message;
        }
      }
    }
}

}  // namespace
