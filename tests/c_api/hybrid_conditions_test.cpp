// SPDX-License-Identifier: BSD-3-Clause
//
// Conditions of hybrid systems that are zero, to roundoff, where a mode begins: a mode is left if its condition rises
// from there, however it does so, and stays if it falls or does not change.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sfdae/hybrid.hpp>
#include <string>
#include <vector>

namespace {

// x' = rate and y' = mode: y tells how long each mode has lasted.
sfdae::Solver clock_of(int mode, double rate, int method) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [mode, rate](const auto&, auto, auto xdot, auto F) {
    F[0] = xdot[0] - rate;
    F[1] = xdot[1] - mode;
  };
  sfdae::Options options;
  options.method = method;
  return sfdae::Solver(problem, options);
}

using Function = sfdae::TransitionFunction;

// Modes in a row; from each to the next one under its condition. All have rate x' = rate.
struct Row {
  Row(const std::vector<Function>& conditions, double rate, int method) {
    for (std::size_t k = 0; k <= conditions.size(); ++k)
      solvers.push_back(clock_of(static_cast<int>(k), rate, method));
    for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
    for (std::size_t k = 0; k < conditions.size(); ++k) {
      sfdae::Transition transition;
      transition.from = static_cast<int>(k);
      transition.to = static_cast<int>(k) + 1;
      transition.function = conditions[k];
      hybrid.add_transition(transition);
    }
  }
  std::vector<sfdae::Solver> solvers;
  sfdae::Hybrid hybrid;
};

const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};

// Functions with a zero at s = 0 that rise through it.
struct Shape {
  const char* name;
  double (*of)(double s);
  double lateness;  // where it is larger than roundoff of its argument
};
const Shape shapes[] = {{"s", [](double s) { return s; }, 1e-12},
                        {"3 s", [](double s) { return 3 * s; }, 1e-12},
                        {"1e-9 s", [](double s) { return 1e-9 * s; }, 1e-12},
                        {"1e9 s", [](double s) { return 1e9 * s; }, 1e-12},
                        {"exp(s) - 1", [](double s) { return std::exp(s) - 1; }, 1e-12},
                        {"sin s", [](double s) { return std::sin(s); }, 1e-12},
                        {"s^3", [](double s) { return s * s * s; }, 1e-4},
                        {"max(s, 0)", [](double s) { return std::max(s, 0.0); }, 1e-12},
                        {"s |s|", [](double s) { return s * std::fabs(s); }, 1e-6}};

TEST(HybridConditions, ThoseOfTimeWithTheSameZeroAllCount) {
  for (const int method : methods) {
    for (const Shape& first : shapes) {
      for (const Shape& second : shapes) {
        for (const double zero : {1.0, 0.3, 1e-3}) {
          const auto at = [zero](const Shape& shape) -> Function {
            return [zero, of = shape.of](double t, auto, auto) { return of(t - zero); };
          };
          Row row({at(first), at(second), at(first)}, 1, method);
          sfdae::Point point{0, {0, 0}, {}};
          row.hybrid.start(0, point, 2);
          row.hybrid.advance(2, point);
          EXPECT_EQ(row.hybrid.current_mode(), 3) << first.name << ", " << second.name << " at " << zero;
          EXPECT_NEAR(point.x[1], 3 * (2 - zero), 10 * std::max(first.lateness, second.lateness) + 1e-7)
              << first.name << ", " << second.name << " at " << zero;
        }
      }
    }
  }
}

// Conditions of a state, whose margins are its tolerances.
TEST(HybridConditions, ThoseOfAStateWithTheSameZeroAllCount) {
  for (const int method : methods) {
    for (const double rate : {1.0, 1e-3, 1e6, 1e12}) {
      for (const Shape& shape : shapes) {
        if (shape.lateness > 1e-12) continue;
        const Function condition = [of = shape.of](double, auto x, auto) { return of(x[0] - 1); };
        Row row({condition, condition}, rate, method);
        sfdae::Point point{0, {0, 0}, {}};
        row.hybrid.start(0, point, 2 / rate);
        row.hybrid.advance(2 / rate, point);
        EXPECT_EQ(row.hybrid.current_mode(), 2) << shape.name << ", x' = " << rate;
      }
    }
  }
}

TEST(HybridConditions, RisingAndFallingOnesAreToldApart) {
  for (const int method : methods) {
    for (const Shape& shape : shapes) {
      // x = 1 at the start, exactly.
      for (const double rate : {1.0, -1.0}) {
        const Function condition = [of = shape.of](double, auto x, auto) { return of(x[0] - 1); };
        Row row({condition}, rate, method);
        sfdae::Point point{0, {1, 0}, {}};
        row.hybrid.start(0, point, 3);
        row.hybrid.advance(3, point);
        EXPECT_EQ(row.hybrid.current_mode(), rate > 0 ? 1 : 0) << shape.name << ", x' = " << rate;
        if (rate > 0) {
          // Margins of tolerances, 1e-6, are met at the latest where the function has risen by some of them.
          const double late = shape.lateness > 1e-12 ? 0.1 : 1e-4;
          EXPECT_GE(point.x[1], 3 - late) << shape.name;
        }
      }
    }
  }
}

