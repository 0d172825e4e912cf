// SPDX-License-Identifier: BSD-3-Clause
// All state of SFNDAE lies in the caller's arrays: calls may be interrupted, interleaved and copied without an effect
// on any bit, the documented lengths suffice, and nothing is written beyond them.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sfdae/sfdae.h"
#include "sfndae_problems.h"

using namespace sfdae_test;

namespace {

class SfndaeState : public testing::TestWithParam<int> {
 protected:
  static std::vector<KnownNonlinear> problems() {
    return {pendulum_problem(), path_control(), nonlinear_ode(), free_nonlinear_component(), redundant_equation()};
  }
  template <class I = std::int32_t>
  static SfndaeRun<I> run_of(const KnownNonlinear& problem) {
    SfndaeRun<I> run(problem.equations, GetParam(), 5, problem.max_index);
    run.set_x(problem.start);
    return run;
  }
};

// X and XPRIME
using Output = std::pair<std::vector<double>, std::vector<double>>;
Output output_of(const SfndaeRun<>& run) { return {run.values(), run.slopes()}; }

std::vector<Output> uninterrupted(SfndaeRun<> run) {
  std::vector<Output> outputs;
  for (int k = 1; k <= 5; ++k) {
    EXPECT_EQ(run.call(0.3 * k), 3);
    outputs.push_back(output_of(run));
  }
  return outputs;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Methods, SfndaeState, testing::Values(1, 2),
                         [](const auto& method) { return method.param == 1 ? "Bdf" : "Radau"; });

// After every single step.
TEST_P(SfndaeState, InterruptedCallsGiveTheSameBits) {
  for (const KnownNonlinear& problem : problems()) {
    SCOPED_TRACE(testing::PrintToString(problem.characteristics));
    const std::vector<Output> expected = uninterrupted(run_of(problem));
    SfndaeRun<> run = run_of(problem);
    run.info(14) = 1;
    run.iwork(20) = 1;
    int interruptions = 0;
    for (int k = 1; k <= 5; ++k) {
      while (run.call(0.3 * k) == -1) {
        ++interruptions;
        run.info(1) = 1;
      }
      ASSERT_EQ(run.ierr, 3);
      EXPECT_EQ(output_of(run), expected[static_cast<std::size_t>(k) - 1]) << k;
    }
    EXPECT_GE(interruptions, problem.characteristics[1] > 0 ? 5 : 0);
  }
}

TEST_P(SfndaeState, InterleavedCallsAndCopiedArraysGiveTheSameBits) {
  const std::vector<KnownNonlinear> all = problems();
  std::vector<std::vector<Output>> expected;
  std::vector<std::unique_ptr<SfndaeRun<>>> runs;
  for (const KnownNonlinear& problem : all) {
    expected.push_back(uninterrupted(run_of(problem)));
    runs.push_back(std::make_unique<SfndaeRun<>>(run_of(problem)));
  }
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t i = 0; i < all.size(); ++i) {
      // The old arrays are filled with something else.
      auto moved = std::make_unique<SfndaeRun<>>(*runs[i]);
      runs[i]->rwork.fill(-1.0);
      runs[i] = std::move(moved);
      ASSERT_EQ(runs[i]->call(0.3 * static_cast<double>(k + 1)), 3);
      EXPECT_EQ(output_of(*runs[i]), expected[i][k]) << i << " " << k;
    }
}

TEST_P(SfndaeState, WidthsOfIntegersGiveTheSameBits) {
  for (const KnownNonlinear& problem : problems()) {
    SfndaeRun<> narrow = run_of(problem);
    SfndaeRun<std::int64_t> wide = run_of<std::int64_t>(problem), second = run_of<std::int64_t>(problem);
    second.entry = sfndae_64__;
    for (int k = 0; k <= 2; ++k) {
      const int ierr = narrow.call(0.5 * k);
      EXPECT_EQ(wide.call(0.5 * k), ierr);
      EXPECT_EQ(second.call(0.5 * k), ierr);
      EXPECT_EQ(wide.values(), narrow.values());
      EXPECT_EQ(second.slopes(), narrow.slopes());
    }
  }
}

// A solver that is never taken apart: the state lacks nothing.
TEST(SfndaeStateBdf, CallsGiveTheBitsOfOneLiveSolver) {
  for (const KnownNonlinear& problem :
       {pendulum_problem(), path_control(), nonlinear_ode(), free_nonlinear_component()}) {
    SCOPED_TRACE(testing::PrintToString(problem.characteristics));
    sfdae_nonlinear_problem equations;
    ASSERT_EQ(sfdae_nonlinear_problem_init(&equations, sizeof equations), SFDAE_OK);
    equations.num_equations = problem.equations->m;
    equations.num_unknowns = problem.equations->n;
    equations.total_derivative = [](double t, int order, const double* derivatives, double* F, double* F_x,
                                    double* F_xdot, void* user) {
      return static_cast<NonlinearEquations*>(user)->evaluate(t, order, derivatives, F, F_x, F_xdot) ? 0 : 1;
    };
    equations.user = problem.equations.get();
    sfdae_solver* solver = nullptr;
    ASSERT_EQ(sfdae_create_nonlinear(&solver, &equations, nullptr), SFDAE_OK);
    std::vector<double> x = problem.start, xdot(x.size());
    ASSERT_GE(sfdae_start(solver, 0.0, 0.3, x.data(), xdot.data()), SFDAE_OK);
    SfndaeRun<> run(problem.equations, 1, 5, 5);
    run.set_x(problem.start);
    double t = 0.0;
    for (int k = 1; k <= 5; ++k) {
      ASSERT_GE(sfdae_advance(solver, 0.3 * k, &t, x.data(), xdot.data()), SFDAE_OK);
      ASSERT_EQ(run.call(0.3 * k), 3);
      EXPECT_EQ(run.values(), x) << k;
      EXPECT_EQ(run.slopes(), xdot) << k;
    }
    EXPECT_EQ(sfdae_destroy(&solver), SFDAE_OK);
  }
}

