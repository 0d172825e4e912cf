// SPDX-License-Identifier: BSD-3-Clause
// Gradients of hybrid systems by the adjoint, against forward sensitivities over the same steps and transitions, and
// formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "hybrid_systems.h"
#include "sfdae/hybrid.hpp"
#include "solver_options.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::ball;
using sfdae_test::by;
using sfdae_test::RandomModes;
using sfdae_test::rope;
using sfdae_test::solver_options;
using sfdae_test::System;
using sfdae_test::unit_directions;
using Vector = std::vector<double>;

Matrix weights_for(int n, int columns, int seed = 0) {
  Matrix weights(n, columns);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < n; ++i) weights(i, j) = std::sin(1.0 + 2.3 * i + 1.7 * j + seed);
  return weights;
}

// Of functionals that have weights at as many times as there are S.
Matrix gradient_of(const std::vector<Matrix>& S, const Matrix& weights) {
  const int times = static_cast<int>(S.size());
  Matrix gradient(S[0].columns(), weights.columns() / times);
  for (int q = 0; q < gradient.columns(); ++q)
    for (int j = 0; j < gradient.rows(); ++j)
      for (int k = 0; k < times; ++k)
        for (int i = 0; i < weights.rows(); ++i)
          gradient(j, q) += weights(i, k + times * q) * S[std::size_t(k)](i, j);
  return gradient;
}

// Relative to the largest entry.
double difference(const Matrix& a, const Matrix& b) {
  double size = 0.0, largest = 0.0;
  for (int q = 0; q < a.columns(); ++q)
    for (int j = 0; j < a.rows(); ++j) {
      size = std::max(size, std::fabs(b(j, q)));
      largest = std::max(largest, std::fabs(a(j, q) - b(j, q)));
    }
  return size > 0.0 ? largest / size : largest;
}

using Make = std::function<System(const sfdae::Options&)>;

struct Journey {
  sfdae::Sensitivities wanted;
  Vector start;
  double end;
  long least_passages;
  int structure = SFDAE_STRUCTURE_OFF;
};

// Steps are the same, as there is one time only, at which they end; those of forward sensitivities with BDF where
// states are chosen from the array.
sfdae::Options options_for(const Journey& journey, double tolerance, int method) {
  sfdae::Options options = solver_options(tolerance, method);
  options.structure = journey.structure;
  options.use_stop_time = 1;
  options.stop_time = journey.end;
  return options;
}

Matrix forward_gradient(const Make& make, const sfdae::Options& options, const Journey& journey,
                        const Matrix& weights) {
  System system = make(options);
  system.hybrid.set_sensitivities(journey.wanted);
  Point point{0.0, journey.start, {}};
  system.hybrid.start(0, point, journey.end);
  const Matrix S = system.hybrid.sensitivities(0.0, false).S;
  system.hybrid.advance(journey.end, point);
  return gradient_of({S, system.hybrid.sensitivities(journey.end, false).S}, weights);
}

Matrix adjoint_gradient(const Make& make, const sfdae::Options& options, const Journey& journey,
                        const Matrix& weights) {
  System system = make(options);
  sfdae::Sensitivities wanted = journey.wanted;
  wanted.adjoint = true;
  system.hybrid.set_sensitivities(wanted);
  Point point{0.0, journey.start, {}};
  system.hybrid.start(0, point, journey.end);
  system.hybrid.advance(journey.end, point);
  EXPECT_GE(system.hybrid.num_passages(), journey.least_passages);
  return system.hybrid.gradient({0.0, journey.end}, weights);
}

