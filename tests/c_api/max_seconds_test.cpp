// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of the option max_seconds. Limits are either over at once or shorter than the functions sleep, so that no test
// depends on the speed of the machine.

#include <sfdae/hybrid.hpp>
#include <sfdae/sfdae.hpp>

#include <sfdae/ensemble.h>

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "solver_options.h"

namespace max_seconds {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;

constexpr double over_at_once = 1e-9;

sfdae::NonlinearProblem oscillator() {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression&, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] + x[0];
  };
  return problem;
}

TEST(MaxSeconds, StopACallThatCanBeRepeated) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    sfdae::Options options = sfdae_test::solver_options(1e-6, method);
    sfdae::Solver unlimited(oscillator(), options), solver(oscillator(), options);
    sfdae::Point expected{0.0, {1.0, 0.0}, {}}, point = expected;
    unlimited.start(expected, 10.0);
    unlimited.advance(3.0, expected);
    unlimited.advance(10.0, expected);

    options.max_seconds = over_at_once;
    solver.set_options(options);
    EXPECT_EQ(solver.start(point, 10.0), SFDAE_STOPPED);
    EXPECT_NE(std::string(solver.message()).find("max_seconds"), std::string::npos) << solver.message();
    options.max_seconds = 1e6;
    solver.set_options(options);
    EXPECT_EQ(solver.start(point, 10.0), SFDAE_OK);
    EXPECT_EQ(solver.advance(3.0, point), SFDAE_OK);
    options.max_seconds = over_at_once;
    solver.set_options(options);
    EXPECT_EQ(solver.advance(10.0, point), SFDAE_STOPPED);
    EXPECT_LT(point.t, 10.0);
    EXPECT_NE(std::string(solver.message()).find("max_seconds"), std::string::npos) << solver.message();
    options.max_seconds = 0.0;
    solver.set_options(options);
    EXPECT_EQ(solver.advance(10.0, point), SFDAE_OK);
    // Nothing has been lost.
    EXPECT_EQ(point.x, expected.x);
  }
}

// Each evaluation takes 2 ms: the run needs far more than 5 ms, and each call ends soon after these.
TEST(MaxSeconds, LimitEachCall) {
  sfdae::LinearProblem problem(1, 1);
  problem.E = [](double, int order, sfdae::MatrixRef E) { E(0, 0) = order == 0 ? 1.0 : 0.0; };
  problem.A = [](double, int order, sfdae::MatrixRef A) { A(0, 0) = order == 0 ? -1.0 : 0.0; };
  problem.f = [](double t, int order, sfdae::VectorRef f) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    f[0] = std::sin(t + 1.5707963267948966 * order);
  };
  sfdae::Options options = sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF);
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, {1.0}, {}};
  solver.start(point, 100.0);
  options.max_seconds = 0.005;
  solver.set_options(options);
  double before = 0.0;
  for (int call = 0; call < 5; ++call) {
    EXPECT_EQ(solver.advance(100.0, point), SFDAE_STOPPED);
    EXPECT_GE(point.t, before);
    before = point.t;
  }
  EXPECT_LT(point.t, 100.0);
}

TEST(MaxSeconds, HaveToBeFiniteAndNotNegative) {
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    sfdae::Options options;
    options.max_seconds = wrong;
    EXPECT_THROW(sfdae::Solver(oscillator(), options), sfdae::Error) << wrong;
  }
}

TEST(MaxSeconds, StopEnsembles) {
  sfdae::Options options = sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF);
  options.max_seconds = over_at_once;
  sfdae::Solver solver(oscillator(), options);
  const double x0[] = {1.0, 0.0, 2.0, 0.0, 3.0, 0.0}, end = 10.0;
  double x[6];
  int statuses[3];
  sfdae_ensemble ensemble;
  sfdae_ensemble_init(&ensemble, sizeof ensemble);
  ensemble.num_instances = 3;
  ensemble.x0 = x0;
  ensemble.num_times = 1;
  ensemble.times = &end;
  ensemble.num_threads = 2;
  sfdae_ensemble_results results;
  sfdae_ensemble_results_init(&results, sizeof results);
  results.x = x;
  results.statuses = statuses;
  EXPECT_EQ(sfdae_solve_ensemble(solver.get(), &ensemble, &results), SFDAE_STOPPED);
  for (const int status : statuses) EXPECT_EQ(status, SFDAE_STOPPED);
}

TEST(MaxSeconds, LimitStaysInModes) {
  sfdae::Options options = sfdae_test::solver_options(1e-6, SFDAE_METHOD_BDF);
  sfdae::Solver mode(oscillator(), options);
  sfdae::Hybrid hybrid;
  hybrid.add_mode(mode);
  sfdae::Point point{0.0, {1.0, 0.0}, {}};
  hybrid.start(0, point, 10.0);
  options.max_seconds = over_at_once;
  mode.set_options(options);
  EXPECT_EQ(hybrid.advance(10.0, point), SFDAE_STOPPED);
  EXPECT_NE(std::string(hybrid.message()).find("max_seconds"), std::string::npos) << hybrid.message();
  options.max_seconds = 0.0;
  mode.set_options(options);
  EXPECT_EQ(hybrid.advance(10.0, point), SFDAE_OK);
  EXPECT_NEAR(point.x[0], std::cos(10.0), 1e-4);
}

}  // namespace
}  // namespace max_seconds