// Units that differ (columns are scaled), free components, redundant equations; all orders and limits of the index.
TEST_P(SfndaeState, FitsTheDocumentedLength) {
  const auto equations_of = [](int n, bool in_other_units, int more, int fewer) {
    return std::make_shared<NonlinearEquations>(n, [=](const Term& t, const Term* x, const Term* xdot) {
      std::vector<Term> F;
      for (int i = 0; i < n - fewer; ++i) {
        const double unit = in_other_units && i == 0 ? 1e-6 : 1.0;
        F.push_back(xdot[i] / unit + (1.0 + i) * x[i] / unit * (1.0 + x[i] * x[i] / (unit * unit)) - cos(t));
      }
      for (int i = 0; i < more; ++i) F.push_back(2.0 * F[0]);
      return F;
    });
  };
  for (int n = 1; n <= 6; ++n)
    for (int max_index : {0, 1, 5})
      for (int max_order : {1, 3, 5})
        for (int kind = 0; kind < 4; ++kind) {
          SCOPED_TRACE(std::to_string(n) + " " + std::to_string(max_index) + " " + std::to_string(max_order) + " " +
                       std::to_string(kind));
          if (n == 1 && kind == 3) continue;
          SfndaeRun<> run(equations_of(n, kind == 1, kind == 2 ? 2 : 0, kind == 3 ? 1 : 0), GetParam(), max_order,
                          max_index);
          run.x.fill(0.0);
          run.info(3) = 1;
          run.rtol(1) = run.atol(1) = 1e-4;
          ASSERT_EQ(run.call(0.0), 4);
          for (int i = 0; i < 14; ++i) {
            const int ierr = run.call(run.t + 1.0);
            ASSERT_TRUE(ierr == 1 || ierr == 3) << ierr;
            ASSERT_TRUE(run.guards_intact());
          }
        }
}

TEST_P(SfndaeState, TheHighestIndexFitsToo) {
  const KnownNonlinear problem = path_control();
  for (int max_index : {4, 6, 12, 40}) {
    SfndaeRun<> run(problem.equations, GetParam(), 1, max_index);
    run.set_x(problem.start);
    ASSERT_EQ(run.call(0.0), 4);
    for (int k = 1; k <= 10; ++k) ASSERT_EQ(run.call(0.2 * k), 3);
    EXPECT_TRUE(run.guards_intact());
  }
}

// ---- What is no state ----

TEST_P(SfndaeState, ForeignArraysAreRefused) {
  const KnownNonlinear problem = pendulum_problem();
  const SfndaeRun<> start = [&] {
    SfndaeRun<> run = run_of(problem);
    EXPECT_EQ(run.call(0.5), 3);
    return run;
  }();
  const auto refused_after = [&](auto change) {
    SfndaeRun<> run = start;
    change(run);
    const std::vector<double> x = run.values();
    const int ierr = run.call(1.0);
    EXPECT_EQ(run.values(), x);
    EXPECT_EQ(run.t, 0.5);
    return ierr;
  };
  EXPECT_EQ(refused_after([](auto& run) { run.rwork(25) += 1e-3; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.rwork(25) = std::nan(""); }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.iwork(16) = 0; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.iwork(17) += 1; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.rwork(10) = 1e300; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.n = 4; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.m = 4; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.lrw = 19; }), -101);
  EXPECT_EQ(refused_after([](auto& run) { run.method = 3 - run.method; }), -132);
}

// DGELDA's arrays look alike, but are not.
TEST(SfndaeStateBdf, ArraysOfTheOtherRoutineAreRefused) {
  SfndaeRun<> run(pendulum_problem().equations, 1);
  run.set_x(pendulum_problem().start);
  ASSERT_EQ(run.call(0.5), 3);
  double tout = 1.0;
  const auto nothing = [](auto...) {};
  dgelda_(nothing, nothing, nothing, &run.n, &run.t, &tout, run.x.data(), run.xprime.data(), run.cval.data(), nullptr,
          nullptr, run.iwork.data(), &run.liw, run.rwork.data(), &run.lrw, run.rtol.data(), run.atol.data(),
          &run.method, run.info.data(), &run.iwarn, &run.ierr);
  EXPECT_EQ(run.ierr, -101);
}