class HybridGradients : public testing::TestWithParam<int> {
 protected:
  // Two functionals of the values at the start and at the end.
  void expect_forward_gradient(const Make& make, const Journey& journey, double tolerance, double agreement) {
    const sfdae::Options options = options_for(journey, tolerance, GetParam());
    const Matrix weights = weights_for(static_cast<int>(journey.start.size()), 4);
    const Matrix forward = forward_gradient(make, options, journey, weights);
    EXPECT_LE(difference(adjoint_gradient(make, options, journey, weights), forward), agreement);
  }
};
INSTANTIATE_TEST_SUITE_P(Methods, HybridGradients,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

TEST_P(HybridGradients, AreThoseOfABouncingBall) {
  const Journey journey{by({"g", "", ""}, unit_directions(3, 3, 1, {0, 2})), {2.0, 0.0, 0.8}, 2.9, 3};
  expect_forward_gradient(ball, journey, 1e-8, 1e-10);
}

// Both modes have positions, which impulses of the second one cannot restore: jumps from values moved along a
// direction would have to be moved closely, and agree to 4e-8 only. Without structure the second mode does not start.
TEST_P(HybridGradients, GoThroughARopeThatBecomesTight) {
  const Journey journey{by({"g", "", ""}, unit_directions(6, 3, 1, {2, 5})),
                        {0.3, 0.2, 0.5, 0.1, 0.0, 1.0},
                        1.2,
                        1,
                        SFDAE_STRUCTURE_AUTOMATIC};
  expect_forward_gradient(rope, journey, 1e-10, 2e-9);
}

// A pendulum as it is, with another friction on either side: both modes have the length, by impulses and by a
// function that turns it back.
System divided_pendulum(const sfdae::Options& options, bool turns_back) {
  System system;
  for (bool is_rough : {false, true}) {
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [is_rough](const Expression& t, auto x, auto xdot, auto F) {
      const Expression c = is_rough ? sfdae::parameter(t, "rough", 0.8) : sfdae::parameter(t, "smooth", 0.1);
      for (int i = 0; i < 2; ++i) {
        F[i] = xdot[i] - x[i + 2];
        F[i + 2] = xdot[i + 2] + 2.0 * x[i] * x[4] + c * x[i + 2];
      }
      F[3] = F[3] + 9.81;
      F[4] = x[0] * x[0] + x[1] * x[1] - sfdae::parameter(t, "L", 1.0) * sfdae::parameter(t, "L", 1.0);
    };
    system.add(problem, options);
  }
  for (int k = 0; k < 2; ++k) {
    sfdae::Transition side;
    side.from = k;
    side.to = 1 - k;
    side.kind = SFDAE_TRANSITION_ZERO;
    side.function = [](double t, auto x, auto) { return x[0] - 0.1 * std::sin(t) - 0.05 * x[2]; };
    if (turns_back) side.jump = [](double, auto x) { x[2] = -0.8 * x[2], x[3] = -0.8 * x[3]; };
    system.hybrid.add_transition(side);
  }
  return system;
}

TEST_P(HybridGradients, FollowConstraintsThatModesHaveInCommon) {
  // Forward sensitivities with BDF are discretized in other states of pendula.
  const double agreement = GetParam() == SFDAE_METHOD_RADAU ? 1e-9 : 1e-6;
  for (bool turns_back : {false, true}) {
    SCOPED_TRACE(turns_back ? "by a function" : "by impulses");
    const Journey journey{
        by({"smooth", "rough", "L", ""}, unit_directions(5, 4, 3, {2})), {0.6, -0.8, 0.0, 0.0, 0.0}, 2.0, 2};
    expect_forward_gradient([&](const sfdae::Options& options) { return divided_pendulum(options, turns_back); },
                            journey, 1e-8, agreement);
  }
}

TEST_P(HybridGradients, AreThoseOfRandomSystems) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomModes modes(seed);
    const Journey journey{by({"p", ""}, unit_directions(4, 2, 1, {1})), {0.3, -0.2, 0.4, 0.0}, 5.0, 3};
    expect_forward_gradient([&](const sfdae::Options& options) { return modes.system(options); }, journey, 1e-7,
                            1e-9);
  }
}

// ---- Modes that are left at once ---------------------------------------------------------------------------------

// Mode 1 is left where it begins, after a transition at x_0 = x_1, or at the start.
System hurried(const sfdae::Options& options) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - sfdae::parameter(t, "rate", 0.5) * x[0] - 0.1 * cos(x[1]);
    F[1] = xdot[1] - 0.2 * x[1] * sin(t);
  };
  System system;
  for (int k = 0; k < 3; ++k) system.add(problem, options);
  sfdae::Transition first, second, third;
  first.to = second.from = 1;
  second.to = third.from = third.to = 2;
  first.kind = third.kind = SFDAE_TRANSITION_ZERO;
  first.function = [](double, auto x, auto) { return x[0] - x[1]; };
  first.jump = [](double, auto x) { x[0] = 2.0 * x[0] + 1.0; };
  second.function = [](double, auto x, auto) { return x[0] - 1.0; };
  second.jump = [](double t, auto x) { x[0] = x[0] * x[0] + t * x[1]; };
  third.function = [](double, auto x, auto) { return x[0] - 24.0; };
  third.jump = [](double t, auto x) { x[0] = 18.0 + t + x[1]; };
  for (const sfdae::Transition& transition : {first, second, third}) system.hybrid.add_transition(transition);
  return system;
}

