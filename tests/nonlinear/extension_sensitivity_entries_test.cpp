// SPDX-License-Identifier: BSD-3-Clause
// Sensitivities along the minimal extension where derivatives vary by one thing only: time, a parameter that is
// changed, a branch. Those that are numbers are evaluated once, and pairs of states x_a' = x_b eliminated, so that
// what only looks like one of these has to be told apart.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::largest_error;

enum class Slope { state, of_time, of_parameter, of_state, third_order, of_branch };

constexpr int algebraic = 14, n = 5 + algebraic;

// Three states, x_3 = sin(t) x_0 + p and x_4 = x_3', of index 2; the others follow.
sfdae::NonlinearProblem problem_of(Slope kind) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [kind](const Expression& t, auto x, auto xdot, auto F) {
    const Expression p = sfdae::parameter(t, "p", 0.7), q = sfdae::parameter(t, "q", 1.0),
                     r = sfdae::parameter(t, "r", 1.5);
    // All are x_1 at t = 0.
    const Expression slope = kind == Slope::of_time        ? cos(t) * x[1]
                             : kind == Slope::of_parameter ? q * x[1]
                             : kind == Slope::of_state     ? x[1] * (1.0 + x[0] * x[0])
                                                           : 1.0 * x[1];
    F[0] = xdot[0] - slope;
    const Expression beyond = x[0] - 0.2,
                     force = kind == Slope::of_branch ? choose(beyond, 3.0 * beyond, r * beyond) : r * beyond;
    if (kind == Slope::third_order) {
      F[1] = xdot[1] - x[2];
      F[2] = xdot[2] + x[2] + 3.0 * x[1] + force + p * sin(x[0]);
    } else {
      F[1] = xdot[1] + p * q * x[0] + force;
      F[2] = xdot[2] - x[1] + cos(3.0 * t) * r * x[2];
    }
    F[3] = x[3] - sin(t) * x[0] - p;
    F[4] = xdot[3] - x[4];
    for (int k = 0; k < algebraic; ++k)
      F[5 + k] = (2.0 + sin(0.1 * k + t)) * x[5 + k] - p * x[k % 3] - q * (k > 0 ? x[4 + k] : x[4]);
  };
  return problem;
}

struct Found {
  Matrix S[2];
  bool is_extended = true;
  long factorizations_beyond_steps = 0;
};

// With the parameters as they are, and with others.
Found run(Slope kind, int method, int structure) {
  sfdae::Options options = sfdae_test::solver_options(1e-10, method);
  options.structure = structure;
  sfdae::Solver solver(problem_of(kind), options);
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p", "q", "r"};
  Found found;
  for (int time = 0; time < 2; ++time) {
    if (time == 1) {
      solver.set_parameter("p", 1.3);
      solver.set_parameter("q", 0.6);
    }
    if (time == 0) solver.set_sensitivities(wanted);
    Point point{0.0, std::vector<double>(std::size_t(n), 0.0), {}};
    point.x[0] = 0.5;
    solver.start(point, 3.0);
    solver.advance(3.0, point);
    found.S[time] = solver.sensitivities(3.0).S;
    const auto statistics = solver.statistics();
    found.factorizations_beyond_steps +=
        solver.sensitivity_statistics().factorizations - statistics.steps - statistics.error_failures;
    found.is_extended = found.is_extended && solver.report().find("in the factors") != std::string::npos;
  }
  return found;
}

class SensitivityEntries : public testing::TestWithParam<Slope> {};

TEST_P(SensitivityEntries, AreThoseOfTheArray) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    SCOPED_TRACE(method);
    const Found found = run(GetParam(), method, SFDAE_STRUCTURE_REQUIRED),
                expected = run(GetParam(), method, SFDAE_STRUCTURE_OFF);
    EXPECT_TRUE(found.is_extended);
    EXPECT_FALSE(expected.is_extended);
    // A few of each start, at kinks of branches, too; stages that are not solved by their states are factored as one
    // system.
    EXPECT_LE(found.factorizations_beyond_steps, GetParam() == Slope::of_branch ? 20 : 12);
    // Steps across the kinks of branches are of low order.
    const double error = GetParam() == Slope::of_branch ? 1e-4 : 1e-6;
    for (int time = 0; time < 2; ++time) EXPECT_LE(largest_error(found.S[time], expected.S[time]), error) << time;
    // What parameters change is seen.
    EXPECT_GE(largest_error(found.S[0], found.S[1]), 1e-2);
  }
}

INSTANTIATE_TEST_SUITE_P(Slopes, SensitivityEntries,
                         testing::Values(Slope::state, Slope::of_time, Slope::of_parameter, Slope::of_state,
                                         Slope::third_order, Slope::of_branch));

}  // namespace
