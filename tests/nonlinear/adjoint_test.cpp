// SPDX-License-Identifier: BSD-3-Clause
// Gradients by the adjoint of recorded equations of any index, against exact ones and forward sensitivities.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "family_run.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::driven_by_a_table;
using sfdae_test::largest_error;
using sfdae_test::scaled_count;
using sfdae_test::solver_options;
using sfdae_test::TransformedSystem;

using Times = std::vector<double>;

// Two functionals.
Matrix weights_for(int n, const Times& times, unsigned seed) {
  Matrix weights(n, 2 * int(times.size()));
  for (int j = 0; j < weights.columns(); ++j)
    for (int i = 0; i < n; ++i) weights(i, j) = std::sin(1.0 + 2.3 * i + 1.7 * j + seed);
  return weights;
}

// sum_k S_k^T w_k.
Matrix gradient_of(const std::vector<Matrix>& S, const Matrix& weights) {
  const int points = int(S.size());
  Matrix gradient(S[0].columns(), 2);
  for (int q = 0; q < 2; ++q)
    for (int k = 0; k < points; ++k)
      for (int j = 0; j < gradient.rows(); ++j)
        for (int i = 0; i < weights.rows(); ++i)
          gradient(j, q) += S[std::size_t(k)](i, j) * weights(i, k + q * points);
  return gradient;
}

// A run through these times, the first of which is the start; or to the last one alone, with the others within steps.
struct Journey {
  sfdae::Sensitivities wanted;
  Point point;
  Times times;
  bool passes_by = false;
  struct Direction {
    double from, to;
  };
};

template <class Problem>
Matrix adjoint_gradient(const Problem& problem, const sfdae::Options& options, Journey journey,
                        const Matrix& weights) {
  sfdae::Solver solver(problem, options);
  journey.wanted.adjoint = true;
  solver.set_sensitivities(journey.wanted);
  solver.start(journey.point, journey.times.back());
  for (double t : journey.times)
    if (t != journey.times.front() && (!journey.passes_by || t == journey.times.back()))
      solver.advance(t, journey.point);
  return solver.gradient(journey.times, weights);
}

// The same steps, as there is one time only, at which they end.
template <class Problem>
Matrix forward_gradient(const Problem& problem, sfdae::Options options, Journey journey, const Matrix& weights) {
  options.use_stop_time = 1;
  options.stop_time = journey.times.back();
  // As with the adjoint.
  if (std::is_same_v<Problem, sfdae::NonlinearProblem>) options.structure = SFDAE_STRUCTURE_OFF;
  sfdae::Solver solver(problem, options);
  solver.set_sensitivities(journey.wanted);
  solver.start(journey.point, journey.times.back());
  std::vector<Matrix> S = {solver.sensitivities(journey.times.front(), false).S};
  for (int status = SFDAE_STEP_TAKEN; status != SFDAE_OK;) {
    status = solver.step(journey.times.back(), journey.point);
    const double direction = journey.times.back() < journey.times.front() ? -1.0 : 1.0;
    while (S.size() < journey.times.size() && (journey.times[S.size()] - journey.point.t) * direction <= 0.0)
      S.push_back(solver.sensitivities(journey.times[S.size()], false).S);
  }
  return gradient_of(S, weights);
}

// ---- Random systems --------------------------------------------------------------------------------------------

class RandomGradients : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, RandomGradients, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

TEST_P(RandomGradients, AreExactForAnyIndex) {
  int solved[4] = {0, 0, 0, 0};
  for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(150, 20)); seed <= last; ++seed) {
    const TransformedSystem system(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    Journey journey{{}, {}, {0.0, 0.7, 1.3, 2.0}, seed % 2 == 0};
    journey.wanted.parameters = {"p", "q"};
    std::vector<Matrix> S(4);
    std::vector<double> x;
    for (std::size_t k = 0; k < 4; ++k) system.exact(journey.times[k], k == 0 ? journey.point.x : x, S[k]);
    journey.wanted.directions = S[0];
    const Matrix weights = weights_for(system.n(), journey.times, seed);
    const Matrix gradient = adjoint_gradient(system.problem(), solver_options(1e-9, GetParam()), journey, weights);
    EXPECT_LE(largest_error(gradient, gradient_of(S, weights)), 1e-6);
    ++solved[std::min(system.mu(), 3)];
  }
  for (int count : solved) EXPECT_GE(count, 2);
}