TEST_P(HybridGradients, GoThroughModesThatAreLeftAtOnce) {
  const Journey journey{by({"rate", "", ""}, unit_directions(2, 3, 1, {0, 1})), {1.0, 1.5}, 2.0, 3};
  expect_forward_gradient(hurried, journey, 1e-8, 1e-9);
}

TEST_P(HybridGradients, BeginWithAModeThatIsLeftAtOnce) {
  const sfdae::Options options = options_for({{}, {}, 1.0, 0}, 1e-8, GetParam());
  const Matrix weights = weights_for(2, 4);
  Matrix gradients[2];
  for (bool by_adjoint : {false, true}) {
    System system = hurried(options);
    sfdae::Sensitivities wanted = by({"rate", "", ""}, unit_directions(2, 3, 1, {0, 1}));
    wanted.adjoint = by_adjoint;
    system.hybrid.set_sensitivities(wanted);
    Point point{0.0, {4.0, 1.5}, {}};
    system.hybrid.start(1, point, 1.0);
    ASSERT_EQ(system.hybrid.num_passages(), 1);
    const Matrix S = by_adjoint ? Matrix() : system.hybrid.sensitivities(0.0, false).S;
    system.hybrid.advance(1.0, point);
    if (by_adjoint) gradients[1] = system.hybrid.gradient({0.0, 1.0}, weights);
    else gradients[0] = gradient_of({S, system.hybrid.sensitivities(1.0, false).S}, weights);
  }
  EXPECT_LE(difference(gradients[1], gradients[0]), 1e-9);
}

// ---- Points in time ----------------------------------------------------------------------------------------------

// At outputs, at fixed times of transitions, where weights are those of x after them, where a call has stopped for
// one, and at a point that the adjoint goes by. Steps of forward sensitivities do not end there.
TEST_P(HybridGradients, HaveWeightsAtPointsThatWereReturned) {
  constexpr double tolerance = 1e-9;
  const Vector times = {0.0, 0.4, 0.7, 1.2, 1.5, 2.0};
  const Matrix weights = weights_for(2, 12);
  Matrix gradients[2];
  for (bool by_adjoint : {false, true}) {
    System system = hurried(solver_options(tolerance, GetParam()));
    for (int mode : {0, 2}) {
      sfdae::Transition timed;
      timed.kind = SFDAE_TRANSITION_TIME;
      timed.from = timed.to = mode;
      timed.time = mode == 0 ? 0.4 : 1.5;
      timed.jump = [](double, auto x) { x[1] = x[1] + 0.1 * x[0] * x[0]; };
      system.hybrid.add_transition(timed);
    }
    sfdae::Sensitivities wanted = by({"rate", "", ""}, unit_directions(2, 3, 1, {0, 1}));
    wanted.adjoint = by_adjoint;
    system.hybrid.set_sensitivities(wanted);
    Point point{0.0, {1.0, 1.5}, {}};
    system.hybrid.start(0, point, 2.0);
    std::vector<Matrix> S;
    Vector reached;
    const auto look = [&] {
      reached.push_back(point.t);
      if (!by_adjoint) S.push_back(system.hybrid.sensitivities(point.t, false).S);
    };
    look();
    system.hybrid.advance(0.4, point);
    look();
    if (by_adjoint) point.t = 0.7;
    else system.hybrid.advance(0.7, point);
    look();
    while (system.hybrid.current_mode() != 2) ASSERT_EQ(system.hybrid.advance_to_transition(2.0, point), SFDAE_EVENT);
    look();
    for (double t : {1.5, 2.0}) {
      system.hybrid.advance(t, point);
      look();
    }
    EXPECT_GE(system.hybrid.num_passages(), 4);
    if (by_adjoint) gradients[1] = system.hybrid.gradient(reached, weights);
    else gradients[0] = gradient_of(S, weights);
  }
  EXPECT_LE(difference(gradients[1], gradients[0]), 1e3 * tolerance);
}

