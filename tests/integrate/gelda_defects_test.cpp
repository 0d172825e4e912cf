// Problems on which the classical code for linear DAEs is known to fail: all of them must come out right here.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "family_run.h"
#include "testset_linear.h"

namespace {

using namespace sfdae_test;

std::shared_ptr<const LinearFamily> shared(std::unique_ptr<LinearFamily> family) { return family; }
std::shared_ptr<const LinearFamily> shared(LinearTestProblem item) { return std::move(item.family); }

void expect_values(const sfdae_characteristics& found, const CharacteristicValues& expected) {
  EXPECT_EQ(found.strangeness_index, expected.mu);
  EXPECT_EQ(found.differential, expected.d);
  EXPECT_EQ(found.algebraic, expected.a);
  EXPECT_EQ(found.undetermined, expected.u);
  EXPECT_EQ(found.redundant, expected.v);
}

void expect_solved(std::shared_ptr<const LinearFamily> family, double t0, double t1, double tol,
                   bool declare_constants = false, double factor = 10.0) {
  SCOPED_TRACE(family->name());
  FamilyProblem problem(family);
  if (declare_constants) problem.declare_constants();
  const FamilyRun run = run_family(problem, t0, t1, options_with_tolerance(tol));
  ASSERT_GE(run.status, 0) << run.message;
  expect_values(run.characteristics, family->values());
  EXPECT_LE(run.step_error, factor);
  EXPECT_LE(run.output_error, factor);
}

// Item 1: constant coefficients, mu = 0, dense rows.
TEST(GeldaDefects, ConstantDenseRowsOfIndexZeroAreSolvedAtEveryTolerance) {
  for (double tol : {1e-3, 1e-5, 1e-7, 1e-9}) {
    expect_solved(shared(dense_rows(0.0)), 0.0, 1.0, tol, true);
    expect_solved(shared(kron(8, 0, 0.0)), 0.0, 1.0, tol, true);
  }
}

// Item 2: mu = 0, dense rows, tight tolerances.
TEST(GeldaDefects, DenseRowsOfIndexZeroAreSolvedAtTightTolerances) {
  expect_solved(shared(dense_rows(0.5)), 0.0, 1.0, 1e-9);
  expect_solved(shared(kron(16, 0, 0.5)), 0.0, 1.0, 1e-9);
}

// Item 3: mu = 0, u > 0. E = [0 0; 0 1], A = [0 0; 0 -1]: x_2 = e^-t, x_1 is free and held.
TEST(GeldaDefects, EquationsBesideAFreeComponentAreNotDropped) {
  FamilyProblem problem(shared(free_component()));
  const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-7), 4, {3.0, 1.0});
  ASSERT_EQ(run.status, SFDAE_OK) << run.message;
  EXPECT_EQ(run.characteristics.undetermined, 1);
  EXPECT_NEAR(run.x[1], std::exp(-1.0), 10 * 1e-7 * (1 + std::exp(-1.0)));
  EXPECT_NEAR(run.x[0], 3.0, 1e-12);
}

// Item 4: scale factors, fast rotations, stiffness.
TEST(GeldaDefects, ScaleFactorsChangeNothing) {
  for (int mu : {0, 1, 2, 3}) {
    FamilyProblem plain(shared(kron(8, mu, 0.5)));
    const FamilyRun reference = run_family(plain, 0.0, 1.0, options_with_tolerance(1e-6));
    for (double scale : {1e-12, 1e-6, 1e4, 1e12}) {
      SCOPED_TRACE(scale);
      FamilyProblem problem(shared(kron(8, mu, 0.5, 0, 0, 1, scale)));
      const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6));
      ASSERT_EQ(run.status, SFDAE_OK) << run.message;
      expect_values(run.characteristics, plain.family().values());
      // Powers of ten round, and a close decision of the step control may tip over.
      EXPECT_NEAR(static_cast<double>(run.attempts()), static_cast<double>(reference.attempts()), 3.0);
      EXPECT_LE(run.step_error, 10.0);
    }
  }
}

TEST(GeldaDefects, FastRotationsAreReducedCorrectly) {
  for (int mu : {2, 3})
    for (double w : {2.0, 4.0}) expect_solved(shared(kron(8, mu, w)), 0.0, 1.0, 1e-5);
}