// Start values of the second piece as parameters; what it has by these are weights at the end of the first one.
TEST_P(RandomGradients, GoThroughPieces) {
  for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(50, 5)); seed <= last; ++seed) {
    const TransformedSystem system(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    const int n = system.n();
    const sfdae::Options options = solver_options(1e-9, GetParam());
    Journey first{{}, {}, {0.0, 1.0}}, second{{}, {}, {1.0, 2.0}};
    first.wanted.parameters = second.wanted.parameters = {"p", "q"};
    Matrix S_start, S_middle, S_end;
    std::vector<double> x;
    system.exact(0.0, first.point.x, S_start);
    system.exact(1.0, second.point.x, S_middle);
    system.exact(2.0, x, S_end);
    second.point.t = 1.0;
    first.wanted.directions = S_start;
    second.wanted.parameters.resize(std::size_t(2 + n));
    second.wanted.directions = Matrix(n, 2 + n);
    for (int j = 0; j < n; ++j) second.wanted.directions(j, 2 + j) = 1;
    Matrix at_end(n, 4), at_middle(n, 4);
    for (int q = 0; q < 2; ++q)
      for (int i = 0; i < n; ++i) at_end(i, 1 + 2 * q) = std::cos(1.0 + i + 3 * q + seed);
    const Matrix later = adjoint_gradient(system.problem(), options, second, at_end);
    for (int q = 0; q < 2; ++q)
      for (int i = 0; i < n; ++i) at_middle(i, 1 + 2 * q) = later(2 + i, q);
    Matrix gradient = adjoint_gradient(system.problem(), options, first, at_middle);
    for (int q = 0; q < 2; ++q)
      for (int j = 0; j < 2; ++j) gradient(j, q) += later(j, q);
    EXPECT_LE(largest_error(gradient, gradient_of({S_start, S_end}, at_end)), 1e-6);
  }
}

// To rounding, whatever the tolerance, as it is the adjoint of the steps.
TEST_P(RandomGradients, AreThoseOfForwardSensitivities) {
  for (double tolerance : {1e-4, 1e-8}) {
    for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(60, 6)); seed <= last; ++seed) {
      const TransformedSystem system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
      Journey journey{{}, {}, {0.0, 2.0}};
      journey.wanted.parameters = {"", "q", "p"};
      journey.wanted.directions = Matrix(system.n(), 3);
      for (int i = 0; i < system.n(); ++i) journey.wanted.directions(i, 0) = std::cos(2.0 * i + seed);
      Matrix unused;
      system.exact(0.0, journey.point.x, unused);
      for (std::size_t i = 0; i < journey.point.x.size(); ++i)
        journey.point.x[i] += 0.1 * std::sin(3.0 * double(i) + seed);
      const Matrix weights = weights_for(system.n(), journey.times, seed);
      const sfdae::Options options = solver_options(tolerance, GetParam());
      const Matrix gradient = adjoint_gradient(system.problem(), options, journey, weights);
      EXPECT_LE(largest_error(gradient, forward_gradient(system.problem(), options, journey, weights)), 1e-11);
    }
  }
}

// At points within steps, several of them in one. With BDF x is the polynomial through the same points, made
// consistent; with Radau forward sensitivities are linearized where x is interpolated, those of the adjoint where the
// shorter step leads.
TEST_P(RandomGradients, AreThoseOfForwardSensitivitiesWithinSteps) {
  for (double tolerance : {1e-4, 1e-9}) {
    for (unsigned seed = 1, last = static_cast<unsigned>(scaled_count(20, 3)); seed <= last; ++seed) {
      const TransformedSystem system(seed);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
      Journey journey{{}, {}, {0.0, 1e-4, 0.05, 0.3, 0.301, 0.77, 1.234, 1.9, 1.99, 2.0}, true};
      journey.wanted.parameters = {"", "q", "p"};
      journey.wanted.directions = Matrix(system.n(), 3);
      for (int i = 0; i < system.n(); ++i) journey.wanted.directions(i, 0) = std::cos(2.0 * i + seed);
      Matrix unused;
      system.exact(0.0, journey.point.x, unused);
      const Matrix weights = weights_for(system.n(), journey.times, seed);
      const sfdae::Options options = solver_options(tolerance, GetParam());
      const Matrix gradient = adjoint_gradient(system.problem(), options, journey, weights),
                   forward = forward_gradient(system.problem(), options, journey, weights);
      EXPECT_LE(largest_error(gradient, forward),
                GetParam() == SFDAE_METHOD_BDF ? 1e-3 * tolerance + 1e-11 : tolerance);
    }
  }
}

