// SPDX-License-Identifier: BSD-3-Clause
// Rectifiers: while the diode blocks, steps grow, whatever the source does; its next pulse is not stepped over, nor
// is the crest of a sine at which a diode without load conducts for a moment.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "matrix_checks.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"

namespace sfdae_test {

namespace {

using sfdae::Expression;

// C x1' = (x2 - x1) / R, x3 = (x2 - x1) / R, the current of a diode from the source to x2, and the power.
struct Rectifier {
  double C, R, thermal, saturation, omega, amplitude, end;
  int source;  // a sine, its ninth power, short pulses

  Expression voltage(const Expression& t) const {
    if (source == 0) return amplitude * sin(omega * t);
    if (source == 1) return amplitude * pow(sin(omega * t), 9.0);
    return amplitude * exp(-50.0 * (1.0 - cos(omega * t)));
  }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem result(4, 4);
    result.equations = [*this](const Expression& t, auto x, auto xdot, auto F) {
      const Expression current = (x[1] - x[0]) / R;
      F[0] = C * xdot[0] - current;
      F[1] = x[2] - current;
      F[2] = x[2] - saturation * (exp((voltage(t) - x[1]) / thermal) - 1.0);
      F[3] = x[3] - x[2] * x[1];
    };
    return result;
  }
};

Rectifier random_rectifier(std::uint64_t seed) {
  RandomNumbers random(seed);
  const auto of_any_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  return {of_any_size(-1.0, 1.0),    of_any_size(-1.0, 1.0),   random.uniform(0.03, 0.1), of_any_size(-6.0, -2.0),
          random.uniform(1.0, 10.0), random.uniform(0.5, 3.0), random.uniform(3.0, 20.0), static_cast<int>(seed % 3)};
}

struct Outcome {
  double x = 0.0;
  long steps = 0;
};

Outcome integrate(const Rectifier& rectifier, sfdae::Options options) {
  sfdae::Solver solver(rectifier.problem(), options);
  sfdae::Point point{0.0, {0.1, 0.1, 0.0, 0.0}, {}};
  solver.start(point, rectifier.end);
  solver.advance(rectifier.end, point);
  return {point.x[0], solver.statistics().steps};
}

// Of a solution that steps of a fiftieth of a period cannot miss.
double reference(const Rectifier& rectifier) {
  sfdae::Options options = solver_options(1e-9, SFDAE_METHOD_RADAU);
  options.max_step = 0.02 * 2.0 * std::numbers::pi / rectifier.omega;
  return integrate(rectifier, options).x;
}

// Volts in any unit, amperes: v, i, and the voltage of a capacitor that a diode charges, but nothing discharges.
struct PeakDetector {
  double unit, period, amplitude, C, R, tolerance;

  double final_voltage(int method, int structure, double max_step, double accuracy) const {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [*this](const Expression& t, auto x, auto xdot, auto F) {
      const Expression v = unit * x[0], capacitor = unit * x[2];
      F[0] = (amplitude * sin(2.0 * std::numbers::pi / period * t) - v) / R - x[1];
      F[1] = x[1] - 1e-12 * (exp((v - capacitor) / 0.0259) - 1.0);
      F[2] = C * unit * xdot[2] - x[1];
    };
    sfdae::Options options = solver_options(accuracy, method);
    options.max_step = max_step;
    options.structure = structure;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {0.0, 0.0, 0.0}, {}};
    solver.start(point, 10.0 * period);
    solver.advance(10.0 * period, point);
    return point.x[2];
  }
};

PeakDetector random_detector(std::uint64_t seed) {
  RandomNumbers random(seed);
  const auto of_any_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  return {of_any_size(-3.0, 1.0),  of_any_size(-3.0, -1.0), random.uniform(1.0, 11.0),
          of_any_size(-7.0, -5.0), of_any_size(1.0, 3.0),   seed % 2 == 0 ? 1e-5 : 1e-7};
}

class Pulses : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, Pulses, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

}  // namespace

// Before they were looked for, 39 to 69 % of such runs were wrong, with SFDAE_OK; 0.2 % (BDF) and 5 % (Radau, short
// pulses) are still, and
// 0.6 % end with BDF within a pulse, as steps find no solution.
TEST_P(Pulses, AreNotSteppedOver) {
  int wrong = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Rectifier rectifier = random_rectifier(seed);
    const double exact = reference(rectifier);
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      ++all;
      try {
        const Outcome run = integrate(rectifier, solver_options(tolerance, GetParam()));
        const double error = std::fabs(run.x - exact) / (1.0 + std::fabs(exact));
        wrong += error <= 100.0 * tolerance ? 0 : 1;
      } catch (const sfdae::Error&) {
        ++wrong;
      }
    }
  }
  EXPECT_LE(wrong, GetParam() == SFDAE_METHOD_BDF ? 2 : 7) << "of " << all;
}

