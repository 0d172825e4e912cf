// SPDX-License-Identifier: BSD-3-Clause
//
// Tests of unknowns that rest exactly until a condition on t and x switches, as a capacitor behind a rectifier does:
// nothing but the condition says when. SFDAE_TEST_SCALE scales the number of random problems.

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "family_run.h"
#include "random_family.h"
#include "solver_options.h"

namespace conditions_from_rest {
namespace {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using sfdae_test::RandomNumbers;
using Vector = std::vector<double>;

double where_positive(double g, double value, double other) { return g > 0.0 ? value : other; }
Expression where_positive(const Expression& g, const Expression& value, double other) {
  return choose(g > 0.0, value, other);
}
double larger(double a, double b) { return std::max(a, b); }
Expression larger(const Expression& a, double b) { return max(a, b); }

// y' = gain f(sin(w t + phase) - threshold - y) - leak y: f is 0 for negative arguments.
struct Rectifier {
  int law;
  double gain, leak, frequency, phase, threshold;

  template <class Number>
  Number slope(const Number& t, const Number& y) const {
    using std::sin, std::abs;
    const Number drop = sin(frequency * t + phase) - threshold - y;
    switch (law) {
      case 0: return gain * larger(drop, 0.0) - leak * y;
      case 1: return 0.5 * gain * (abs(drop) + drop) - leak * y;
      case 2: return gain * where_positive(drop, drop, 0.0) - leak * y;
      case 3: return gain * where_positive(drop * (y + 2.0), drop * drop, 0.0) - leak * y;
      default: return gain * (larger(drop, 0.0) - larger(drop - 0.3, 0.0)) - leak * y;
    }
  }
};
constexpr int laws = 5;

struct Problem {
  std::vector<Rectifier> rectifiers;
  double unit;        // x = unit y
  bool has_currents;  // x' = z, and z is an unknown
  int count() const { return static_cast<int>(rectifiers.size()); }
};

Problem random_problem(RandomNumbers& random) {
  constexpr int numbers_of_copies[] = {1, 1, 2, 5};
  Problem problem{{}, std::pow(10.0, random.uniform(-4.0, 4.0)), random.integer(0, 1) == 1};
  const int law = random.integer(0, laws - 1), count = numbers_of_copies[random.integer(0, 3)];
  for (int k = 0; k < count; ++k)
    problem.rectifiers.push_back({law, std::pow(10.0, random.uniform(-1.0, 3.0)), random.integer(0, 1) * 0.2,
                                  random.uniform(0.5, 3.0), random.uniform(0.0, 6.28), random.uniform(0.1, 0.8)});
  return problem;
}

// y of each output, by steps so short that errors at switches do not matter.
std::vector<Vector> reference(const Problem& problem, const Vector& times) {
  constexpr int steps = 700;  // from one output to the next
  std::vector<Vector> result(times.size(), Vector(problem.rectifiers.size()));
  for (std::size_t k = 0; k < problem.rectifiers.size(); ++k) {
    const Rectifier& of = problem.rectifiers[k];
    double t = 0.0, y = 0.0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double start = t, h = (times[i] - start) / steps;
      for (int step = 0; step < steps; ++step, t = start + step * h) {
        const double a = of.slope(t, y), b = of.slope(t + 0.5 * h, y + 0.5 * h * a);
        const double c = of.slope(t + 0.5 * h, y + 0.5 * h * b), d = of.slope(t + h, y + h * c);
        y += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
      }
      t = times[i];
      result[i][k] = y;
    }
  }
  return result;
}

sfdae::NonlinearProblem equations_of(const Problem& of) {
  const int size = of.has_currents ? 2 * of.count() : of.count();
  sfdae::NonlinearProblem problem(size, size);
  problem.equations = [&of](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
    for (int k = 0; k < of.count(); ++k) {
      const Expression slope = of.unit * of.rectifiers[static_cast<std::size_t>(k)].slope(t, x[k] / of.unit);
      F[k] = xdot[k] - (of.has_currents ? x[of.count() + k] : slope);
      if (of.has_currents) F[of.count() + k] = x[of.count() + k] - slope;
    }
  };
  return problem;
}

// Outputs between steps are as good as those at their ends.
TEST(ConditionsFromRest, SwitchWhenTheirFunctionsSay) {
  constexpr double enough = 100.0, accuracy_of_reference = 1e-6;
  Vector times;
  for (int i = 1; i <= 40; ++i) times.push_back(0.15 * i);
  RandomNumbers random(36090);
  for (int trial = 0; trial < sfdae_test::scaled_count(400, 40); ++trial) {
    const Problem problem = random_problem(random);
    const int method = random.integer(0, 1);
    const double tolerance = std::pow(10.0, -random.integer(3, 6));
    SCOPED_TRACE("trial " + std::to_string(trial) + ", law " + std::to_string(problem.rectifiers[0].law) +
                 ", copies " + std::to_string(problem.count()) + ", method " + std::to_string(method) +
                 ", tolerance " + std::to_string(tolerance));
    const std::vector<Vector> exact = reference(problem, times);
    sfdae::Options options = sfdae_test::solver_options(tolerance, method);
    options.atol = tolerance * problem.unit;
    sfdae::Solver solver(equations_of(problem), options);
    sfdae::Point point{0.0, Vector(static_cast<std::size_t>(problem.count() * (problem.has_currents ? 2 : 1))), {}};
    solver.start(point, times.back());
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_EQ(solver.advance(times[i], point), SFDAE_OK) << solver.message();
      for (std::size_t k = 0; k < problem.rectifiers.size(); ++k)
        ASSERT_NEAR(point.x[k] / problem.unit, exact[i][k], enough * tolerance + accuracy_of_reference) << times[i];
    }
  }
}