// ---- Other problems --------------------------------------------------------------------------------------------

// Expects the gradient of two functionals of end and start values to be that of forward sensitivities.
template <class Problem>
void expect_forward_gradient(const Problem& problem, const sfdae::Options& options, const Journey& journey,
                             double agreement = 1e-11) {
  const Matrix weights = weights_for(int(journey.point.x.size()), journey.times, 1);
  const Matrix gradient = adjoint_gradient(problem, options, journey, weights);
  EXPECT_LE(largest_error(gradient, forward_gradient(problem, options, journey, weights)), agreement);
}

class Gradients : public testing::TestWithParam<int> {
 protected:
  // With BDF forward sensitivities are discretized in states where the structure of equations is confirmed.
  static double agreement(double tolerance) { return GetParam() == SFDAE_METHOD_BDF ? 10.0 * tolerance : 1e-10; }
};
INSTANTIATE_TEST_SUITE_P(Methods, Gradients, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// Diffusion with a reaction of its own rate in each cell: sparse matrices with BDF.
sfdae::NonlinearProblem reaction(int n) {
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [n](const Expression& t, auto x, auto xdot, auto F) {
    const Expression width = sfdae::parameter(t, "width", 0.1);
    for (int i = 0; i < n; ++i) {
      const Expression left = i > 0 ? x[i - 1] : 1.0 + 0.0 * t, right = i + 1 < n ? x[i + 1] : 0.0 * t;
      const Expression rate = sfdae::parameter(t, std::string("rate").append(std::to_string(i)), 1.0 + 0.1 * (i % 7));
      F[i] =
          (1.0 + 0.1 * x[i]) * xdot[i] - (left - 2.0 * x[i] + right) / (width * width) - rate * x[i] * (1.0 - x[i]);
    }
  };
  return problem;
}

TEST_P(Gradients, HaveManyParameters) {
  constexpr int n = 60;
  Journey journey{{}, {0.0, std::vector<double>(n, 0.3), {}}, {0.0, 1.5}};
  journey.wanted.parameters = {"width"};
  for (int i = 0; i < n; ++i) journey.wanted.parameters.push_back("rate" + std::to_string(i));
  expect_forward_gradient(reaction(n), solver_options(1e-6, GetParam()), journey);
}

// Tables are evaluated on the side of a kink that the step was on.
TEST_P(Gradients, KeepToTheirSideOfKinks) {
  const sfdae::NonlinearProblem problem = driven_by_a_table();
  Journey journey{{}, {0.0, {0.5, 0.2, 0.0}, {}}, {0.0, 2.0}};
  journey.wanted.parameters = {"p", "q", ""};
  journey.wanted.directions = Matrix(3, 3);
  journey.wanted.directions(0, 2) = 1.0;
  expect_forward_gradient(problem, solver_options(1e-7, GetParam()), journey, agreement(1e-7));
  journey.times = {0.0, 0.2, 0.45, 0.55, 1.2, 1.3, 1.9, 2.0};
  journey.passes_by = true;
  expect_forward_gradient(problem, solver_options(1e-7, GetParam()), journey, 1e-6);
}

// Two pendulums one below the other that turn over, with a mass that depends on the position: coordinates take turns in
// determining the others, and derivatives by x contain x'.
TEST_P(Gradients, AreThoseOfPendulumsThatTurnOver) {
  sfdae::NonlinearProblem problem(10, 10);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression g = sfdae::parameter(t, "g", 9.81), m = sfdae::parameter(t, "m", 0.5),
                     added = sfdae::parameter(t, "added", 0.2);
    for (int i = 0; i < 2; ++i) {
      const Expression L = sfdae::parameter(t, i == 0 ? "L0" : "L1", 0.5 + 0.3 * i);
      Expression length = 0.0 * t;
      for (int k = 0; k < 2; ++k) {
        const auto distance = [&](int j) { return j == 0 ? 1.0 * x[k] : x[5 * j + k] - x[5 * j - 5 + k]; };
        F[5 * i + k] = xdot[5 * i + k] - x[5 * i + 2 + k];
        F[5 * i + 2 + k] = (m + added * x[5 * i] * x[5 * i]) * xdot[5 * i + 2 + k] + distance(i) * x[5 * i + 4];
        if (i == 0) F[2 + k] = F[2 + k] - distance(1) * x[9];
        if (k == 1) F[5 * i + 3] = F[5 * i + 3] + m * g;
        length = length + distance(i) * distance(i);
      }
      F[5 * i + 4] = length - L * L;
    }
  };
  Journey journey{{}, {0.0, {0.5, 0, 0, 7, 0, 1.3, 0, 0, 17, 0}, {}}, {0.0, 1.5}};
  journey.wanted.parameters = {"g", "m", "added", "L0", "L1", ""};
  journey.wanted.directions = Matrix(10, 6);
  journey.wanted.directions(3, 5) = 1.0;
  expect_forward_gradient(problem, solver_options(1e-7, GetParam()), journey,
                          GetParam() == SFDAE_METHOD_BDF ? 1e-4 : 1e-9);
}

