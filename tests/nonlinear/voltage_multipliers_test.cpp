// SPDX-License-Identifier: BSD-3-Clause
// Voltage multipliers fed by pulses, in volts and amperes: capacitors in a chain that hangs on the source, so that
// its potential is the one algebraic unknown of E x' = f(t, x), and every diode has a say in it. Points between those
// of the integration keep the charges (docs/design/error_control.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "matrix_checks.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"

namespace sfdae_test {

namespace {

using sfdae::Expression;

// Potentials x_0 at the source, behind a resistance, and x_1, x_2, ...: diode k leads from k - 1 to k, the first one
// from ground; capacitor k is between k - 2 and k, the first one at the source, the second one at ground.
struct VoltageMultiplier {
  double period, amplitude, resistance, load;
  std::vector<double> saturation, capacitance;

  int size() const { return static_cast<int>(saturation.size()) + 1; }
  Expression source(const Expression& t) const {
    return amplitude * exp(-50.0 * (1.0 - cos(2.0 * std::numbers::pi / period * t - 2.0)));
  }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem result(size(), size());
    result.equations = [*this](const Expression& t, auto x, auto xdot, auto F) {
      for (Expression& row : F) row = 0.0;
      F[0] = (x[0] - source(t)) / resistance;
      F[size() - 1] = x[size() - 1] / load;
      for (int k = 1; k < size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(k - 1);
        const Expression before = k == 1 ? Expression(0.0) : x[k - 1];
        const Expression current = saturation[i] * (exp((before - x[k]) / 0.0259) - 1.0);
        F[k] = F[k] - current;
        if (k > 1) F[k - 1] = F[k - 1] + current;
        const int other = k == 1 ? 0 : k - 2;
        const Expression charging = capacitance[i] * (xdot[k] - (k == 2 ? Expression(0.0) : xdot[other]));
        F[k] = F[k] + charging;
        if (k != 2) F[other] = F[other] - charging;
      }
    };
    return result;
  }
};

VoltageMultiplier random_multiplier(std::uint64_t seed) {
  RandomNumbers random(seed);
  const auto of_any_size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  VoltageMultiplier result{
      of_any_size(-6.0, -2.0), random.uniform(3.0, 30.0), of_any_size(-1.0, 3.0), of_any_size(3.0, 7.0), {}, {}};
  const double typical = of_any_size(-11.0, -4.0);
  const int diodes = 8 + static_cast<int>(seed % 7);
  for (int k = 0; k < diodes; ++k) {
    result.saturation.push_back(of_any_size(-14.0, -9.0));
    result.capacitance.push_back(std::clamp(typical * of_any_size(-2.0, 2.0), 1e-12, 1e-3));
  }
  return result;
}

using Voltages = std::vector<std::vector<double>>;

// At twelve times.
Voltages integrate(const VoltageMultiplier& multiplier, sfdae::Options options) {
  constexpr int times = 12;
  options.structure = SFDAE_STRUCTURE_OFF;
  Voltages voltages;
  sfdae::Solver solver(multiplier.problem(), options);
  sfdae::Point point{0.0, std::vector<double>(static_cast<std::size_t>(multiplier.size())), {}};
  const double end = 3.05 * multiplier.period;
  solver.start(point, end);
  for (int k = 1; k <= times; ++k) {
    solver.advance(end * k / times, point);
    voltages.push_back(point.x);
  }
  return voltages;
}

// In tolerances, relative to the largest voltage of each node.
double error(const Voltages& voltages, const Voltages& exact, double tolerance) {
  double largest = 0.0;
  for (std::size_t i = 0; i < exact[0].size(); ++i) {
    double size = 1.0, difference = 0.0;
    for (std::size_t k = 0; k < exact.size(); ++k) {
      size = std::max(size, std::fabs(exact[k][i]));
      difference = std::max(difference, std::fabs(voltages[k][i] - exact[k][i]));
    }
    largest = std::max(largest, difference / (tolerance * size));
  }
  return largest;
}

class VoltageMultipliers : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, VoltageMultipliers, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

}  // namespace

// While points between those of the integration could be any consistent ones, 26 of 320 such runs (40 multipliers)
// were off by 290 to
// 6.7e6 tolerances with SFDAE_OK, pulses were stepped over, and nine runs ended.
TEST_P(VoltageMultipliers, KeepChargesBetweenPoints) {
  for (const std::uint64_t seed : {1, 3, 7, 9, 10, 14, 35}) {
    const VoltageMultiplier multiplier = random_multiplier(seed);
    sfdae::Options fine = solver_options(1e-9, SFDAE_METHOD_RADAU);
    fine.max_step = 0.02 * multiplier.period;
    const Voltages exact = integrate(multiplier, fine);
    for (const double tolerance : {1e-3, 1e-5}) {
      const Voltages voltages = integrate(multiplier, solver_options(tolerance, GetParam()));
      EXPECT_LE(error(voltages, exact, tolerance), 100.0) << "seed " << seed << ", tolerance " << tolerance;
    }
  }
}

}  // namespace sfdae_test
