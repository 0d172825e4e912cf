// Radau IIA steps: orders, stability, constant matrices, output between steps, choice of the number of stages.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "analyzed_problem.h"
#include "family_run.h"
#include "formula_family.h"
#include "integrate/integration.h"
#include "linear_family.h"
#include "system/change_watch.h"

using namespace sfdae::core;
using sfdae_test::AnalyzedProblem;
using sfdae_test::LinearFamily;

namespace {

using FamilyPointer = std::shared_ptr<const LinearFamily>;
using Vector = std::vector<double>;

// Steps of sizes of the test's choice, all accepted.
class RadauRun {
 public:
  RadauRun(const FamilyPointer& family, int stages, LeadingTerm leading = LeadingTerm::automatic,
           bool constant = false)
      : analyzed_(family, 0.0, 1.0, leading, {}, [constant](sfdae_test::FamilyProblem& callbacks) {
          if (constant) callbacks.declare_constants();
        }) {
    const Vector x = analyzed_.exact(0.0), xdot = analyzed_.exact_derivative(0.0);
    LinearSystem& system = analyzed_.system;
    EXPECT_EQ(system.move_to(0.0), PointStatus::ok);
    Vector w(static_cast<std::size_t>(system.leading_size())), wdot(w);
    system.leading(x.data(), w.data());
    system.leading_derivative(x.data(), xdot.data(), wdot.data());
    weights_.set({Vector(x.size(), 1e9), Vector(x.size(), 1e9)}, radau_.tightening());
    StepOptions options;
    options.min_stages = options.max_stages = stages;
    radau_.set_options(options);
    radau_.start(system, {0.0, x, xdot, w, wdot}, 0.1);
    system.accept();
  }

  void step_to(double t) {
    ASSERT_EQ(radau_.attempt(analyzed_.system, t, weights_), StepOutcome::accepted);
    radau_.commit();
    analyzed_.system.accept();
  }
  // Largest error at t = 1 after steps of equal size.
  double error_at_one(int steps) {
    for (int i = 1; i <= steps; ++i) step_to(static_cast<double>(i) / steps);
    return error();
  }
  double error() const { return difference(radau_.x(), analyzed_.exact(radau_.state().t)); }
  static double difference(const Vector& a, const Vector& b) {
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::fabs(a[i] - b[i]));
    return worst;
  }

  AnalyzedProblem analyzed_;
  ErrorWeights weights_;
  Radau radau_;
};

double observed_order(const FamilyPointer& family, int stages, int steps, bool constant) {
  const double coarse = RadauRun(family, stages, LeadingTerm::automatic, constant).error_at_one(steps);
  const double fine = RadauRun(family, stages, LeadingTerm::automatic, constant).error_at_one(2 * steps);
  // Otherwise rounding errors would be measured.
  EXPECT_GT(fine, 1e-14);
  return std::log2(coarse / fine);
}

// One period of a fast oscillation is what takes order 13 far enough from rounding errors.
FamilyPointer oscillation(double omega) {
  using sfdae_test::Entries;
  using sfdae_test::Jet;
  sfdae_test::Formulas formulas;
  // x1' = omega x2, x2' = -omega x1, 0 = x3 - t x1: coefficients that depend on t.
  formulas.E = [](const Jet&) { return Entries{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0}; };
  formulas.A = [omega](const Jet& t) { return Entries{0.0, omega, 0.0, -omega, 0.0, 0.0, -t, 0.0, 1.0}; };
  formulas.exact = [omega](const Jet& t) {
    const Jet phase = omega * t;
    return Entries{sin(phase), cos(phase), t * sin(phase)};
  };
  return sfdae_test::formula_family("oscillation", {0, 2, 1, 0, 0}, formulas);
}

struct OrderCase {
  int stages, steps;
  double omega;
};

class RadauOrder : public testing::TestWithParam<OrderCase> {};

// The order is 2s - 1 at the nodes, algebraic components included.
TEST_P(RadauOrder, IsTwiceTheStagesLessOne) {
  const OrderCase& given = GetParam();
  EXPECT_NEAR(observed_order(oscillation(given.omega), given.stages, given.steps, false), 2 * given.stages - 1,
              0.04 * (2 * given.stages - 1) + 0.1);
}