TEST_P(Gradients, AreThoseOfMechanicalSystems) {
  // A rod and a point at its end, in SI units: (px, py, angle), two constraints.
  sfdae::MultibodyProblem system(3, 2);
  system.equations = [](const Expression& t, auto q, auto v, const auto& to) {
    const Expression m = sfdae::parameter(t, "m", 2.0), length = sfdae::parameter(t, "length", 0.7);
    to.M(0, 0) = m;
    to.M(1, 1) = m;
    to.M(2, 2) = sfdae::parameter(t, "J", 0.05);
    to.f[1] = -9.81 * m;
    to.f[2] = -sfdae::parameter(t, "friction", 0.02) * v[2];
    to.g[0] = q[0] - length * cos(q[2]);
    to.g[1] = q[1] - length * sin(q[2]);
  };
  Journey journey{{}, {0.0, {0.7, 0, 0, 0, 0, 0, 0, 0}, {}}, {0.0, 1.0}};
  journey.wanted.parameters = {"m", "J", "friction", "length"};
  expect_forward_gradient(system, solver_options(1e-6, GetParam()), journey, agreement(1e-6));
}

// The method changes on the way, and S starts anew from what it was.
TEST(AutomaticGradients, GoOnWhereTheMethodChanges) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression mu = sfdae::parameter(t, "mu", 8.0);
    F[0] = xdot[0] - x[1];
    F[1] = xdot[1] - mu * (1.0 - x[0] * x[0]) * x[1] + x[0];
    F[2] = x[2] - x[0] * x[1];
  };
  Journey journey{{}, {0.0, {2.0, 0.0, 0.0}, {}}, {0.0, 30.0}};
  journey.wanted.parameters = {"mu"};
  expect_forward_gradient(problem, solver_options(1e-6, SFDAE_METHOD_AUTOMATIC), journey, 1e-8);
}

// Backward in time, in units far from 1: a diode circuit with microfarads and nanoseconds.
TEST_P(Gradients, AreThoseInAnyUnitsAndDirection) {
  sfdae::NonlinearProblem problem(3, 3);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression C = sfdae::parameter(t, "C", 1e-9), R = sfdae::parameter(t, "R", 1e3);
    F[0] = C * xdot[0] + x[2];
    F[1] = x[0] - x[1] - R * x[2];
    F[2] = x[2] - 1e-12 * (exp(x[1] / 0.05) - 1.0);
  };
  for (const Journey::Direction& leg : {Journey::Direction{0.0, 2e-6}, Journey::Direction{1e-7, 0.0}}) {
    Journey journey{{}, {leg.from, {1.2, 0.5, 1e-6}, {}}, {leg.from, leg.to}};
    journey.wanted.parameters = {"C", "R", ""};
    journey.wanted.directions = Matrix(3, 3);
    journey.wanted.directions(0, 2) = 1.0;
    sfdae::Options options = solver_options(1e-6, GetParam());
    const Matrix weights = weights_for(3, journey.times, 1);
    const Matrix gradient = adjoint_gradient(problem, options, journey, weights),
                 forward = forward_gradient(problem, options, journey, weights);
    for (int q = 0; q < 2; ++q)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(gradient(j, q), forward(j, q), 1e-10 * std::abs(forward(j, q))) << "parameter " << j;
    // Within steps.
    const double length = leg.to - leg.from;
    journey.times = {leg.from, leg.from + 0.1 * length, leg.from + 0.4 * length, leg.from + 0.9 * length, leg.to};
    journey.passes_by = true;
    const Matrix more = weights_for(3, journey.times, 1), within = adjoint_gradient(problem, options, journey, more),
                 expected = forward_gradient(problem, options, journey, more);
    for (int q = 0; q < 2; ++q)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(within(j, q), expected(j, q), 1e-5 * std::abs(expected(j, q))) << "parameter " << j;
  }
}