// Values (2, 8, 8, 0) at every stiffness. At 1e5 perturbations of A by a few roundings (1e-11), multiplied by 1e5 with
// every differentiation, move the hidden constraints by more than their size: from there on the answer may be a named
// error, never other values.
TEST(GeldaDefects, StiffnessDoesNotChangeTheCharacteristicValues) {
  for (double sigma : {1e3, 1e4}) {
    FamilyProblem problem(shared(kron(16, 2, 0.5, 0, 0, sigma)));
    const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-5));
    ASSERT_EQ(run.status, SFDAE_OK) << run.message;
    expect_values(run.characteristics, {2, 8, 8, 0, 0});
    EXPECT_LE(run.output_error, 10.0);
  }
  for (double sigma : {1e5, 1e6}) {
    FamilyProblem stiffest(shared(kron(16, 2, 0.5, 0, 0, sigma)));
    const FamilyRun run = run_family(stiffest, 0.0, 1.0, options_with_tolerance(1e-5));
    if (run.status == SFDAE_RANK_UNCLEAR) continue;
    expect_values(run.characteristics, {2, 8, 8, 0, 0});
    EXPECT_LE(run.step_error, 10.0);
  }
}

TEST(GeldaDefects, ARowPairScaledBy1eMinus12KeepsItsEquations) {
  const auto family = shared(scaled_row(1e-12));
  FamilyProblem problem(family);
  const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6));
  ASSERT_EQ(run.status, SFDAE_OK) << run.message;
  expect_values(run.characteristics, family->values());
}

// eps x_2' = -x_2 stays a differential equation for eps = 1e-12, is a named error around 1e-14, algebraic below 1e-15.
TEST(GeldaDefects, SingularPerturbationsAreToldFromConstraints) {
  const auto analyze = [](double eps, sfdae_characteristics& values) {
    FamilyProblem problem(shared(singular_perturbation(eps)));
    sfdae_solver* solver = nullptr;
    EXPECT_EQ(sfdae_create_linear(&solver, &problem.problem, nullptr), SFDAE_OK);
    sfdae_characteristics_init(&values, sizeof values);
    const int status = sfdae_analyze(solver, 0.0, 1.0, &values);
    EXPECT_EQ(status == SFDAE_OK, std::string(sfdae_message(solver)).empty());
    sfdae_destroy(&solver);
    return status;
  };
  sfdae_characteristics values;
  for (double eps : {1e-6, 1e-9, 1e-12}) {
    EXPECT_EQ(analyze(eps, values), SFDAE_OK) << eps;
    EXPECT_EQ(values.differential, 2) << eps;
  }
  for (double eps : {0.7e-14, 1e-14, 2e-14}) EXPECT_EQ(analyze(eps, values), SFDAE_RANK_UNCLEAR) << eps;
  for (double eps : {0.9e-15, 1e-16, 1e-20, 1e-40}) {
    EXPECT_EQ(analyze(eps, values), SFDAE_OK) << eps;
    EXPECT_EQ(values.differential, 1) << eps;
    EXPECT_EQ(values.algebraic, 1) << eps;
  }
}

// diag(1, 1e-14) x' = diag(-1, -1e-14) x is badly scaled, nothing more.
TEST(GeldaDefects, ABadlyScaledEquationStaysDifferential) {
  expect_solved(shared(badly_scaled_ode()), 0.0, 1.0, 1e-6);
}

// Item 5.
TEST(GeldaDefects, SingularPencilsAndMissingEquationsAreClassified) {
  for (const auto& family : {shared(singular_pencil_5()), shared(purely_algebraic()), shared(no_equations())}) {
    SCOPED_TRACE(family->name());
    FamilyProblem problem(family);
    const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6), 3,
                                     std::vector<double>(static_cast<std::size_t>(family->n()), 1.0));
    ASSERT_EQ(run.status, SFDAE_OK) << run.message;
    expect_values(run.characteristics, family->values());
  }
}