// The times that are listed are those at which the condition of the exact solution changes.
TEST(ConditionsFromRest, AreListedWithTheirTimes) {
  RandomNumbers random(36091);
  for (int trial = 0; trial < sfdae_test::scaled_count(60, 6); ++trial) {
    const double threshold = random.uniform(-0.9, 0.9), omega = random.uniform(0.5, 3.0),
                 rate = random.uniform(0.1, 5.0);
    const int method = random.integer(0, 1);
    SCOPED_TRACE("trial " + std::to_string(trial) + ", method " + std::to_string(method));
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [=](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
      F[0] = xdot[0] - omega * cos(omega * t);
      F[1] = xdot[1] - choose(x[0] > threshold, Expression(rate), Expression(0.0));
    };
    sfdae::Solver solver(problem, sfdae_test::solver_options(1e-8, method));
    sfdae::Point point{0.0, {0.0, 0.0}, {}};
    solver.start(point, 10.0);
    ASSERT_EQ(solver.advance(10.0, point), SFDAE_OK);
    // sin is above the threshold between these two angles of each period.
    const double first = std::asin(threshold), second = std::acos(-1.0) - first, period = 2.0 * std::acos(-1.0);
    Vector exact;
    for (int k = 0; k < 10; ++k)
      for (const double angle : {first, second})
        if (const double t = (angle + k * period) / omega; t > 0.0 && t < 10.0) exact.push_back(t);
    const std::vector<sfdae::Switch> switches = solver.switches();
    ASSERT_EQ(switches.size(), exact.size());
    for (std::size_t k = 0; k < exact.size(); ++k) {
      EXPECT_NEAR(switches[k].t, exact[k], 1e-5);
      EXPECT_NE(switches[k].before, switches[k].after);
      EXPECT_NE(switches[k].condition.find("x[0]"), std::string::npos) << switches[k].condition;
      EXPECT_FALSE(switches[k].jumps);
    }
  }
}

// x passes the same zero again and again, and is elsewhere in between: nothing leads back to it.
TEST(ConditionsFromRest, MayBePassedAgainAndAgain) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double tolerance : {1e-4, 1e-6}) {
      sfdae::NonlinearProblem problem(1, 1);
      problem.equations = [](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - sin(t) + choose(x[0] > 0.0, sqrt(abs(x[0])), Expression(0.0));
      };
      sfdae::Solver solver(problem, sfdae_test::solver_options(tolerance, method));
      sfdae::Point point{0.0, {-0.5}, {}};
      solver.start(point, 60.0);
      ASSERT_EQ(solver.advance(60.0, point), SFDAE_OK) << solver.message();
      EXPECT_NEAR(point.x[0], -0.0475876, 50.0 * tolerance);
    }
}

// |y| - 0.2 does not care on which side of zero y is while y is nothing but rounding errors.
TEST(ConditionsFromRest, WithinOthersMayBeRoundingErrors) {
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const double factor : {0.5, 1.5, 3.0}) {
      const auto rate = [factor](const auto& t, const auto& x) {
        using std::abs, std::sin;
        const auto drive = sin(t) - 0.5;
        const auto y = x + 0.5 * factor * (drive + abs(drive));
        return sin(t) - larger(abs(y) - 0.2, 0.0);
      };
      sfdae::NonlinearProblem problem(1, 1);
      problem.equations = [&](const Expression& t, ConstExpressions x, ConstExpressions xdot, Expressions F) {
        F[0] = xdot[0] - rate(t, x[0]);
      };
      double y = 0.0;
      constexpr int steps = 30000;  // of the midpoint rule, up to t = 3
      for (int k = 0; k < steps; ++k) {
        const double h = 3.0 / steps, t = k * h;
        y += h * rate(t + 0.5 * h, y + 0.5 * h * rate(t, y));
      }
      sfdae::Solver solver(problem, sfdae_test::solver_options(1e-5, method));
      sfdae::Point point{0.0, {0.0}, {}};
      solver.start(point, 3.0);
      ASSERT_EQ(solver.advance(3.0, point), SFDAE_OK) << solver.message();
      EXPECT_NEAR(point.x[0], y, 1e-4) << method << " " << factor;
    }
}

// Steps that show what inputs do may be shorter than those that a switch is located with.
TEST(ConditionsFromRest, AreLocatedWhereInputsShortenSteps) {
  Vector times;
  for (int i = 1; i <= 30; ++i) times.push_back(0.2 * i);
  for (int k = 0; k < sfdae_test::scaled_count(60, 6); ++k) {
    const double shift = 0.1 * k;
    const Problem problem{
        {{0, 246.32254952068948, 1.0, 1.912771069749065, 4.76216081338398 + shift, -0.3082012832764336}}, 1.0, false};
    const std::vector<Vector> exact = reference(problem, times);
    sfdae::Solver solver(equations_of(problem), sfdae_test::solver_options(1e-7, SFDAE_METHOD_RADAU));
    sfdae::Point point{0.0, {0.0}, {}};
    solver.start(point, times.back());
    for (std::size_t i = 0; i < times.size(); ++i) {
      ASSERT_EQ(solver.advance(times[i], point), SFDAE_OK) << solver.message();
      ASSERT_NEAR(point.x[0], exact[i][0], 1e-5) << times[i] << ", shift " << shift;
    }
    EXPECT_LT(solver.statistics().steps, 1000) << shift;
  }
}

}  // namespace
}  // namespace conditions_from_rest
