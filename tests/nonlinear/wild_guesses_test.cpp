// SPDX-License-Identifier: BSD-3-Clause
// Where a diode begins to conduct guesses are off by volts, and conductances there larger by many orders of magnitude
// than those of any solution: changes with such a matrix look as if they had converged at once
// (docs/design/iteration_matrices.md).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "sfdae/sfdae.hpp"

#include "solver_options.h"

namespace sfdae_test {

namespace {

using sfdae::Expression;

// x = (v, i, u): a source behind a resistor, a diode, a capacitor; voltages in units of 3.4 V.
sfdae::NonlinearProblem rectifier(double amplitude) {
  constexpr double unit = 3.37, R = 411.0, C = 1.23e-6, period = 0.00289;
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [amplitude](const Expression& t, auto x, auto xdot, auto F) {
    const Expression source = amplitude * sin(2.0 * std::numbers::pi / period * t);
    F[0] = (source - x[0] * unit) / R - x[1];
    F[1] = x[1] - 1e-12 * (exp((x[0] - x[2]) * unit / 0.0259) - 1.0);
    F[2] = C * unit * xdot[2] - x[1];
  };
  return problem;
}

// Status, and the largest residual of the first two equations at ends of steps, in amperes.
struct GuessOutcome {
  bool has_ended = false;
  double residual = 0.0;
};
GuessOutcome integrate(double amplitude, int method, int structure) {
  sfdae::Options options = solver_options(1e-3, method);
  options.structure = structure;
  sfdae::Solver solver(rectifier(amplitude), options);
  sfdae::Point point{0.0, {0.0, 0.0, 0.0}, {}};
  GuessOutcome outcome;
  const double end = 0.0289;
  try {
    solver.start(point, end);
    for (int status = SFDAE_STEP_TAKEN; status != SFDAE_OK;) {
      status = solver.step(end, point);
      const double of_diode = point.x[1] - 1e-12 * (std::exp((point.x[0] - point.x[2]) * 3.37 / 0.0259) - 1.0);
      outcome.residual = std::fmax(outcome.residual, std::fabs(of_diode));
    }
    outcome.has_ended = true;
  } catch (const sfdae::Error&) {
  }
  return outcome;
}

class WildGuesses : public testing::TestWithParam<std::tuple<int, int>> {};
INSTANTIATE_TEST_SUITE_P(Ways, WildGuesses,
                         testing::Combine(testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU),
                                          testing::Values(SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED)));

}  // namespace

TEST_P(WildGuesses, DoNotPassForSolutions) {
  const auto [method, structure] = GetParam();
  int failed = 0, wrong = 0;
  for (int k = 0; k < 40; ++k) {
    const GuessOutcome outcome = integrate(5.0 + 0.2 * k, method, structure);
    failed += outcome.has_ended ? 0 : 1;
    wrong += outcome.residual > 0.1 ? 1 : 0;
  }
  EXPECT_LE(failed, 2);  // 2 to 32 when two changes were enough, and 13 to 40 wrong
  EXPECT_EQ(wrong, 0);
}

}  // namespace sfdae_test
