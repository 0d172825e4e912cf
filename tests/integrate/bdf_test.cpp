// BDF: order conditions seen through convergence, exactness on polynomials, stability of the leading term.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/bdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "c_api/problems.h"
#include "family_run.h"
#include "linear/linear_system.h"
#include "reduction/index_analysis.h"

namespace {

using namespace sfdae::core;
using sfdae_test::FamilyProblem;
using sfdae_test::FamilyRun;
using sfdae_test::LinearFamily;

// A family reduced with a leading term of choice, and BDF steps at sizes of the test's choice.
class BdfRun {
 public:
  BdfRun(std::shared_ptr<const LinearFamily> family, LeadingTerm leading, double h, int max_order)
      : problem_(std::move(family)), linear_(functions_of(problem_.problem)), bdf_(max_order) {
    Arena arena;
    std::vector<RankDecision> decisions;
    IndexAnalysis analysis = analyze_index(linear_, 0.0, 1.0, {}, arena, decisions);
    system_ = std::make_unique<LinearSystem>(linear_, AnalysisSettings{}, analysis, leading);
    const std::size_t n = static_cast<std::size_t>(problem_.n());
    std::vector<double> x(n), xdot(n);
    problem_.family().exact(0.0, x.data(), xdot.data());
    EXPECT_EQ(system_->move_to(0.0), PointStatus::ok);
    std::vector<double> w(static_cast<std::size_t>(system_->leading_size())), wdot(w);
    system_->leading(x.data(), w.data());
    system_->leading_derivative(x.data(), xdot.data(), wdot.data());
    weights_.set({std::vector<double>(n, 1e6), std::vector<double>(n, 1e6)},
                 Tightening::sixth_root);  // every step is accepted
    bdf_.start(*system_, {0.0, x, xdot, w, wdot}, h);
    system_->accept();
  }

  StepOutcome step(double h) {
    const StepOutcome outcome = bdf_.attempt(*system_, bdf_.state().t + h, weights_);
    if (outcome == StepOutcome::accepted) {
      bdf_.commit();
      system_->accept();
    }
    return outcome;
  }

  double error() const {
    std::vector<double> exact(bdf_.x().size());
    problem_.family().exact(bdf_.state().t, exact.data(), nullptr);
    double worst = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) worst = std::max(worst, std::fabs(bdf_.x()[i] - exact[i]));
    return worst;
  }
  const Bdf& bdf() const { return bdf_; }

 private:
  FamilyProblem problem_;
  LinearProblem linear_;
  std::unique_ptr<LinearSystem> system_;
  ErrorWeights weights_;
  Bdf bdf_;
};

// Steps limited to h and h / 2 (with tolerances that let the limit govern): the error falls by 2^k for order k.
TEST(Bdf, ConvergesWithItsOrder) {
  for (int order = 1; order <= 5; ++order) {
    double errors[2], steps[2];
    int i = 0;
    for (double step : {1.0 / 100.0, 1.0 / 200.0}) {
      FamilyProblem problem(std::shared_ptr<const LinearFamily>(sfdae_test::kron(6, 1, 0.5)));
      sfdae_options options = sfdae_test::options_with_tolerance(1e-13);
      options.max_order = order;
      options.initial_step = 1e-12 / order;
      options.max_step = step;
      options.rtol = options.atol = std::pow(step, order + 1) * 1e3 > 1e-2 ? 1e-2 : std::pow(step, order + 1) * 1e3;
      options.initial_step = std::min(step, std::pow(options.rtol, 0.5) * 0.1);
      const FamilyRun run = sfdae_test::run_family(problem, 0.0, 1.0, options, 1);
      ASSERT_EQ(run.status, SFDAE_OK) << run.message;
      errors[i] = run.step_error * options.atol;
      steps[i++] = static_cast<double>(run.attempts());
    }
    const double observed = std::log(errors[0] / errors[1]) / std::log(steps[1] / steps[0]);
    EXPECT_GE(observed, order - 0.4) << "order " << order;
  }
}