// Item 7: NaN from a callback.
TEST(GeldaDefects, NanFromACallbackIsAnError) {
  FamilyProblem problem(shared(kron(8, 1)));
  problem.hooks.tamper = poison_behind(0.5, std::numeric_limits<double>::quiet_NaN());
  const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6));
  EXPECT_EQ(run.status, SFDAE_NOT_FINITE);
  EXPECT_NE(run.message.find("NaN"), std::string::npos) << run.message;
  EXPECT_LE(run.t, 0.5);
  EXPECT_GE(run.t, 0.3);
  for (double value : run.x) EXPECT_TRUE(std::isfinite(value));
}

// Item 8: free components must not destroy the order. kron with u > 0: compare the components that are determined.
TEST(GeldaDefects, FreeComponentsLeaveTheOrderAlone) {
  for (int u : {1, 2}) {
    for (double tol : {1e-5, 1e-7, 1e-9}) {
      FamilyProblem with(shared(kron(8, 1, 0.5, u)));
      FamilyProblem without(shared(kron(8, 1, 0.5)));
      const FamilyRun run = run_family(with, 0.0, 1.0, options_with_tolerance(tol));
      const FamilyRun reference = run_family(without, 0.0, 1.0, options_with_tolerance(tol));
      ASSERT_EQ(run.status, SFDAE_OK) << run.message;
      expect_values(run.characteristics, with.family().values());
      EXPECT_LE(run.attempts(), 2 * reference.attempts()) << "u = " << u << ", tol = " << tol;
    }
  }
}

// Item 9: the first x' is the derivative of the solution.
TEST(GeldaDefects, TheFirstDerivativeIsThatOfTheSolution) {
  for (int mu : {0, 1, 2, 3}) {
    FamilyProblem problem(shared(kron(8, mu, 0.5)));
    const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6));
    EXPECT_LE(run.initial_slope_error, 1e-12) << mu;
  }
}

// Item 10: springs of the chain times 100, eigenvalues near the imaginary axis. The multipliers are the weak spot.
TEST(GeldaDefects, OscillatingChainsAreFollowedWithoutStarvation) {
  FamilyProblem problem(shared(chain(10, 2, 0.5, 100.0)));
  const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-5));
  ASSERT_EQ(run.status, SFDAE_OK) << run.message;
  EXPECT_LE(run.step_error, 20.0);
  EXPECT_LE(run.attempts(), 150);
}

// Item 11: characteristic values that change at an isolated point.
TEST(GeldaDefects, AnIsolatedChangeIsLocated) {
  const std::vector<double> none;
  for (const auto& family : {shared(vanishing_E()), shared(vanishing_E(1.0)), shared(vanishing_A())}) {
    SCOPED_TRACE(family->name());
    FamilyProblem problem(family);
    const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-5));
    EXPECT_EQ(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message;
    EXPECT_NEAR(run.change.t, 0.5, 1e-6);
    EXPECT_EQ(run.change.old_differential, family->values().d);
    EXPECT_LE(run.t, 0.5);
  }
}

TEST(GeldaDefects, AChangeOverAnIntervalIsLocatedAndNamed) {
  const auto family = shared(changing_structure(0.4));
  FamilyProblem problem(family);
  const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-5));
  EXPECT_EQ(run.status, SFDAE_CHARACTERISTICS_CHANGED) << run.message;
  EXPECT_NEAR(run.change.t, 0.4, 1e-6);
  EXPECT_NEAR(run.t, 0.4, 1e-3);
  EXPECT_NE(run.change.old_differential, run.change.new_differential);
}

// Item 12: redundant equations that contradict each other.
TEST(GeldaDefects, ContradictingRedundantEquationsAreReported) {
  for (double rho : {1.0, 1e-3, 1e-6}) {
    FamilyProblem problem(shared(redundant_row(rho)));
    EXPECT_EQ(run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6)).status, SFDAE_INCONSISTENT_EQUATIONS)
        << rho;
    sfdae_options options = options_with_tolerance(1e-6);
    options.ignore_inconsistency = 1;
    EXPECT_EQ(run_family(problem, 0.0, 1.0, options).status, SFDAE_INCONSISTENCY_IGNORED) << rho;
  }
  FamilyProblem consistent(shared(redundant_row(0.0)));
  EXPECT_EQ(run_family(consistent, 0.0, 1.0, options_with_tolerance(1e-6)).status, SFDAE_OK);
}

}  // namespace