// mu = 1, driven by a table with kinks at t = 0.5 and 1.25; x_0 jumps, at the first kink and at zeros of a function,
// from one visit to the next.
System driven(const sfdae::Options& options) {
  System system;
  for (int k = 0; k < 2; ++k) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [k](const Expression& t, auto x, auto xdot, auto F) {
      const Expression input = sfdae::table(t, 1, {0.0, 0.5, 1.25, 2.0}, {1.0, 0.0, 2.0, -1.0}),
                       p = sfdae::parameter(t, "p", 0.8), q = sfdae::parameter(t, "q", 1.5);
      F[0] = xdot[0] + p * x[0] * x[0] - x[1];
      F[1] = xdot[1] + x[2] + 0.5 * k * p * x[1];
      F[2] = x[1] + q * sin(x[0]) - input;
    };
    system.add(problem, options);
  }
  sfdae::Transition timed, there, back;
  timed.to = there.to = back.from = 1;
  timed.kind = SFDAE_TRANSITION_TIME;
  timed.time = 0.5;
  there.kind = back.kind = SFDAE_TRANSITION_ZERO;
  there.direction = -1;
  back.direction = 1;
  there.function = back.function = [](double t, auto x, auto) { return std::sin(7.0 * t - 0.6) + 0.1 * x[0]; };
  timed.jump = there.jump = back.jump = [](double t, auto x) { x[0] = 0.5 * x[0] + 0.3 + 0.1 * t; };
  for (const sfdae::Transition& transition : {timed, there, back}) system.hybrid.add_transition(transition);
  return system;
}

TEST_P(HybridGradients, StayOnTheirSideOfKinks) {
  const Journey journey{by({"p", "q", ""}, unit_directions(3, 3, 2, {0})), {0.5, 0.2, 0.0}, 1.95, 4};
  expect_forward_gradient(driven, journey, 1e-9, 1e-6);
}

// A gradient leaves the run as it was, in every bit, and may be asked for as often as wanted.
TEST_P(HybridGradients, DisturbNothing) {
  const Matrix weights = weights_for(3, 1);
  Vector x[2], gradients[2];
  for (int often : {0, 1}) {
    System system = driven(solver_options(1e-7, GetParam()));
    sfdae::Sensitivities wanted = by({"p", "q", ""}, unit_directions(3, 3, 2, {0}));
    wanted.adjoint = true;
    system.hybrid.set_sensitivities(wanted);
    Point point{0.0, {0.5, 0.2, 0.0}, {}};
    system.hybrid.start(0, point, 1.95);
    for (double t : {0.2, 0.45, 0.5, 0.8, 1.2, 1.25, 1.6, 1.95}) {
      system.hybrid.advance(t, point);
      x[often].insert(x[often].end(), point.x.begin(), point.x.end());
      if (often == 1) system.hybrid.gradient({t}, weights);
    }
    for (double t : {1.95, 0.5, 1.25, 0.2, 1.95}) {
      const Matrix gradient = system.hybrid.gradient({t}, weights);
      gradients[often].insert(gradients[often].end(), gradient.data(), gradient.data() + 3);
    }
  }
  EXPECT_EQ(x[0], x[1]);
  EXPECT_EQ(gradients[0], gradients[1]);
  for (int j = 0; j < 3; ++j) EXPECT_EQ(gradients[0][std::size_t(j)], gradients[0][std::size_t(12 + j)]);
}

