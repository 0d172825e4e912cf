// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities of recorded equations whose steps are sparse systems, against differences of solutions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::chain_of_rods;
using sfdae_test::diffusion;
using sfdae_test::solver_options;

struct Problem {
  sfdae::NonlinearProblem equations;
  std::vector<double> x;
  double end;
};

Problem chain() {
  constexpr int links = 3;
  std::vector<double> x(5 * links, 0.0);
  // The first hangs down, and its horizontal position alone can be a state; others stand off.
  for (int i = 0; i < links; ++i) {
    x[std::size_t(5 * i)] = 0.8 * i;
    x[std::size_t(5 * i + 1)] = -1.0 - 0.6 * i;
  }
  return {chain_of_rods(links), std::move(x), 2.0};
}

Problem diffusion_of_a_wave() {
  constexpr int cells = 15;
  return {diffusion(cells), std::vector<double>(2 * cells, 0.0), 3.0};
}

// Where the problem stands at its end with this value of a parameter.
std::vector<double> end_with(const Problem& problem, const std::string& parameter, double value) {
  sfdae::Solver solver(problem.equations, solver_options(1e-12, SFDAE_METHOD_RADAU));
  solver.set_parameter(parameter, value);
  Point point{0.0, problem.x, {}};
  solver.start(point, problem.end);
  solver.advance(problem.end, point);
  return point.x;
}

class SparseSensitivities : public testing::TestWithParam<int> {
 protected:
  static Problem problem() { return GetParam() == 0 ? chain() : diffusion_of_a_wave(); }
  static sfdae::Solver started(const Problem& problem, Point& point, bool error_test, int method = SFDAE_METHOD_BDF) {
    sfdae::Options options = solver_options(1e-9, method);
    options.leading_term = SFDAE_LEADING_IDENTITY;  // x by the whole array
    sfdae::Solver solver(problem.equations, options);
    sfdae::Sensitivities wanted;
    wanted.parameters = {"p", "q"};
    wanted.error_test = error_test;
    solver.set_sensitivities(wanted);
    point = {0.0, problem.x, {}};
    solver.start(point, problem.end);
    return solver;
  }
};
INSTANTIATE_TEST_SUITE_P(Problems, SparseSensitivities, testing::Values(0, 1));

TEST_P(SparseSensitivities, AgreeWithDifferences) {
  const Problem problem = SparseSensitivities::problem();
  for (const auto& [method, error_test] :
       {std::pair(SFDAE_METHOD_BDF, false), {SFDAE_METHOD_BDF, true}, {SFDAE_METHOD_RADAU, false}}) {
    Point point;
    sfdae::Solver solver = started(problem, point, error_test, method);
    solver.advance(problem.end, point);
    const Matrix S = solver.sensitivities(problem.end).S;
    for (int j = 0; j < 2; ++j) {
      const std::string name = j == 0 ? "p" : "q";
      const double value = solver.parameter(name), h = 1e-4 * value;
      const std::vector<double> above = end_with(problem, name, value + h),
                                below = end_with(problem, name, value - h);
      double size = 0.0;
      for (int i = 0; i < S.rows(); ++i) size = std::max(size, std::abs(S(i, j)));
      for (int i = 0; i < S.rows(); ++i) {
        const double difference = (above[std::size_t(i)] - below[std::size_t(i)]) / (2.0 * h);
        // h^2 and 1e-12 / h are errors of the differences.
        EXPECT_NEAR(S(i, j), difference, 1e-5 * size)
            << name << ", " << i << ", method " << method << ", error test " << error_test;
      }
    }
  }
}

TEST_P(SparseSensitivities, NeedNoEliminationInEachStep) {
  const Problem problem = SparseSensitivities::problem();
  Point point;
  sfdae::Solver solver = started(problem, point, false);
  solver.advance(problem.end, point);
  EXPECT_GT(solver.sensitivity_statistics().factorizations, 20);
  EXPECT_LE(solver.sensitivity_statistics().linearizations, 3);
}

TEST_P(SparseSensitivities, AreTheSameWithoutSlopes) {
  const Problem problem = SparseSensitivities::problem();
  Point point;
  sfdae::Solver solver = started(problem, point, false);
  double before = point.t;
  for (int step = 0; step < 30; ++step) {
    before = point.t;
    ASSERT_EQ(solver.step(problem.end, point), SFDAE_STEP_TAKEN);
  }
  for (double t : {point.t, 0.4 * before + 0.6 * point.t}) {
    const sfdae::SensitivityValues with = solver.sensitivities(t), without = solver.sensitivities(t, false);
    EXPECT_EQ(without.Sdot.columns(), 0);
    double size = 0.0;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < with.S.rows(); ++i) size = std::max(size, std::abs(with.S(i, j)));
    // At the end of the step it is that of the step, else one that is put on the constraints at x interpolated.
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < with.S.rows(); ++i) EXPECT_NEAR(with.S(i, j), without.S(i, j), 1e-7 * size);
  }
}

// Stages are linearized side by side: twice each where equations contain products of x' and parameters, as those of
// the chain do, and not a third time for what each of them needs alone.
TEST(SparseSensitivities, LinearizeStagesOfRadauSideBySide) {
  const Problem problem = chain();
  const auto linearizations = [&](bool with_sensitivities, long& steps) {
    sfdae::Solver solver(problem.equations, solver_options(1e-9, SFDAE_METHOD_RADAU));
    sfdae::Sensitivities wanted;
    if (with_sensitivities) wanted.parameters = {"p", "q"};
    solver.set_sensitivities(wanted);
    Point point{0.0, problem.x, {}};
    solver.start(point, problem.end);
    const long before = solver.statistics().linearizations;
    solver.advance(problem.end, point);
    steps = solver.statistics().steps;
    return solver.statistics().linearizations - before;
  };
  long steps = 0, same_steps = 0;
  const long own = linearizations(false, steps), all = linearizations(true, same_steps);
  ASSERT_EQ(steps, same_steps);
  // Three, five or seven stages; some steps are done one by one while pivots are chosen.
  EXPECT_LE(double(all - own), 2.2 * 7 * double(steps));
  EXPECT_GE(all - own, 2 * 3 * steps);
}

// p x_0' = x_1 - x_0, 0 = x_1, 0 = x_0 + x_2 - sin t: F_p contains x', so that the whole array is eliminated, which
// is the same at all stages of all steps. dx_0/dp = t x_0 / p^2.
TEST(ConstantMatrices, AreEliminatedOnce) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = sfdae::parameter(t, "p", 2.0) * xdot[0] + x[0] - x[1];
    F[1] = x[1] + 0.0 * t;
    F[2] = x[0] + x[2] - sin(t);
  };
  sfdae::Solver solver(problem, solver_options(1e-9, SFDAE_METHOD_RADAU));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p"};
  solver.set_sensitivities(wanted);
  Point point{0.0, {1.0, 0.0, -1.0}, {}};
  solver.start(point, 3.0);
  const long before = solver.statistics().linearizations;
  solver.advance(3.0, point);
  const sfdae::Statistics counts = solver.statistics();
  EXPECT_LE(counts.linearizations - before, 3 * counts.steps);  // those of x; each step has three stages at least
  const Matrix S = solver.sensitivities(3.0).S;
  const double expected = 3.0 * std::exp(-1.5) / 4.0;
  EXPECT_NEAR(S(0, 0), expected, 1e-7);
  EXPECT_NEAR(S(1, 0), 0.0, 1e-12);
  EXPECT_NEAR(S(2, 0), -expected, 1e-7);
}

}  // namespace