// Spin problem, exact solution of size e^(-51 t): one-sided differences of E x' = A x with W = I multiply errors in
// every step, W = P and W = E keep them.
TEST(Bdf, TheProperlyStatedLeadingTermIsStableWhereTheKernelSpins) {
  const std::shared_ptr<const LinearFamily> family = sfdae_test::spin(-50.0, 1.0);
  for (LeadingTerm leading : {LeadingTerm::projector, LeadingTerm::matrix}) {
    BdfRun stepper(family, leading, 0.1, 1);
    for (int i = 0; i < 30; ++i) ASSERT_EQ(stepper.step(0.1), StepOutcome::accepted);
    EXPECT_LE(stepper.error(), 1.0);
  }
  BdfRun unstable(family, LeadingTerm::identity, 0.1, 1);
  for (int i = 0; i < 30; ++i) ASSERT_EQ(unstable.step(0.1), StepOutcome::accepted);
  EXPECT_GE(unstable.error(), 1e10);
}

TEST(Bdf, TheSpinProblemIsStableAtAnyStep) {
  for (double h : {0.01, 0.03, 0.1, 0.3, 1.0}) {
    BdfRun stepper(sfdae_test::spin(-50.0, 1.0), LeadingTerm::automatic, h, 1);
    for (double t = 0.0; t < 3.0; t += h) ASSERT_EQ(stepper.step(h), StepOutcome::accepted);
    EXPECT_LE(stepper.error(), 1.0) << h;
  }
}

// Rows multiplied by e^(-50 t), e^(50 t), or rotated fast: as accurate per step as the plain equations.
TEST(Bdf, RowOperationsDoNotMatter) {
  using sfdae_test::RowOperation;
  const auto error_of = [](RowOperation rows, LeadingTerm leading) {
    BdfRun stepper(sfdae_test::rotated_ode(rows, 50.0), leading, 0.1, 1);
    for (int i = 0; i < 10; ++i) EXPECT_EQ(stepper.step(0.1), StepOutcome::accepted);
    return stepper.error();
  };
  const double plain = error_of(RowOperation::none, LeadingTerm::automatic);
  EXPECT_GT(plain, 1e-4);
  EXPECT_LE(error_of(RowOperation::scaling, LeadingTerm::automatic), 3.0 * plain);
  EXPECT_LE(error_of(RowOperation::rotation, LeadingTerm::automatic), 3.0 * plain);
  EXPECT_GE(error_of(RowOperation::scaling, LeadingTerm::matrix), 1e3 * plain);
}

// Backward in time as well as forward.
TEST(Bdf, IntegratesBackward) {
  FamilyProblem problem(std::shared_ptr<const LinearFamily>(sfdae_test::kron(8, 2, 0.5)));
  const FamilyRun run = sfdae_test::run_family(problem, 1.0, 0.0, sfdae_test::options_with_tolerance(1e-6));
  ASSERT_EQ(run.status, SFDAE_OK) << run.message;
  EXPECT_LE(run.step_error, 10.0);
  EXPECT_EQ(run.t, 0.0);
}

// Constant matrices: one reduction, and one factorization for every pair of order and step size.
TEST(Bdf, ConstantMatricesAreReducedOnceAndFactoredOnceForEveryOrderAndStepSize) {
  FamilyProblem problem(std::shared_ptr<const LinearFamily>(sfdae_test::kron(8, 1, 0.0)));
  problem.declare_constants();
  struct Seen {
    std::vector<std::pair<int, double>> pairs;
  } seen;
  sfdae_options options = sfdae_test::options_with_tolerance(1e-6);
  options.monitor_user = &seen;
  options.monitor = [](const sfdae_progress* progress, void* user) {
    auto& pairs = static_cast<Seen*>(user)->pairs;
    const std::pair<int, double> pair{progress->order, progress->step};
    if (pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
    return 0;
  };
  sfdae_solver* solver = nullptr;
  ASSERT_EQ(sfdae_create_linear(&solver, &problem.problem, &options), SFDAE_OK);
  std::vector<double> x(8);
  problem.family().exact(0.0, x.data(), nullptr);
  ASSERT_EQ(sfdae_start(solver, 0.0, 10.0, x.data(), nullptr), SFDAE_OK);
  double t = 0.0;
  ASSERT_EQ(sfdae_advance(solver, 10.0, &t, x.data(), nullptr), SFDAE_OK);
  sfdae_statistics statistics;
  sfdae_statistics_init(&statistics, sizeof statistics);
  sfdae_get_statistics(solver, &statistics);
  EXPECT_EQ(statistics.evaluations_E, 1);
  EXPECT_EQ(statistics.evaluations_A, 1);
  EXPECT_LE(statistics.reductions, 1);
  EXPECT_LE(statistics.factorizations, static_cast<long>(seen.pairs.size()) + statistics.error_failures);
  EXPECT_LT(statistics.factorizations, statistics.steps / 2);
  sfdae_destroy(&solver);
}

}  // namespace