// The steps of earlier visits are made again, too.
TEST_P(HybridGradients, AreTheSameInEveryBitWithFewStepsKept) {
  const Matrix weights = weights_for(4, 4);
  std::vector<Vector> found;
  for (long kept : {0L, 2L, 30L, 100000L}) {
    System system = RandomModes(3).system(solver_options(1e-8, GetParam()));
    sfdae::Sensitivities wanted = by({"p", ""}, unit_directions(4, 2, 1, {1}));
    wanted.adjoint = true;
    wanted.max_kept_steps = kept;
    system.hybrid.set_sensitivities(wanted);
    Point point{0.0, {0.3, -0.2, 0.4, 0.0}, {}};
    system.hybrid.start(0, point, 5.0);
    system.hybrid.advance(2.0, point);
    system.hybrid.advance(5.0, point);
    found.emplace_back();
    for (int again = 0; again < 2; ++again) {
      const Matrix gradient = system.hybrid.gradient({2.0, 5.0}, weights);
      found.back().insert(found.back().end(), gradient.data(), gradient.data() + 4);
    }
    const std::string report = system.hybrid.report();
    EXPECT_EQ(report.find("made again") != std::string::npos, kept > 0) << report;
    EXPECT_EQ(found.back(), found.front()) << kept;
  }
}

// ---- Many parameters ---------------------------------------------------------------------------------------------

// 25 coefficients of five differential equations and five of a constraint, which one of the modes has.
TEST_P(HybridGradients, AreThoseByManyParameters) {
  constexpr int d = 5;
  const auto name = [](int i, int j) { return "k" + std::to_string(i) + std::to_string(j); };
  const auto network = [&](const sfdae::Options& options) {
    System system;
    for (bool is_closed : {false, true}) {
      sfdae::NonlinearProblem problem(d + 1, d + 1);
      problem.equations = [&, is_closed](const Expression& t, auto x, auto xdot, auto F) {
        const auto k = [&](int i, int j) { return sfdae::parameter(t, name(i, j), std::cos(1.0 + i + 5.0 * j)); };
        Expression sum = 0.0 * t;
        for (int i = 0; i < d; ++i) {
          F[i] = xdot[i] + 0.5 * x[i] - cos(2.0 * t + double(i));
          for (int j = 0; j < d; ++j) F[i] = F[i] + 0.3 * k(i, j) * sin(x[j] + 0.3 * i);
          sum = sum + k(i, d) * x[i];
        }
        if (is_closed) F[0] = F[0] - x[d];
        F[d] = is_closed ? sum - 0.2 : x[d] - sum;
      };
      system.add(problem, options);
    }
    for (int k = 0; k < 2; ++k) {
      sfdae::Transition transition;
      transition.from = k;
      transition.to = 1 - k;
      transition.kind = SFDAE_TRANSITION_ZERO;
      transition.direction = k == 0 ? 1 : -1;
      transition.function = [](double t, auto x, auto) { return std::sin(4.0 * t) - 0.3 + 0.2 * x[1]; };
      system.hybrid.add_transition(transition);
    }
    return system;
  };
  Journey journey{{}, Vector(d + 1, 0.1), 2.5, 3};
  for (int i = 0; i < d; ++i)
    for (int j = 0; j <= d; ++j) journey.wanted.parameters.push_back(name(i, j));
  expect_forward_gradient(network, journey, 1e-7, 1e-8);
}

// ---- What becomes of modes ---------------------------------------------------------------------------------------

// A mode that is analyzed anew, by other options, in between.
TEST_P(HybridGradients, GoBackBeyondANewAnalysis) {
  const RandomModes modes(5);
  const Matrix weights = weights_for(4, 1);
  Matrix gradients[2];
  for (bool anew : {false, true}) {
    System system = modes.system(solver_options(1e-9, GetParam()));
    sfdae::Sensitivities wanted = by({"p", ""}, unit_directions(4, 2, 1, {1}));
    wanted.adjoint = true;
    system.hybrid.set_sensitivities(wanted);
    Point point{0.0, {0.3, -0.2, 0.4, 0.0}, {}};
    system.hybrid.start(0, point, 5.0);
    ASSERT_EQ(system.hybrid.advance_to_transition(5.0, point), SFDAE_EVENT);
    if (anew) {
      sfdae::Options other = solver_options(1e-9, GetParam());
      other.max_index = 4;
      system.solvers[0]->set_options(other);
    }
    system.hybrid.advance(5.0, point);
    EXPECT_GE(system.hybrid.num_passages(), 3);
    EXPECT_EQ(system.hybrid.mode(0).num_analyses, anew ? 2 : 1);
    gradients[anew ? 1 : 0] = system.hybrid.gradient({5.0}, weights);
  }
  EXPECT_LE(difference(gradients[1], gradients[0]), 1e-6);
}

}  // namespace
