// SPDX-License-Identifier: BSD-3-Clause
// Consistent values of nonlinear problems are the nearest ones, keep what is fixed, or are refused.
#include "starts/nonlinear_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "matrix_checks.h"
#include "nonlinear_examples.h"
#include "problem/failure.h"
#include "starts/jet_solver.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::rounding;
using Vector = std::vector<double>;

constexpr double g = sfdae_test::Pendulum::gravity;

// Every consistent point of the pendulum: angle and angular velocity.
Vector pendulum_at(double angle, double speed) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {s, -c, speed * c, speed * s, speed * speed + g * c};
}

double distance_to(const Vector& x, const Vector& given, const Vector& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += std::pow((x[i] - given[i]) / (weights.empty() ? 1.0 : weights[i]), 2);
  return std::sqrt(sum);
}

// Search over a grid that becomes finer around its best point.
Vector nearest_by_search(const Vector& given, const Vector& weights, double angle, double speed) {
  double width = 1.0;
  for (int refinement = 0; refinement < 30; ++refinement, width *= 0.5) {
    double best = INFINITY, best_angle = angle, best_speed = speed;
    for (int i = -8; i <= 8; ++i)
      for (int j = -8; j <= 8; ++j) {
        const double a = angle + width * i / 8.0, v = speed + width * j / 8.0;
        const double distance = distance_to(pendulum_at(a, v), given, weights);
        if (distance < best) best = distance, best_angle = a, best_speed = v;
      }
    angle = best_angle;
    speed = best_speed;
  }
  return pendulum_at(angle, speed);
}

struct Pendulum : NonlinearExample {
  Pendulum() : NonlinearExample(sfdae_test::record_of_pendulum()) { analyze(0.0, 1.0, pendulum_at(0.6, 0.7)); }
  ConsistentJetResult choose(const ConsistencyRequest& request, const Vector& given) {
    Jet start;
    start.n = 5;
    start.x = given;
    JetSolver solver(*problem, units);
    if (request.kind == InitialValues::fixed) solver.set_fixed(request.fixed);
    for (int level = 0; level <= 2; ++level) solver.solve(start, level);
    return choose_consistent_jet(*problem, analysis, units, request, {given, start});
  }
};

Vector values_of(const Jet& jet) { return {jet.x.data(), jet.x.data() + jet.n}; }

void expect_consistent(const Vector& x, double tolerance) {
  EXPECT_NEAR(x[0] * x[0] + x[1] * x[1], 1.0, tolerance);
  EXPECT_NEAR(x[0] * x[2] + x[1] * x[3], 0.0, tolerance);
  EXPECT_NEAR(x[2] * x[2] + x[3] * x[3] - x[4] - g * x[1], 0.0, 10.0 * tolerance);
}

int status_of(const std::function<void()>& call, std::string& message) {
  try {
    call();
  } catch (const Failure& failure) {
    message = failure.what();
    return failure.status();
  }
  return SFDAE_OK;
}

}  // namespace

// The distance is that of the nearest point up to the square of the accuracy 1e-8 that the iteration stops at, and of
// that of linear convergence where x is far off.
TEST(NonlinearValues, NearestIsTheNearestPoint) {
  for (const Vector& weights : {Vector{}, Vector{1.0, 1.0, 3.0, 3.0, 20.0}, Vector{0.01, 1.0, 1.0, 1.0, 10.0}})
    for (double amount : {1e-6, 1e-3, 0.1})
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(std::to_string(amount) + ", seed " + std::to_string(seed) +
                     (weights.empty() ? "" : ", weights"));
        Pendulum p;
        Vector given = pendulum_at(0.6, 0.7);
        const Vector error = sfdae_test::random_vector(5, seed);
        for (std::size_t i = 0; i < 5; ++i) given[i] += amount * error[i];
        ConsistencyRequest request;
        request.weights = weights;
        const ConsistentJetResult result = p.choose(request, given);
        const Vector x = values_of(result.jet), nearest = nearest_by_search(given, weights, 0.6, 0.7);
        expect_consistent(x, rounding(5) * 10.0);
        const double least = distance_to(nearest, given, weights);
        EXPECT_LE(distance_to(x, given, weights), least * (1.0 + 1e-3) + rounding(10));
        EXPECT_NEAR(result.change.residual_before, distance_to(x, given, {}), rounding(10));
        double largest = 0.0;
        for (std::size_t i = 0; i < 5; ++i) largest = std::max(largest, std::fabs(x[i] - given[i]));
        EXPECT_NEAR(result.change.largest_change, largest, rounding(10));
      }
}

TEST(NonlinearValues, ConsistentValuesStayAsTheyAre) {
  for (double angle : {0.0, 0.6, 2.0})
    for (double speed : {0.0, -1.5}) {
      Pendulum p;
      const Vector given = pendulum_at(angle, speed);
      const ConsistentJetResult result = p.choose({}, given);
      EXPECT_LE(sfdae_test::distance(values_of(result.jet), given), 10.0 * rounding(5)) << angle;
    }
}