INSTANTIATE_TEST_SUITE_P(Family, RadauOrder,
                         testing::Values(OrderCase{1, 200, 1.0}, OrderCase{3, 8, 4.0}, OrderCase{5, 4, 8.0},
                                         OrderCase{7, 4, 16.0}));

// Higher index, everything turning.
TEST(Radau, HasItsOrderForHigherIndexAndTurningMatrices) {
  for (int mu = 0; mu <= 2; ++mu) {
    EXPECT_NEAR(observed_order(sfdae_test::kron(6, mu), 1, 64, false), 1.0, 0.2) << mu;
    EXPECT_NEAR(observed_order(sfdae_test::kron(16, mu), 3, 16, false), 5.0, 0.2) << mu;
    EXPECT_NEAR(observed_order(sfdae_test::kron(16, mu), 5, 4, false), 9.0, 0.9) << mu;
  }
}

// The transformed stages of constant matrices are those of the direct system.
TEST(Radau, TransformedStagesAreThoseOfTheDirectSystem) {
  for (int u : {0, 1})
    for (int stages : {1, 3, 5, 7}) {
      const FamilyPointer family = sfdae_test::kron(8, 1, 0.0, u);
      RadauRun direct(family, stages), transformed(family, stages, LeadingTerm::automatic, true);
      for (double t : {0.3, 0.8}) {
        direct.step_to(t);
        transformed.step_to(t);
        // Condition of T and of the stage system, generously.
        EXPECT_LE(RadauRun::difference(direct.radau_.x(), transformed.radau_.x()), 1e4 * unit_roundoff)
            << u << " " << stages << " " << t;
      }
    }
}

// One real and (s-1)/2 complex factorizations, kept while the step size stays.
TEST(Radau, ConstantMatricesAreFactoredOnceForEqualSteps) {
  const FamilyPointer family = sfdae_test::kron(8, 1, 0.0);
  RadauRun run(family, 5, LeadingTerm::automatic, true);
  const long before = run.analyzed_.system.counts().factorizations;
  const double h = 0.125;
  for (int i = 1; i <= 4; ++i) run.step_to(i * h);
  EXPECT_EQ(run.analyzed_.system.counts().factorizations - before, 3);
}

// E = [d-1, d t; 0, 0]: discretizing E x' is unstable, discretizing (P x)' is not.
TEST(Radau, TheSpinProblemIsStableAtAnyStep) {
  for (double h : {0.01, 0.1, 0.5}) {
    RadauRun run(sfdae_test::spin(-50.0, 1.0), 3);
    const int steps = static_cast<int>(3.0 / h);
    double largest = 0.0;
    for (int i = 1; i <= steps; ++i) {
      run.step_to(i * h);
      largest = std::max(largest, std::fabs(run.radau_.x()[1]));
    }
    EXPECT_LE(largest, 1.5) << h;
  }
}

TEST(Radau, RowOperationsDoNotMatter) {
  RadauRun plain(sfdae_test::rotated_ode(sfdae_test::RowOperation::none), 3);
  for (auto rows : {sfdae_test::RowOperation::scaling, sfdae_test::RowOperation::rotation}) {
    RadauRun run(sfdae_test::rotated_ode(rows, 50.0), 3);
    EXPECT_LE(run.error_at_one(5),
              3.0 * RadauRun(sfdae_test::rotated_ode(sfdae_test::RowOperation::none), 3).error_at_one(5));
  }
}

// Nothing between the points matters if there is no dynamics: one stage gives the solution.
TEST(Radau, WithoutDifferentialEquationsOneStageIsExact) {
  RadauRun run(sfdae_test::kron(3, 2), 7);
  ASSERT_EQ(run.analyzed_.system.differential(), 0);
  run.step_to(0.7);
  EXPECT_EQ(run.radau_.state().last.order, 1);
  EXPECT_LE(run.error(), 1e4 * unit_roundoff);
}

// ---- Whole integrations