TEST(HybridConditions, OneThatStaysZeroDoesNotCountUntilItRises) {
  for (const int method : methods) {
    const Function zero = [](double, auto, auto) { return 0.0; };
    const Function flat = [](double t, auto, auto) { return std::max(t - 2, 0.0); };
    const Function jump = [](double t, auto, auto) { return t > 2 ? 1.0 : 0.0; };
    for (const Function& condition : {flat, jump}) {
      Row row({condition, zero}, 1, method);
      sfdae::Point point{0, {0, 0}, {}};
      row.hybrid.start(0, point, 3);
      row.hybrid.advance(3, point);
      EXPECT_EQ(row.hybrid.current_mode(), 1);
      EXPECT_NEAR(point.x[1], 1, 1e-6);
    }
  }
}

TEST(HybridConditions, TheyCountBackwardInTime) {
  for (const int method : methods) {
    const Function condition = [](double t, auto, auto) { return -1 - t; };
    Row row({condition, condition}, 1, method);
    sfdae::Point point{0, {0, 0}, {}};
    row.hybrid.start(0, point, -2);
    row.hybrid.advance(-2, point);
    EXPECT_EQ(row.hybrid.current_mode(), 2);
    EXPECT_NEAR(point.x[1], -2, 1e-6);
  }
}

// Rows of modes with thresholds at random, some of them equal, in an order that lets them all be passed.
TEST(HybridConditions, RandomThresholdsAreAllPassedAtTheirTimes) {
  std::minstd_rand random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 2 + random() % 4;
    std::vector<double> thresholds;
    std::vector<Function> conditions;
    for (std::size_t k = 0; k < count; ++k) {
      const bool repeats = k > 0 && random() % 2 == 0;
      thresholds.push_back(repeats ? thresholds.back()
                                   : (k > 0 ? thresholds.back() : 0.0) + 0.1 +
                                         1e-3 * static_cast<double>(random() % 500));
      const double factor = std::pow(10.0, static_cast<double>(random() % 13) - 6);
      const double threshold = thresholds.back();
      if (random() % 2 == 0) conditions.push_back([=](double t, auto, auto) { return factor * (t - threshold); });
      else conditions.push_back([=](double, auto x, auto) { return factor * (x[0] - threshold); });
    }
    Row row(conditions, 1, methods[random() % 3]);
    const double end = thresholds.back() + 1;
    sfdae::Point point{0, {0, 0}, {}};
    row.hybrid.start(0, point, end);
    row.hybrid.advance(end, point);
    double lasted = 0;
    for (const double threshold : thresholds) lasted += end - threshold;
    EXPECT_EQ(row.hybrid.current_mode(), static_cast<int>(count)) << trial;
    EXPECT_NEAR(point.x[1], lasted, 1e-3) << trial;
  }
}

// Sensitivities of a passage that follows another one at once are those of the first.
TEST(HybridConditions, EqualZerosHaveEqualSensitivities) {
  std::vector<sfdae::Solver> solvers;
  for (int mode = 0; mode < 3; ++mode) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [mode](const sfdae::Expression& t, auto, auto xdot, auto F) {
      F[0] = xdot[0] - sfdae::parameter(t, "rate", 2);
      F[1] = xdot[1] - mode;
    };
    solvers.emplace_back(problem);
  }
  sfdae::Hybrid hybrid;
  for (sfdae::Solver& solver : solvers) hybrid.add_mode(solver);
  for (int k = 0; k < 2; ++k) {
    sfdae::Transition transition;
    transition.from = k;
    transition.to = k + 1;
    transition.function = [](double, auto x, auto) { return x[0] - 1; };
    hybrid.add_transition(transition);
  }
  sfdae::Sensitivities wanted;
  wanted.parameters = {"rate"};
  hybrid.set_sensitivities(wanted);
  sfdae::Point point{0, {0, 0}, {}};
  hybrid.start(0, point, 2);
  hybrid.advance(2, point);
  // The zero is at t = 1 / rate, y = 2 (2 - 1 / rate) at the end: dy/drate = 2 / rate^2.
  EXPECT_EQ(hybrid.current_mode(), 2);
  EXPECT_NEAR(point.x[1], 3, 1e-5);
  EXPECT_NEAR(hybrid.sensitivities(2).S(1, 0), 0.5, 1e-5);
}

// At t = 1 the first mode is left, entered again with x = 0, as x = 1 is beyond the condition of the second one, and
// left again: that its condition counted at this time before makes no difference.
TEST(HybridConditions, ThoseThatHaveCountedCountAgainAtTheSameTime) {
  for (const int method : methods) {
    for (const Shape& shape : shapes) {
      sfdae::Solver first = clock_of(0, 1, method), second = clock_of(1, 1, method);
      sfdae::Hybrid hybrid;
      hybrid.add_mode(first);
      hybrid.add_mode(second);
      sfdae::Transition forth, back;
      forth.to = 1;
      forth.function = [of = shape.of](double t, auto, auto) { return of(t - 1); };
      back.from = 1;
      back.function = [](double, auto x, auto) { return x[0] - 0.5; };
      back.jump = [](double, auto x) { x[0] = -10; };
      hybrid.add_transition(forth);
      hybrid.add_transition(back);
      sfdae::Point point{0, {0, 0}, {}};
      hybrid.start(0, point, 2);
      hybrid.advance(2, point);
      EXPECT_EQ(hybrid.num_passages(), 3) << shape.name;
      EXPECT_EQ(hybrid.current_mode(), 1) << shape.name;
      EXPECT_NEAR(point.x[1], 1, 1e-3) << shape.name;
    }
  }
}

}  // namespace