// The polynomial through what steps see of the sine shows its crest, but not what the exponential makes of it. Before
// crests were looked at by themselves, 35 (BDF) and 16 (Radau) of these 40 runs were off by more than 100 tolerances,
// with SFDAE_OK.
TEST_P(Pulses, AreNotSteppedOverAtCrests) {
  int wrong = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const PeakDetector detector = random_detector(seed);
    const double tolerance = detector.tolerance,
                 exact = detector.final_voltage(SFDAE_METHOD_RADAU, SFDAE_STRUCTURE_OFF, detector.period / 50, 1e-9);
    for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED}) {
      const double result = detector.final_voltage(GetParam(), structure, 0.0, tolerance);
      wrong += std::fabs(result - exact) <= 100.0 * tolerance * (1.0 + std::fabs(exact)) ? 0 : 1;
      ++all;
    }
  }
  EXPECT_EQ(wrong, 0) << "of " << all;
}

// Few samples may all be beside a crest, and nothing was seen of it after steps without a solution: Radau was off by
// 2000 to 14,000 tolerances in eight of these 18 runs.
TEST_P(Pulses, AreNotSteppedOverAtCrestsBetweenSamples) {
  constexpr double tolerance = 1e-7;
  for (const std::uint64_t seed : {2, 13, 30, 72, 76, 86, 109, 162, 172}) {
    const PeakDetector detector = random_detector(seed);
    const double exact = detector.final_voltage(SFDAE_METHOD_RADAU, SFDAE_STRUCTURE_OFF, detector.period / 50, 1e-9);
    for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
      EXPECT_NEAR(detector.final_voltage(GetParam(), structure, 0.0, tolerance), exact,
                  100.0 * tolerance * (1.0 + std::fabs(exact)))
          << seed << ' ' << structure;
  }
}

// N equations x_k' = -x_k / 1000 + a pulse of its own, 1 for two units of time, somewhere in 1000 of them. While inputs
// of one recording were looked at up to the 64th only, 25 (BDF) and 19 (Radau) of these 100 pulses were missed.
TEST_P(Pulses, OfManyInputsAreAllSeen) {
  constexpr int count = 100;
  constexpr double end = 1000.0;
  const auto time = [](int k) { return end * (0.05 + 0.9 * std::fmod((k + 1) * 0.6180339887, 1.0)); };
  sfdae::NonlinearProblem problem(count, count);
  problem.equations = [&](const Expression& t, auto x, auto xdot, auto F) {
    for (int k = 0; k < count; ++k)
      F[k] = xdot[k] + x[k] / 1000.0 - choose(1.0 - pow(t - time(k), 2.0), Expression(1.0), Expression(0.0));
  };
  sfdae::Solver solver(problem, solver_options(1e-3, GetParam()));
  sfdae::Point point{0.0, std::vector<double>(count, 0.0), {}};
  solver.start(point, end);
  solver.advance(end, point);
  for (int k = 0; k < count; ++k) EXPECT_NEAR(point.x[k], 2.0 * std::exp((time(k) - end) / 1000.0), 0.03) << k;
}

// Rectifiers of one recording, seven of them without a load; the eighth is discharged by its load, and is charged at
// crests at other times. While four crests of a step were looked at, Radau stepped over one of its own: 538.0 V.
TEST_P(Pulses, AreNotSteppedOverAtCrestsOfManyInputs) {
  constexpr int count = 8;
  const auto final_voltage = [](int method, int first, double tolerance, double max_step) {
    sfdae::NonlinearProblem problem(3 * (count - first), 3 * (count - first));
    problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
      for (int k = first; k < count; ++k) {
        const bool is_last = k == count - 1;
        const int at = 3 * (k - first);
        const double amplitude = is_last ? 602.0 : 565.0 + 5.0 * k, load = is_last ? 3e5 : 1e12;
        const Expression source = amplitude * sin(100.0 * std::numbers::pi * t + (is_last ? 1.7 : 1e-3 * k));
        F[at] = (source - x[at]) / 50.0 - x[at + 1];
        F[at + 1] = x[at + 1] - 1e-12 * (exp((x[at] - x[at + 2]) / 0.026) - 1.0);
        F[at + 2] = 1e-6 * xdot[at + 2] - x[at + 1] + x[at + 2] / load;
      }
    };
    sfdae::Options options = solver_options(tolerance, method);
    options.max_step = max_step;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, std::vector<double>(static_cast<std::size_t>(3 * (count - first)), 0.0), {}};
    solver.start(point, 0.213);
    solver.advance(0.213, point);
    return point.x.back();
  };
  constexpr double tolerance = 1e-5;
  const double exact = final_voltage(SFDAE_METHOD_RADAU, count - 1, 1e-8, 0.02 / 60.0);
  EXPECT_NEAR(final_voltage(GetParam(), 0, tolerance, 0.0), exact, 100.0 * tolerance * (1.0 + exact));
}

