// Problems on which the original DGELDA 1.1.1 is known to fail, through this DGELDA: the right answer or the code
// documented for the case. tests/integrate/gelda_defects_test.cpp does the same through the C API.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "dgelda_family_run.h"
#include "formula_family.h"
#include "testset_linear.h"

namespace {

using namespace sfdae_test;
using Family = std::shared_ptr<const LinearFamily>;
using Functions = DgeldaFamily<std::int32_t>;

Family shared(std::unique_ptr<LinearFamily> family) { return family; }
Family shared(LinearTestProblem item) { return std::move(item.family); }

// Of a component of size 1 in one step.
constexpr double step_rounding = 100.0 * std::numeric_limits<double>::epsilon();

// What DGELDA can tell of them: no v.
CharacteristicValues documented(CharacteristicValues values) {
  values.v = values.u;
  return values;
}

class DgeldaDefects : public testing::TestWithParam<int> {
 protected:
  int method() const { return GetParam(); }

  DgeldaFamilyRun run(Functions& functions, double tol, bool constant = false) const {
    return run_dgelda(functions, 0.0, 1.0, {.method = method(), .tol = tol, .constant = constant});
  }
  DgeldaFamilyRun expect_solved(const Family& family, double tol, bool constant = false, double factor = 10.0) const {
    SCOPED_TRACE(family->name());
    Functions functions(family);
    const DgeldaFamilyRun result = run(functions, tol, constant);
    EXPECT_EQ(result.ierr, 3) << "at t = " << result.t << ", tol = " << tol;
    EXPECT_EQ(result.values, documented(family->values()));
    EXPECT_LE(result.step_error, factor) << tol;
    EXPECT_LE(result.output_error, factor) << tol;
    EXPECT_EQ(functions.wrong_arguments, 0);
    return result;
  }
  // The call with TOUT = T: characteristic values and initial values, no step.
  Dgelda<std::int32_t> started(Functions& functions, double t0 = 0.0) const {
    Dgelda<std::int32_t> call = functions.arguments(method(), t0);
    call.call(t0);
    return call;
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, DgeldaDefects, testing::Values(1, 2), method_name);

// Item 1: constant coefficients, mu = 0, dense rows; declared constant or not.
TEST_P(DgeldaDefects, ConstantDenseRowsOfIndexZeroAreSolvedAtEveryTolerance) {
  for (double tol : {1e-3, 1e-5, 1e-7, 1e-9})
    for (bool constant : {true, false}) {
      expect_solved(shared(dense_rows(0.0)), tol, constant);
      expect_solved(shared(kron(8, 0, 0.0)), tol, constant);
    }
}

// Item 2: mu = 0, dense rows, tight tolerances.
TEST_P(DgeldaDefects, DenseRowsOfIndexZeroAreSolvedAtTightTolerances) {
  expect_solved(shared(dense_rows(0.5)), 1e-9);
  expect_solved(shared(kron(16, 0, 0.5)), 1e-9);
}

// Item 3: E = [0 0; 0 1], A = [0 0; 0 -1]: x_2 = e^-t, x_1 is free and held.
TEST_P(DgeldaDefects, EquationsBesideAFreeComponentAreNotDropped) {
  for (bool constant : {false, true}) {
    Functions functions(shared(free_component()));
    const DgeldaFamilyRun result =
        run_dgelda(functions, 0.0, 1.0, {.method = method(), .tol = 1e-7, .constant = constant, .x0 = {3.0, 1.0}});
    ASSERT_EQ(result.ierr, 3);
    EXPECT_EQ(result.values, (CharacteristicValues{0, 1, 0, 1, 1}));
    EXPECT_NEAR(result.x[1], std::exp(-1.0), 10 * 1e-7 * (1 + std::exp(-1.0)));
    EXPECT_NEAR(result.x[0], 3.0, 3.0 * static_cast<double>(result.steps) * step_rounding);
  }
}

// Item 4: scale factors, fast rotations, stiffness.
TEST_P(DgeldaDefects, ScaleFactorsChangeNothing) {
  for (int mu : {0, 1, 2, 3}) {
    const DgeldaFamilyRun plain = expect_solved(shared(kron(8, mu, 0.5)), 1e-6);
    for (double scale : {1e-12, 1e-6, 1e4, 1e12}) {
      SCOPED_TRACE(scale);
      const DgeldaFamilyRun scaled = expect_solved(shared(kron(8, mu, 0.5, 0, 0, 1, scale)), 1e-6);
      // Powers of ten round, and close decisions about order and step size tip over.
      EXPECT_LE(scaled.attempts, 2 * plain.attempts);
    }
  }
}

TEST_P(DgeldaDefects, FastRotationsAreReducedCorrectly) {
  for (int mu : {2, 3})
    for (double w : {2.0, 4.0}) expect_solved(shared(kron(8, mu, w)), 1e-5);
}

// Values (2, 8, 8, 0) at every stiffness. At 1e5 perturbations of A by a few roundings (1e-11), multiplied by 1e5 with
// every differentiation, move the hidden constraints by more than their size: from there on the answer may be an error,
// never other values.
TEST_P(DgeldaDefects, StiffnessDoesNotChangeTheCharacteristicValues) {
  for (double sigma : {1e3, 1e4}) expect_solved(shared(kron(16, 2, 0.5, 0, 0, sigma)), 1e-5);
  for (double sigma : {1e5, 1e6}) {
    Functions stiffest(shared(kron(16, 2, 0.5, 0, 0, sigma)));
    const DgeldaFamilyRun result = run(stiffest, 1e-5);
    if (result.ierr == -22) continue;
    EXPECT_EQ(result.ierr, 3);
    EXPECT_EQ(result.values, (CharacteristicValues{2, 8, 8, 0, 0}));
    EXPECT_LE(result.step_error, 10.0);
  }
}

TEST_P(DgeldaDefects, ARowPairScaledBy1eMinus12KeepsItsEquations) { expect_solved(shared(scaled_row(1e-12)), 1e-6); }

// diag(1, 1e-14) x' = diag(-1, -1e-14) x is badly scaled, nothing more.
TEST_P(DgeldaDefects, ABadlyScaledEquationStaysDifferential) { expect_solved(shared(badly_scaled_ode()), 1e-6); }

// eps x_2' = -x_2 is a differential equation for eps = 1e-12, -22 around 1e-14, algebraic below 1e-15.
TEST_P(DgeldaDefects, SingularPerturbationsAreToldFromConstraints) {
  for (double eps : {1e-6, 1e-9, 1e-12}) {
    Functions functions(shared(singular_perturbation(eps)));
    const auto call = started(functions);
    EXPECT_EQ(call.ierr, 4) << eps;
    EXPECT_EQ(call.cval(2), 2) << eps;
  }
  for (double eps : {0.7e-14, 1e-14, 2e-14}) {
    Functions functions(shared(singular_perturbation(eps)));
    EXPECT_EQ(started(functions).ierr, -22) << eps;
  }
  for (double eps : {0.9e-15, 1e-16, 1e-20, 1e-40}) {
    Functions functions(shared(singular_perturbation(eps)));
    const auto call = started(functions);
    EXPECT_EQ(call.ierr, 4) << eps;
    EXPECT_EQ(call.cval(2), 1) << eps;
    EXPECT_EQ(call.cval(3), 1) << eps;
  }
}

// Item 5.
TEST_P(DgeldaDefects, SingularPencilsAndMissingEquationsAreClassified) {
  for (const Family& family : {shared(singular_pencil_5()), shared(purely_algebraic()), shared(no_equations())})
    for (bool constant : {false, true}) expect_solved(family, 1e-6, constant);
}

// Item 6: a failure that passes is overcome by a smaller step, one that stays keeps its code.
TEST_P(DgeldaDefects, CallbackErrorsAreRetriedAndKeepTheirCode) {
  for (int code : {-1, 1, -7}) {
    bool failed = false;
    Functions passing(shared(kron(8, 1)));
    passing.problem.hooks.status = [&](const Call& call) {
      if (failed || call.t <= 0.5) return 0;
      failed = true;
      return code;
    };
    const DgeldaFamilyRun result = run(passing, 1e-6);
    EXPECT_TRUE(failed);
    EXPECT_EQ(result.ierr, 3) << code;
    EXPECT_LE(result.output_error, 10.0);

    Functions staying(shared(kron(8, 1)));
    staying.problem.hooks.status = return_behind(0.5, code);
    const DgeldaFamilyRun stopped = run(staying, 1e-6);
    EXPECT_EQ(stopped.ierr, -10) << code;
    EXPECT_LE(stopped.t, 0.5);
    EXPECT_LE(stopped.step_error, 10.0);
  }
}

TEST_P(DgeldaDefects, AMissingOrderStopsAtOnceWithItsCode) {
  long calls_afterwards = 0;
  bool told = false;
  Functions functions(shared(kron(8, 1)));
  functions.problem.hooks.status = [&](const Call& call) {
    if (told) ++calls_afterwards;
    if (call.t <= 0.5) return 0;
    told = true;
    return -2;
  };
  EXPECT_EQ(run(functions, 1e-6).ierr, -21);
  EXPECT_EQ(calls_afterwards, 0);

  // The first derivatives, without which mu = 1 cannot be seen.
  Functions at_the_start(shared(kron(8, 1)));
  at_the_start.problem.hooks.highest_order = 0;
  EXPECT_EQ(run(at_the_start, 1e-6).ierr, -21);
  Functions failing(shared(kron(8, 1)));
  failing.problem.hooks.status = [](const Call&) { return -1; };
  EXPECT_EQ(run(failing, 1e-6).ierr, -22);
}

// Item 7: NaN and Inf count as -1.
TEST_P(DgeldaDefects, NanFromACallbackIsAnError) {
  for (double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Functions functions(shared(kron(8, 1)));
    functions.problem.hooks.tamper = poison_behind(0.5, poison);
    const DgeldaFamilyRun result = run(functions, 1e-6);
    EXPECT_EQ(result.ierr, -10);
    EXPECT_LE(result.t, 0.5);
    EXPECT_LE(result.step_error, 10.0);
    for (double value : result.x) EXPECT_TRUE(std::isfinite(value));

    Functions from_the_start(shared(kron(8, 1)));
    from_the_start.problem.hooks.tamper = poison_behind(-1.0, poison);
    EXPECT_EQ(run(from_the_start, 1e-6).ierr, -22);
  }
}

// Item 8: free components must not destroy the order.
TEST_P(DgeldaDefects, FreeComponentsLeaveTheOrderAlone) {
  for (int u : {1, 2})
    for (double tol : {1e-5, 1e-7, 1e-9}) {
      Functions with(shared(kron(8, 1, 0.5, u))), without(shared(kron(8, 1, 0.5)));
      const DgeldaFamilyRun result = run(with, tol), reference = run(without, tol);
      ASSERT_EQ(result.ierr, 3);
      EXPECT_EQ(result.values, with.problem.family().values());
      EXPECT_LE(result.attempts, 2 * reference.attempts) << "u = " << u << ", tol = " << tol;
    }
}

// Item 9: the first x' is the derivative of the solution. One order of derivatives more than the index needs is not
// asked for, hence differences of order 4, at best eps^(4/5), of data in which eps is amplified by the reduction.
TEST_P(DgeldaDefects, TheFirstDerivativeIsThatOfTheSolution) {
  for (int mu : {0, 1, 2}) {
    Functions functions(shared(kron(8, mu, 0.5)));
    const auto call = started(functions);
    ASSERT_EQ(call.ierr, 4);
    std::vector<double> x(8), slope(8);
    functions.problem.family().exact(0.0, x.data(), slope.data());
    const double bound = 1e4 * std::pow(std::numeric_limits<double>::epsilon(), 0.8);
    for (int i = 1; i <= 8; ++i) EXPECT_NEAR(call.xprime(i), slope[static_cast<std::size_t>(i - 1)], bound) << mu;
    EXPECT_LE(functions.problem.highest_order_asked(), 3);
  }
}

// Without differential equations x' is found where it is returned, at TOUT as at T = TOUT, from four points more, and
// not before the first step, which does without.
TEST_P(DgeldaDefects, TheDerivativeIsThatOfTheSolutionWithoutDifferentialEquations) {
  for (int is_started : {0, 1}) {
    Functions functions(shared(kron(4, 3, 0.5)));
    Dgelda<std::int32_t> call = is_started == 1 ? started(functions) : functions.arguments(method(), 0.0);
    ASSERT_EQ(call.call(1.0), 3);
    std::vector<double> x(4), slope(4);
    functions.problem.family().exact(1.0, x.data(), slope.data());
    for (int i = 1; i <= 4; ++i) {
      EXPECT_NEAR(call.x(i), x[static_cast<std::size_t>(i - 1)], 1e-10);
      EXPECT_NEAR(call.xprime(i), slope[static_cast<std::size_t>(i - 1)], 1e-7);
    }
    // Two of the analysis, both ends, four for x' at TOUT.
    if (is_started == 0) {
      EXPECT_LE(functions.problem.calls(Callback::E, 0), 8);
    }
  }
}

// Item 10: springs of the chain times 100, eigenvalues near the imaginary axis.
TEST_P(DgeldaDefects, OscillatingChainsAreFollowedWithoutStarvation) {
  const DgeldaFamilyRun result = expect_solved(shared(chain(10, 2, 0.5, 100.0)), 1e-5);
  EXPECT_LE(result.attempts, 150);
}

// Item 11: characteristic values that change at an isolated point or from a point on.
TEST_P(DgeldaDefects, AnIsolatedChangeIsReported) {
  for (const Family& family : {shared(vanishing_E()), shared(vanishing_E(1.0)), shared(vanishing_A())}) {
    SCOPED_TRACE(family->name());
    Functions functions(family);
    const DgeldaFamilyRun result = run(functions, 1e-5);
    EXPECT_EQ(result.ierr, -26);
    EXPECT_LE(result.t, 0.5);
    EXPECT_NE(result.values, documented(family->values()));
  }
}

TEST_P(DgeldaDefects, AChangeOverAnIntervalIsReportedWithTheNewValues) {
  Functions functions(shared(changing_structure(0.4)));
  const DgeldaFamilyRun result = run(functions, 1e-5);
  EXPECT_EQ(result.ierr, -26);
  EXPECT_LE(result.t, 0.4);
  EXPECT_GE(result.t, 0.4 - 1e-3);
  EXPECT_EQ(result.values, (CharacteristicValues{0, 1, 1, 0, 0}));
  EXPECT_LE(result.step_error, 10.0);
}

// Item 12: x1' = -x1, 0 = x2 - sin t, 0 = x2 - (1 - rho) sin t; x3 appears nowhere. (0; 1, 1, 1, 1).
Family contradiction(double rho) {
  Formulas p;
  p.constant_E = p.constant_A = true;
  p.E = [](const Jet&) -> Entries { return {1, 0, 0, 0, 0, 0, 0, 0, 0}; };
  p.A = [](const Jet&) -> Entries { return {-1, 0, 0, 0, 1, 0, 0, 1, 0}; };
  p.f = [=](const Jet& t) -> Entries { return {0, -sin(t), (rho - 1) * sin(t)}; };
  if (rho == 0.0) p.exact = [](const Jet& t) -> Entries { return {exp(-t), sin(t), 1}; };
  return formula_family("contradiction", {0, 1, 1, 1, 1}, p);
}

TEST_P(DgeldaDefects, ContradictingRedundantEquationsAreReported) {
  for (bool constant : {false, true}) {
    for (double rho : {1.0, 1e-3, 1e-6}) {
      Functions functions(contradiction(rho));
      const DgeldaFamilyRun result =
          run_dgelda(functions, 0.0, 1.0, {.method = method(), .constant = constant, .x0 = {1.0, 0.0, 1.0}});
      EXPECT_EQ(result.ierr, -24) << rho;
    }
    expect_solved(contradiction(0.0), 1e-6, constant);
  }
}

// Item 13: no STOP, no PRINT, and mu = 0 needs no work space for an index that it does not have.
TEST_P(DgeldaDefects, NothingIsPrintedAndNothingStops) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Functions functions(shared(kron(8, 1)));
  Dgelda<std::int32_t> call = functions.arguments(method());
  call.info(14) = 1;
  call.iwork(20) = 1;
  EXPECT_EQ(call.call(1.0), -1);
  EXPECT_EQ(call.call(1.0), -998);
  EXPECT_EQ(call.call(1.0), -998);
  Dgelda<std::int32_t> illegal = functions.arguments(method());
  illegal.info(2) = 2;
  EXPECT_EQ(illegal.call(1.0), -101);
  EXPECT_EQ(illegal.call(1.0), -999);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_P(DgeldaDefects, IndexZeroNeedsWorkSpaceForIndexZeroOnly) {
  Functions functions(shared(kron(8, 0, 0.5)));
  Dgelda<std::int32_t> call(8, method(), 5, 0);
  call.functions(functions.arguments(method()).edif, functions.arguments(method()).adif,
                 functions.arguments(method()).fdif);
  call.rpar = reinterpret_cast<double*>(&functions);
  functions.problem.family().exact(0.0, call.x.data(), nullptr);
  EXPECT_EQ(call.call(1.0), 3);
  EXPECT_LE(weighted_error(functions.problem.family(), 1e-6, 1.0, call.x.data()), 10.0);
  EXPECT_TRUE(call.guards_intact());
}

}  // namespace