struct Solve {
  double step_error = 0.0, output_error = 0.0;  // in tolerances
  IntegrationCounts counts;
  int status = SFDAE_OK;
  int highest_order = 0;
  Method last_method = Method::radau;
};

Solve solve(const FamilyPointer& family, double tol, int outputs, const IntegrationOptions& choice, double t1 = 1.0) {
  AnalyzedProblem analyzed(family, 0.0, t1);
  Vector x = analyzed.exact(0.0), xdot = analyzed.exact_derivative(0.0);
  IntegrationOptions options = choice;
  options.tolerances = {Vector(x.size(), tol), Vector(x.size(), tol)};
  analyzed.system.move_to(0.0);
  Integration integration(analyzed.system, std::make_unique<LinearChangeWatch>(analyzed.system), options,
                          {0.0, t1, x, xdot});
  const auto scaled = [&](const Vector& values, double t) {
    const Vector exact = analyzed.exact(t);
    double worst = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i)
      worst = std::max(worst, std::fabs(values[i] - exact[i]) / (tol * (std::fabs(exact[i]) + 1.0)));
    return worst;
  };
  Solve result;
  double t = 0.0;
  for (int i = 1; i <= outputs && result.status >= 0; ++i) do {
      result.status = integration.advance(t1 * i / outputs, true, t, x.data(), xdot.data()).status;
      const Stepper& stepper = integration.stepper();
      result.step_error = std::max(result.step_error, scaled(stepper.x(), stepper.state().t));
      result.highest_order = std::max(result.highest_order, stepper.state().last.order);
      if (result.status == SFDAE_OK) result.output_error = std::max(result.output_error, scaled(x, t));
    } while (result.status == SFDAE_STEP_TAKEN);
  result.counts = integration.counts();
  result.last_method = integration.method();
  return result;
}

IntegrationOptions with(Method method, int min_stages = 1, int max_stages = 7) {
  IntegrationOptions options;
  options.method = method;
  options.stepping.min_stages = min_stages;
  options.stepping.max_stages = max_stages;
  return options;
}

TEST(RadauIntegration, OutputsAreAsAccurateAsStepsHoweverManyThereAre) {
  for (int mu : {0, 2})
    for (double tol : {1e-4, 1e-7})
      for (int outputs : {1, 10, 100}) {
        const Solve result = solve(sfdae_test::kron(8, mu), tol, outputs, with(Method::radau));
        EXPECT_EQ(result.status, SFDAE_OK);
        EXPECT_LE(result.step_error, 10.0) << mu << " " << tol << " " << outputs;
        EXPECT_LE(result.output_error, 10.0) << mu << " " << tol << " " << outputs;
      }
}

TEST(RadauIntegration, TightTolerancesAreMetWithHighOrders) {
  const Solve tight = solve(sfdae_test::kron(16, 2), 1e-10, 1, with(Method::radau));
  EXPECT_EQ(tight.highest_order, 13);
  EXPECT_LE(tight.step_error, 10.0);
  const Solve bdf = solve(sfdae_test::kron(16, 2), 1e-10, 1, with(Method::bdf));
  // A step of BDF costs one reduction; a quarter of the time is a quarter of the reductions, about.
  EXPECT_LE(4 * tight.counts.reductions, bdf.counts.reductions);
  const Solve loose = solve(sfdae_test::kron(16, 2), 1e-3, 1, with(Method::radau));
  EXPECT_LT(loose.highest_order, 13);
}

TEST(RadauIntegration, NumbersOfStagesStayWithinTheirLimits) {
  for (int stages : {1, 3, 5, 7}) {
    const Solve result =
        solve(sfdae_test::kron(8, 1), stages == 1 ? 1e-3 : 1e-6, 3, with(Method::radau, stages, stages));
    EXPECT_EQ(result.status, SFDAE_OK) << stages;
    EXPECT_EQ(result.highest_order, 2 * stages - 1);
    // Order 1 does not keep global errors near local ones.
    EXPECT_LE(result.step_error, stages == 1 ? 50.0 : 10.0) << stages;
  }
}