// x and u given: y = -sqrt(1 - x^2), v = -x u / y, lambda follows.
TEST(NonlinearValues, FixedComponentsStayAndTheRestFollows) {
  Pendulum p;
  ConsistencyRequest request;
  request.kind = InitialValues::fixed;
  request.fixed = {1, 0, 1, 0, 0};
  const ConsistentJetResult result = p.choose(request, {0.5, -0.7, 0.4, 0.0, 0.0});
  const double y = -std::sqrt(0.75), v = 0.5 * 0.4 / -y;
  const Vector expected = {0.5, y, 0.4, v, 0.16 + v * v - g * y};
  const Vector x = values_of(result.jet);
  EXPECT_EQ(x[0], 0.5);
  EXPECT_EQ(x[2], 0.4);
  EXPECT_LE(sfdae_test::distance(x, expected), 100.0 * rounding(5));
}

// More components fixed than there are degrees of freedom: both positions, off the circle or, by luck, on it.
TEST(NonlinearValues, ContradictingFixedComponentsAreNamed) {
  ConsistencyRequest request;
  request.kind = InitialValues::fixed;
  request.fixed = {1, 1, 0, 0, 0};
  std::string message;
  Pendulum off, on;
  const int status = status_of([&] { off.choose(request, {0.6, -0.9, 0.0, 0.0, 8.0}); }, message);
  EXPECT_TRUE(status == SFDAE_NO_CONSISTENT_VALUES || status == SFDAE_FIXED_VALUES) << status;
  EXPECT_FALSE(message.empty());
  ConsistentJetResult result;
  EXPECT_EQ(status_of(
                [&] {
                  result = on.choose(request, {0.6, -0.8, 0.1, 0.0, 8.0});
                },
                message),
            SFDAE_OK)
      << message;
  expect_consistent(values_of(result.jet), 100.0 * rounding(5));
}

TEST(NonlinearValues, AcceptRefusesChangesBeyondTheTolerances) {
  for (double error : {1e-7, 1e-4}) {
    Pendulum p;
    Vector given = pendulum_at(0.6, 0.7);
    given[1] += error;
    ConsistencyRequest request;
    request.kind = InitialValues::accept;
    request.set_tolerances({Vector(5, 1e-6), Vector(5, 1e-6)}, given.data());
    std::string message;
    const int status = status_of([&] { p.choose(request, given); }, message);
    EXPECT_EQ(status, error > 1e-6 ? SFDAE_INCONSISTENT_VALUES : SFDAE_OK) << message;
  }
}

// 0 = x^2 + 1 at x = 1, where x - 1 fulfils what is linear of it: nothing leads from there to consistent values, and
// the jet that was taken for one is none, whatever was asked for.
TEST(NonlinearValues, HaveToFulfilTheConstraints) {
  sfdae_test::Recording r(1);
  NonlinearExample example(r.finish({r.x[0] * r.x[0] + 1.0}));
  IndexAnalysis analysis;
  analysis.values = {.mu = 0, .d = 0, .a = 1, .u = 0, .v = 0};
  Jet start;
  start.n = 1;
  start.x = {1.0};
  ConsistencyRequest nearest, weighted, keeping;
  weighted.weights = {3.0};
  keeping.keeps_differentiated = true;
  for (ConsistencyRequest request : {nearest, weighted, keeping}) {
    request.set_tolerances({{1e-6}, {1e-6}}, start.x.data());
    std::string message;
    const int status = status_of(
        [&] {
          choose_consistent_jet(*example.problem, analysis, {}, request, {start.x, start});
        },
        message);
    EXPECT_EQ(status, SFDAE_NO_CONSISTENT_VALUES);
    EXPECT_NE(message.find("x[0] would have to change by -1."), std::string::npos) << message;
  }
}

// d = 0: nothing may be chosen, and u > 0: any change of the free component is too much.
TEST(NonlinearValues, FreeComponentsStay) {
  NonlinearExample example(sfdae_test::record_with_free_component());
  example.analyze(0.0, 1.0, {2.0, 4.0, 0.3});
  const Vector given = {2.0, 4.0 + 1e-3, 0.7};
  Jet start;
  start.n = 3;
  start.x = given;
  JetSolver(*example.problem, example.units).solve(start, 0);
  const ConsistentJetResult result =
      choose_consistent_jet(*example.problem, example.analysis, example.units, {}, {given, start});
  const Vector x = values_of(result.jet);
  EXPECT_EQ(x[2], 0.7);
  EXPECT_NEAR(x[1], x[0] * x[0], 10.0 * rounding(3));
  // x2 = x1^2 moves to the point nearest to (2, 4.001): along the normal (-4, 1) of the parabola.
  EXPECT_NEAR((x[0] - given[0]) / (x[1] - given[1]), -4.0, 0.01);
}

}  // namespace sfdae::core
