// SPDX-License-Identifier: BSD-3-Clause
// A planet with its energy and angular momentum as further equations, m = 6, n = 4, in uneven units: which equations
// are taken, and which are redundant, has to be right at the ends of steps, too
// (docs/design/rank_decisions.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include "sfdae/sfdae.hpp"

#include "solver_options.h"

namespace sfdae_test {

namespace {

using sfdae::Expression;

struct Orbit {
  double eccentricity, anomaly, tolerance, time;
  std::array<double, 4> x;
  std::array<double, 6> F;
  double minor() const { return std::sqrt(1.0 - eccentricity * eccentricity); }
};

Orbit random_orbit(unsigned seed) {
  std::mt19937_64 engine(seed);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  Orbit orbit{};
  orbit.eccentricity = real(0.1, 0.7);
  for (double& unit : orbit.F) unit = std::pow(10.0, real(-3.0, 3.0));
  for (double& unit : orbit.x) unit = std::pow(10.0, real(-3.0, 3.0));
  engine();
  orbit.tolerance = std::pow(10.0, -3.0 - static_cast<double>(engine() % 5));
  orbit.time = std::pow(10.0, real(-3.0, 3.0));
  engine();
  orbit.anomaly = real(0.0, 6.28);
  return orbit;
}

sfdae::NonlinearProblem equations(const Orbit& orbit) {
  sfdae::NonlinearProblem problem(6, 4);
  problem.equations = [orbit](const Expression&, auto y, auto slope, auto F) {
    std::array<Expression, 4> x, xdot;
    for (std::size_t i = 0; i < 4; ++i) {
      x[i] = y[static_cast<int>(i)] * orbit.x[i];
      xdot[i] = slope[static_cast<int>(i)] * (orbit.x[i] / orbit.time);
    }
    const Expression r = sqrt(x[0] * x[0] + x[1] * x[1]);
    F[0] = xdot[0] - x[2];
    F[1] = xdot[1] - x[3];
    F[2] = xdot[2] + x[0] / (r * r * r);
    F[3] = xdot[3] + x[1] / (r * r * r);
    F[4] = 0.5 * (x[2] * x[2] + x[3] * x[3]) - 1.0 / r + 0.5;
    F[5] = x[0] * x[3] - x[1] * x[2] - orbit.minor();
    for (std::size_t i = 0; i < 6; ++i) F[static_cast<int>(i)] = orbit.F[i] * F[static_cast<int>(i)];
  };
  return problem;
}

// The largest error of a position at ends of steps, in tolerances, and of the angular momentum.
struct OrbitErrors {
  double position = 0.0, momentum = 0.0;
};
OrbitErrors follow(const Orbit& orbit, int structure) {
  const double e = orbit.eccentricity, minor = orbit.minor(), rate = 1.0 / (1.0 - e * std::cos(orbit.anomaly));
  sfdae::Options options = solver_options(orbit.tolerance, SFDAE_METHOD_RADAU);
  options.structure = structure;
  for (double unit : orbit.x) options.atol_vector.push_back(orbit.tolerance / unit);
  sfdae::Solver solver(equations(orbit), options);
  const double cosine = std::cos(orbit.anomaly), sine = std::sin(orbit.anomaly);
  sfdae::Point point{0.0, {cosine - e, minor * sine, -sine * rate, minor * cosine * rate}, {}};
  for (std::size_t i = 0; i < 4; ++i) point.x[i] /= orbit.x[i];
  const double end = 6.0 / orbit.time, mean = orbit.anomaly - e * std::sin(orbit.anomaly);
  solver.start(point, end);
  OrbitErrors errors;
  for (int status = SFDAE_STEP_TAKEN; status == SFDAE_STEP_TAKEN;) {
    status = solver.step(end, point);
    const double now = mean + point.t * orbit.time;
    double anomaly = now;
    for (int k = 0; k < 100; ++k) anomaly -= (anomaly - e * std::sin(anomaly) - now) / (1.0 - e * std::cos(anomaly));
    std::array<double, 4> x{};
    for (std::size_t i = 0; i < 4; ++i) x[i] = point.x[i] * orbit.x[i];
    const double error =
        std::max(std::fabs(x[0] - std::cos(anomaly) + e), std::fabs(x[1] - minor * std::sin(anomaly)));
    errors.position = std::max(errors.position, error / orbit.tolerance);
    errors.momentum = std::max(errors.momentum, std::fabs(x[0] * x[3] - x[1] * x[2] - minor));
  }
  return errors;
}

}  // namespace

// Errors were 170 to 160,000 tolerances, without a word, and angular momenta off by up to 6e-4.
TEST(UnevenInvariants, HoldAndSoDoTheEquationsThatAreTaken) {
  for (const unsigned seed : {14U, 57U, 74U, 116U}) {
    const Orbit orbit = random_orbit(seed);
    const OrbitErrors errors = follow(orbit, SFDAE_STRUCTURE_OFF);
    EXPECT_LE(errors.position, 50.0) << seed;
    EXPECT_LE(errors.momentum, orbit.tolerance) << seed;
  }
}

}  // namespace sfdae_test