// The estimate is near the truth: steps no more than what the tolerance calls for (half of the published 7, 15, 36
// and 99 steps of a code that tests the embedded estimate against the tolerance itself).
TEST(RadauIntegration, EstimateIsNearTheTruth) {
  const int published[] = {7, 15, 36, 99};
  double ratio = 1.0;
  for (int i = 0; i < 4; ++i) {
    const Solve result = solve(sfdae_test::kron(32, 2), std::pow(10.0, -3 - 2 * i), 1, with(Method::radau, 3, 3));
    EXPECT_LE(result.step_error, 10.0);
    EXPECT_GE(result.step_error, 0.01) << i;
    ratio *= static_cast<double>(result.counts.steps) / published[i];
  }
  EXPECT_LE(std::pow(ratio, 0.25), 0.5);
}

TEST(RadauIntegration, NeverPassesOutputsIfAskedNotTo) {
  IntegrationOptions options = with(Method::radau, 3, 3);
  options.never_pass_output = true;
  AnalyzedProblem analyzed(FamilyPointer(sfdae_test::kron(8, 1)), 0.0, 1.0);
  double last = 0.0;
  analyzed.callbacks.hooks.status = [&](const sfdae_test::Call& call) {
    last = std::max(last, call.t);
    return 0;
  };
  Vector x = analyzed.exact(0.0), xdot = analyzed.exact_derivative(0.0);
  options.tolerances = {Vector(8, 1e-5), Vector(8, 1e-5)};
  analyzed.system.move_to(0.0);
  Integration integration(analyzed.system, std::make_unique<LinearChangeWatch>(analyzed.system), options,
                          {0.0, 1.0, x, xdot});
  double t = 0.0;
  for (double tout : {0.1, 0.15, 1.0, 2.0}) {
    ASSERT_EQ(integration.advance(tout, false, t, x.data(), xdot.data()).status, SFDAE_OK);
    EXPECT_EQ(integration.stepper().state().t, tout);
    EXPECT_LE(last, tout);
  }
  // Short steps on the way do not make the later ones short.
  EXPECT_LE(integration.counts().steps, 20);
}

// A kink of f in the middle: steps fail there and go on behind it.
TEST(RadauIntegration, PassesAJumpOfTheRightHandSide) {
  using sfdae_test::Entries;
  using sfdae_test::Jet;
  sfdae_test::Formulas formulas;
  formulas.E = [](const Jet&) { return Entries{1.0}; };
  formulas.A = [](const Jet&) { return Entries{-1.0}; };
  formulas.f = [](const Jet& t) { return Entries{t[0] < 0.5 ? 0.0 : 1.0}; };
  // x' = -x + (0 or 1), x(0) = 1.
  formulas.exact = [](const Jet& t) {
    return Entries{t[0] < 0.5 ? exp(-t) : Jet(1.0) + (std::exp(-0.5) - 1.0) * exp(-(t - 0.5))};
  };
  const FamilyPointer family = sfdae_test::formula_family("jump", {0, 1, 0, 0, 0}, formulas);
  for (double tol : {1e-4, 1e-7}) {
    const Solve result = solve(family, tol, 10, with(Method::radau));
    EXPECT_EQ(result.status, SFDAE_OK);
    EXPECT_LE(result.step_error, 30.0) << tol;
  }
}

// Steps of one stage have no polynomial that would do for outputs: each costs a step.
TEST(RadauIntegration, AutomaticChoiceTakesBdfForFrequentOutputThatIsNotAccurateOnly) {
  EXPECT_EQ(solve(sfdae_test::kron(8, 1), 1e-6, 5, with(Method::automatic)).last_method, Method::radau);
  const Solve frequent = solve(sfdae_test::kron(8, 1), 1e-8, 400, with(Method::automatic));
  EXPECT_EQ(frequent.last_method, Method::radau);
  EXPECT_LE(frequent.output_error, 10.0);
  const Solve rough = solve(sfdae_test::kron(8, 1), 1e-2, 2000, with(Method::automatic, 1, 1));
  EXPECT_EQ(rough.last_method, Method::bdf);
  EXPECT_LE(rough.output_error, 10.0);
}