// The integral of v^2 along a pendulum is an unknown more; against differences of it.
TEST_P(Gradients, AreThoseOfIntegrals) {
  sfdae::NonlinearProblem problem(6, 6);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression g = sfdae::parameter(t, "g", 9.81), L = sfdae::parameter(t, "L", 1.0);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + 2.0 * x[0] * x[4];
    F[3] = xdot[3] + 2.0 * x[1] * x[4] + g;
    F[4] = x[0] * x[0] + x[1] * x[1] - L * L;
    F[5] = xdot[5] - x[2] * x[2] - x[3] * x[3];
  };
  Journey journey{{}, {0.0, {0.6, -0.8, 0, 0, 0, 0}, {}}, {0.0, 2.0}};
  journey.wanted.parameters = {"g", "L"};
  journey.wanted.directions = Matrix(6, 2);
  journey.wanted.directions(0, 1) = 0.6;
  journey.wanted.directions(1, 1) = -0.8;
  Matrix weights(6, 4);
  weights(5, 1) = 1.0;
  const Matrix gradient = adjoint_gradient(problem, solver_options(1e-9, GetParam()), journey, weights);
  EXPECT_EQ(gradient(0, 1), 0.0);
  const double h = 1e-4;
  for (int j = 0; j < 2; ++j) {
    double ends[2];
    for (int side = 0; side < 2; ++side) {
      const double change = side == 0 ? -h : h;
      sfdae::Solver solver(problem, solver_options(1e-12, SFDAE_METHOD_RADAU));
      solver.set_parameter(j == 0 ? "g" : "L", (j == 0 ? 9.81 : 1.0) + change);
      Point point = journey.point;
      if (j == 1) point.x[0] *= 1.0 + change, point.x[1] *= 1.0 + change;
      solver.start(point, 2.0);
      solver.advance(2.0, point);
      ends[side] = point.x[5];
    }
    EXPECT_NEAR(gradient(j, 0), (ends[1] - ends[0]) / (2 * h), 2e-6) << "parameter " << j;
  }
}

// Gradients may be asked for again, with other weights, and the integration goes on.
TEST_P(Gradients, CanBeRepeated) {
  sfdae::Solver solver(reaction(12), solver_options(1e-6, GetParam()));
  sfdae::Sensitivities wanted;
  wanted.parameters = {"width", "rate3"};
  wanted.adjoint = true;
  solver.set_sensitivities(wanted);
  Point point{0.0, std::vector<double>(12, 0.3), {}};
  solver.start(point, 2.0);
  Matrix weights(12, 1);
  weights(4, 0) = 1.0;
  EXPECT_EQ(solver.gradient({0.0}, weights)(0, 0), 0.0);
  solver.advance(1.0, point);
  const Matrix first = solver.gradient({1.0}, weights);
  solver.advance(2.0, point);
  const Matrix again = solver.gradient({1.0}, weights);
  EXPECT_NE(first(0, 0), 0.0);
  for (int j = 0; j < 2; ++j) EXPECT_EQ(first(j, 0), again(j, 0));
  EXPECT_THROW(solver.gradient({2.5}, weights), sfdae::Error);
  EXPECT_THROW(solver.sensitivities(2.0), sfdae::Error);
  const sfdae::SensitivityStatistics statistics = solver.sensitivity_statistics();
  EXPECT_EQ(statistics.kept_steps, solver.statistics().steps);
  EXPECT_GT(statistics.kept_bytes, 8.0 * 24 * double(statistics.kept_steps));
  // With a functional that is a sum, gradients are sums.
  Matrix both(12, 2);
  both(4, 0) = 1.0;
  both(7, 1) = -2.0;
  const Matrix sum = solver.gradient({1.0, 2.0}, both);
  Matrix last(12, 1);
  last(7, 0) = -2.0;
  const Matrix second = solver.gradient({2.0}, last);
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(sum(j, 0), first(j, 0) + second(j, 0), 1e-13 * (1.0 + std::abs(sum(j, 0))));
}

}  // namespace
