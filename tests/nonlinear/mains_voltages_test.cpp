// SPDX-License-Identifier: BSD-3-Clause
// Rectifiers at hundreds of volts: tolerances of a volt or a tenth, diodes that carry e times as much for each 26 mV.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "matrix_checks.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"

namespace sfdae_test {

namespace {

using sfdae::Expression;

// v, i, and the voltage of the capacitor; with a load or without.
struct MainsRectifier {
  double period, amplitude, C, R, load;
  int source;  // a sine, its ninth power, pulses

  Expression voltage(const Expression& t) const {
    const Expression s = sin(2.0 * std::numbers::pi / period * t);
    if (source == 0) return amplitude * s;
    return source == 1 ? amplitude * pow(s, 9.0) : amplitude * exp(-200.0 * (1.0 - s) * (1.0 - s));
  }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem result(3, 3);
    result.equations = [*this](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = (voltage(t) - x[0]) / R - x[1];
      F[1] = x[1] - 1e-12 * (exp((x[0] - x[2]) / 0.0259) - 1.0);
      F[2] = C * xdot[2] - x[1] + x[2] / load;
    };
    return result;
  }
  double diode_current(const std::vector<double>& x) const {
    return 1e-12 * (std::exp((x[0] - x[2]) / 0.0259) - 1.0);
  }
};

MainsRectifier random_mains_rectifier(std::uint64_t seed) {
  RandomNumbers random(seed);
  const auto of_any_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  return {of_any_size(-3.0, -1.0),
          random.uniform(100.0, 1000.0),
          of_any_size(-7.0, -5.0),
          of_any_size(1.0, 3.0),
          seed % 2 == 0 ? 1e12 : of_any_size(3.0, 6.0),
          static_cast<int>(seed / 2 % 3)};
}

struct MainsOutcome {
  double voltage = 0.0, largest_violation = 0.0;  // the latter of the diode's equation, over the largest current
};

// periods, charge: where it starts, and the voltage of the capacitor there; v and i are guessed as 0.
MainsOutcome integrate_mains(const MainsRectifier& rectifier, sfdae::Options options, double periods = 0.0,
                             double charge = 0.0) {
  sfdae::Solver solver(rectifier.problem(), options);
  sfdae::Point point{periods * rectifier.period, {0.0, 0.0, charge}, {}};
  const double end = point.t + 10.0 * rectifier.period;
  MainsOutcome outcome;
  solver.start(point, end);
  for (bool is_there = false; !is_there;) {
    is_there = solver.step(end, point) == SFDAE_OK;
    const double violation = std::fabs(point.x[1] - rectifier.diode_current(point.x));
    // Not a number counts as the largest.
    if (!(violation * rectifier.R / rectifier.amplitude <= outcome.largest_violation))
      outcome.largest_violation = violation * rectifier.R / rectifier.amplitude;
  }
  outcome.voltage = point.x[2];
  return outcome;
}

struct MainsCase {
  int method, structure;
};

class MainsVoltages : public testing::TestWithParam<MainsCase> {};
INSTANTIATE_TEST_SUITE_P(All, MainsVoltages,
                         testing::Values(MainsCase{SFDAE_METHOD_BDF, SFDAE_STRUCTURE_OFF},
                                         MainsCase{SFDAE_METHOD_RADAU, SFDAE_STRUCTURE_OFF},
                                         MainsCase{SFDAE_METHOD_BDF, SFDAE_STRUCTURE_REQUIRED},
                                         MainsCase{SFDAE_METHOD_RADAU, SFDAE_STRUCTURE_REQUIRED}));

}  // namespace

// While changes within the tolerances counted as none whatever the exponential made of them, 24 to 46 of 60 such runs
// at 1e-3 ended because a step had no solution, and with the minimal extension some were wrong by up to 1e10
// tolerances. While matrices with conductances that are too large could make them so small, some ended of seeds 9,
// 29, 34, 40 and 45, or were wrong.
TEST_P(MainsVoltages, AreNoHighVoltagesForDiodes) {
  int ended = 0, wrong = 0, violated = 0, all = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 9, 29, 34, 40, 45}) {
    const MainsRectifier rectifier = random_mains_rectifier(seed);
    sfdae::Options options = solver_options(1e-9, SFDAE_METHOD_RADAU);
    options.max_step = 0.02 * rectifier.period;
    const double exact = integrate_mains(rectifier, options).voltage;
    for (const double tolerance : {1e-3, 1e-4}) {
      options = solver_options(tolerance, GetParam().method);
      options.structure = GetParam().structure;
      ++all;
      try {
        const MainsOutcome outcome = integrate_mains(rectifier, options);
        wrong += std::fabs(outcome.voltage - exact) <= 100.0 * tolerance * (1.0 + std::fabs(exact)) ? 0 : 1;
        violated += outcome.largest_violation <= 1e-2 ? 0 : 1;
      } catch (const sfdae::Error&) {
        ++ended;
      }
    }
  }
  EXPECT_EQ(wrong, 0) << "of " << all;
  EXPECT_EQ(violated, 0) << "of " << all;
  EXPECT_EQ(ended, 0) << "of " << all;
}

// With a charged capacitor, while the source is on its way down or below zero.
TEST_P(MainsVoltages, MayBeMetInTheMiddleOfAPeriod) {
  constexpr double tolerance = 1e-4;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const MainsRectifier rectifier = random_mains_rectifier(seed);
    const double periods = 3.52 + 0.07 * static_cast<double>(seed), charge = 0.5 * rectifier.amplitude;
    sfdae::Options options = solver_options(1e-9, SFDAE_METHOD_RADAU);
    options.max_step = 0.02 * rectifier.period;
    const double exact = integrate_mains(rectifier, options, periods, charge).voltage;
    options = solver_options(tolerance, GetParam().method);
    options.structure = GetParam().structure;
    const MainsOutcome outcome = integrate_mains(rectifier, options, periods, charge);
    EXPECT_NEAR(outcome.voltage, exact, 100.0 * tolerance * (1.0 + std::fabs(exact))) << seed;
    EXPECT_LE(outcome.largest_violation, 1e-2) << seed;
  }
}

// Without a load a crest counts that is higher than the one before by millivolts, and hardly higher than the ends of
// the step. While those within a thousandth of the range were not looked at, 3 of 24 runs with Radau were off by 100
// to 3000 tolerances, with SFDAE_OK.
TEST_P(MainsVoltages, ChargeCapacitorsAtCrestsThatHardlyExceedTheEndsOfSteps) {
  constexpr double tolerance = 1e-7;
  for (std::uint64_t seed = 2; seed <= 24; seed += 2) {
    const MainsRectifier rectifier = random_mains_rectifier(seed);
    const double periods = 0.3 + 0.11 * static_cast<double>(seed);
    sfdae::Options options = solver_options(1e-9, SFDAE_METHOD_RADAU);
    options.max_step = 0.01 * rectifier.period;
    const double exact = integrate_mains(rectifier, options, periods).voltage;
    options = solver_options(tolerance, GetParam().method);
    options.structure = GetParam().structure;
    const double voltage = integrate_mains(rectifier, options, periods).voltage;
    EXPECT_NEAR(voltage, exact, 100.0 * tolerance * (1.0 + std::fabs(exact))) << seed;
  }
}

}  // namespace sfdae_test