// A current that a resistor limits; backward, in microseconds.
TEST_P(Pulses, AreNotSteppedOverBackwardAndInShortTimes) {
  const double omega = 6.0e6, end = -4.0e-6;
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
    const Expression v = 2.0 * sin(omega * t) - x[0];
    F[0] = -1e-6 * xdot[0] - x[1];
    F[1] = x[1] - 1e-3 * (exp(v / 0.05) - 1.0) / (1.0 + 1e-3 * exp(v / 0.05));
  };
  const auto end_of = [&](double tolerance, double max_step) {
    sfdae::Options options = solver_options(tolerance, GetParam());
    options.max_step = max_step;
    sfdae::Solver solver(problem, options);
    sfdae::Point point{0.0, {0.4, 0.0}, {}};
    solver.start(point, end);
    solver.advance(end, point);
    return point.x[0];
  };
  EXPECT_NEAR(end_of(1e-6, 0.0), end_of(1e-8, 1e-8), 1e-4);
}

// Cosines are sines, alone or beside a sine of the same angle.
TEST_P(Pulses, OfCosinesAreInputs) {
  for (const bool is_beside_sine : {false, true}) {
    const auto end_of = [&](double tolerance, double max_step) {
      sfdae::NonlinearProblem problem(2, 2);
      problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
        F[0] = xdot[0] - x[1];
        F[1] = x[1] - 1e-4 * (exp((cos(t) - x[0]) / 0.02) - 1.0) / (1.0 + 1e-4 * exp((cos(t) - x[0]) / 0.02));
        if (is_beside_sine) F[0] += 1e-9 * sin(t) * x[0];
      };
      sfdae::Options options = solver_options(tolerance, GetParam());
      options.max_step = max_step;
      sfdae::Solver solver(problem, options);
      sfdae::Point point{2.0, {0.5, 0.0}, {}};
      solver.start(point, 60.0);
      solver.advance(60.0, point);
      return point.x[0];
    };
    EXPECT_NEAR(end_of(1e-6, 0.0), end_of(1e-9, 0.02), 1e-4) << is_beside_sine;
  }
}

// A source of a millionth of the tolerance that no step resolves: steps do not follow it.
TEST_P(Pulses, OfNoImportanceAreSteppedOver) {
  const auto steps_with = [&](double amplitude) {
    sfdae::NonlinearProblem problem(2, 2);
    problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] + x[0] - x[1];
      F[1] = x[1] - amplitude * sin(1e5 * t) - 0.5;
    };
    sfdae::Solver solver(problem, solver_options(1e-6, GetParam()));
    sfdae::Point point{0.0, {1.0, 0.5}, {}};
    solver.start(point, 100.0);
    solver.advance(100.0, point);
    EXPECT_NEAR(point.x[0], 0.5, 1e-5);
    return solver.statistics().steps;
  };
  EXPECT_LE(steps_with(1e-12), steps_with(0.0) + 2);
}

// Equations that are smooth on steps that errors allow take the same steps as with a parameter in place of t.
TEST_P(Pulses, AreNotSoughtInSmoothSolutions) {
  const auto steps_with = [&](bool watched) {
    sfdae::NonlinearProblem problem(3, 3);
    problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - x[1];
      F[1] = xdot[1] + x[0] + 0.1 * (watched ? sin(t) : x[2]);
      F[2] = watched ? x[2] - sin(t) : x[2] - x[0];
    };
    sfdae::Solver solver(problem, solver_options(1e-6, GetParam()));
    sfdae::Point point{0.0, {0.0, 1.0, 0.0}, {}};
    solver.start(point, 20.0);
    solver.advance(20.0, point);
    return solver.statistics().steps;
  };
  EXPECT_LE(steps_with(true), steps_with(false) * 13 / 10);
}

// Six phases, so that most steps contain the crest of one of them; the exponential, which makes that be looked at, is
// next to nothing.
TEST_P(Pulses, AreNotSoughtAtCrestsThatStepsResolve) {
  const auto steps_with = [&](double factor, double tolerance) {
    sfdae::NonlinearProblem problem(12, 12);
    problem.equations = [=](const Expression& t, auto x, auto xdot, auto F) {
      for (int k = 0; k < 12; k += 2) {
        F[k] = xdot[k] + x[k] * x[k] * x[k] - x[k + 1];
        F[k + 1] = x[k + 1] - sin(3.0 * t + k);
      }
      if (factor != 0.0) F[0] += factor * exp(x[1]);
    };
    sfdae::Solver solver(problem, solver_options(tolerance, GetParam()));
    sfdae::Point point{0.0, std::vector<double>(12, 0.0), {}};
    solver.start(point, 20.0);
    solver.advance(20.0, point);
    return solver.statistics().steps;
  };
  for (const double tolerance : {1e-3, 1e-5, 1e-8})
    EXPECT_EQ(steps_with(1e-30, tolerance), steps_with(0.0, tolerance));
}

}  // namespace sfdae_test