// x' = w (x2, -x1), tolerance given by atol alone, rtol as small as one likes.
TEST(RadauIntegration, AToleranceThatIsAbsoluteIsMetWhateverRtolIs) {
  using sfdae_test::Entries;
  using sfdae_test::Jet;
  constexpr double omega = 60.0, atol = 1e-4;
  sfdae_test::Formulas formulas;
  formulas.E = [](const Jet&) { return Entries{1.0, 0.0, 0.0, 1.0}; };
  formulas.A = [](const Jet&) { return Entries{0.0, omega, -omega, 0.0}; };
  formulas.exact = [](const Jet& t) { return Entries{sin(omega * t), cos(omega * t)}; };
  const FamilyPointer family = sfdae_test::formula_family("fast rotation", {0, 2, 0, 0, 0}, formulas);
  for (double rtol : {0.0, 1e-15, 1e-8, 1e-4}) {
    AnalyzedProblem analyzed(family, 0.0, 1.0);
    Vector x = analyzed.exact(0.0), xdot = analyzed.exact_derivative(0.0);
    IntegrationOptions options = with(Method::radau, 3, 3);
    options.tolerances = {Vector(2, rtol), Vector(2, atol)};
    analyzed.system.move_to(0.0);
    Integration integration(analyzed.system, std::make_unique<LinearChangeWatch>(analyzed.system), options,
                            {0.0, 1.0, x, xdot});
    double t = 0.0, worst = 0.0;
    while (integration.advance(1.0, true, t, x.data(), xdot.data()).status == SFDAE_STEP_TAKEN)
      worst = std::max(worst, RadauRun::difference(x, analyzed.exact(t)));
    EXPECT_EQ(t, 1.0);
    // Ten periods without damping: errors of some 60 steps add up.
    EXPECT_LE(worst, 30.0 * atol) << rtol;
  }
}

// The step first is suspected of a change at one stage, wrongly, and goes through one at a later stage.
TEST(RadauIntegration, AChangeAfterAFalseAlarmWithinTheStepIsFound) {
  using sfdae_test::Entries;
  using sfdae_test::Jet;
  for (int i = 0; i < 20; ++i) {
    const double at = 0.6 + 0.05 * i;
    sfdae_test::Formulas formulas;
    formulas.E = [at](const Jet& t) { return Entries{1.0, 0.0, 0.0, -1.0 * ((t - at) * (t - at) * (t - at))}; };
    formulas.A = [](const Jet&) { return Entries{-1.0, 0.0, 0.0, -1.0}; };
    formulas.exact = [](const Jet& t) { return Entries{exp(-t), cos(t)}; };
    const FamilyPointer family = sfdae_test::formula_family("cubic zero", {0, 2, 0, 0, 0}, formulas);
    for (double tol : {1e-3, 1e-9}) {
      const Solve result = solve(family, tol, 1, with(Method::radau), 2.5);
      EXPECT_EQ(result.status, SFDAE_CHARACTERISTICS_CHANGED) << at << " " << tol;
    }
  }
}

// A step cut short at an output tells nothing about the next one.
TEST(RadauIntegration, TheStepPlannedBeforeAnOutputIsTakenAfterIt) {
  IntegrationOptions options = with(Method::radau, 3, 3);
  options.never_pass_output = true;
  AnalyzedProblem analyzed(FamilyPointer(sfdae_test::kron(8, 1)), 0.0, 1.0);
  Vector x = analyzed.exact(0.0), xdot = analyzed.exact_derivative(0.0);
  options.tolerances = {Vector(8, 1e-6), Vector(8, 1e-6)};
  analyzed.system.move_to(0.0);
  Integration integration(analyzed.system, std::make_unique<LinearChangeWatch>(analyzed.system), options,
                          {0.0, 2.0, x, xdot});
  double t = 0.0;
  ASSERT_EQ(integration.advance(0.5, false, t, x.data(), xdot.data()).status, SFDAE_OK);
  const double planned = integration.stepper().state().next_step;
  ASSERT_EQ(integration.advance(0.5 + 1e-3 * planned, false, t, x.data(), xdot.data()).status, SFDAE_OK);
  EXPECT_EQ(integration.stepper().state().next_step, planned);
}

}  // namespace
