// SPDX-License-Identifier: BSD-3-Clause
// Recorded problems in SI units and in random ones: pressures of 1e7 Pa beside openings of 1e-4, oil of 1e9 Pa,
// networks of pipes. Arrays of these are beyond double precision in part, the equations that structure asks for are
// not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "nonlinear_run.h"
#include "random.h"

namespace {

using namespace sfdae_test;

using Numbers = std::vector<double>;
std::size_t as_index(int i) { return static_cast<std::size_t>(i); }

struct Model {
  int n, mu;
  Numbers guess, sizes;
  double end;
  std::function<void(const Expression&, const Expression*, const Expression*, Expression*)> residual;
};

// The piston of a hydraulic cylinder is to move along x(t): how far is the valve to be open? 500 kg, 20 cm2, 200 bar.
double path(double t) { return 0.1 + 0.02 * t + 0.03 * std::sin(t) * std::sin(t); }
Model cylinder() {
  return {4, 3, {0.1, 0.0, 2e6, 1e-4}, {0.1, 0.1, 2e6, 1e-4}, 5.0, [](const auto& t, auto* x, auto* xdot, auto* F) {
            F[0] = xdot[0] - x[1];
            F[1] = 500.0 * xdot[1] - (2e-3 * x[2] - 2452.5 - 200.0 * x[1]);
            F[2] = (1e-3 + 2e-3 * x[0]) * xdot[2] - 1.4e9 * (1e-3 * x[3] * sqrt(2e7 - x[2]) - 2e-3 * x[1]);
            F[3] = x[0] - 0.1 - 0.02 * t - 0.03 * sin(t) * sin(t);
          }};
}
Numbers exact_cylinder(double t) {
  const double v = 0.02 + 0.03 * std::sin(2 * t), a = 0.06 * std::cos(2 * t), jerk = -0.12 * std::sin(2 * t);
  const double p = (500.0 * a + 2452.5 + 200.0 * v) / 2e-3, slope = (500.0 * jerk + 200.0 * a) / 2e-3;
  const double flow = (1e-3 + 2e-3 * path(t)) * slope / 1.4e9 + 2e-3 * v;
  return {path(t), v, p, flow / (1e-3 * std::sqrt(2e7 - p))};
}

// Pipes between four nodes and a reservoir: pressures in Pa, flows in m3/s, demands given: strangeness index 1.
Model water_network() {
  Model model{10, 1, Numbers(10, 2e5), Numbers(10, 1e5), 100.0, {}};
  for (int k = 4; k < 10; ++k) model.guess[as_index(k)] = model.sizes[as_index(k)] = 0.01;
  model.residual = [](const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    constexpr int from[] = {-1, 0, 0, 1, 2, 1}, to[] = {0, 1, 2, 3, 3, 2};
    constexpr double length[] = {1.0, 2.0, 1.5, 1.0, 0.7, 0.4};
    for (int j = 0; j < 4; ++j) F[6 + j] = -0.002 * (j + 1) * (1.0 + 0.3 * sin(t / (20.0 + 5.0 * j)));
    for (int k = 0; k < 6; ++k) {
      const Expression q = x[4 + k], above = from[k] < 0 ? 5e5 + 2e4 * sin(t / 30.0) : x[from[k]];
      F[k] = 3e6 * length[k] * xdot[4 + k] - (above - x[to[k]] - 3e8 * length[k] * q * sqrt(q * q + 1e-8));
      F[6 + to[k]] = F[6 + to[k]] + q;
      if (from[k] >= 0) F[6 + from[k]] = F[6 + from[k]] - q;
    }
  };
  return model;
}

// A bar that hangs by one end: masses, lengths, angles and forces in one block of the system Jacobian. Unknowns: the
// centre, the angle, their velocities, the forces at the joint.
constexpr double gravity_in_units = 9.81;
double period(double length) { return std::sqrt(length / gravity_in_units); }
Model bar(double length, double mass) {
  const double half = 0.5 * length, force = mass * gravity_in_units, T = period(length), angle = -1.0;
  Model model{8, 2, {half * std::cos(angle), half * std::sin(angle), angle}, {}, 10.0 * T, {}};
  model.guess.resize(8);
  model.sizes = {length, length, 1.0, length / T, length / T, 1.0 / T, force, force};
  model.residual = [=](const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    for (int i = 0; i < 3; ++i) F[i] = xdot[i] - x[3 + i];
    F[3] = mass * xdot[3] + x[6];
    F[4] = mass * xdot[4] + force + x[7];
    F[5] = mass * length * length / 12.0 * xdot[5] + half * (sin(x[2]) * x[6] - cos(x[2]) * x[7]);
    F[6] = x[0] - half * cos(x[2]);
    F[7] = x[1] - half * sin(x[2]);
  };
  return model;
}

// The same, with other units of unknowns, equations and time.
struct Units {
  Numbers of_x, of_F;
  double of_time = 1.0;
};

Units random_units(int n, unsigned seed) {
  Random random(seed);
  Units units{Numbers(as_index(n), 1.0), Numbers(as_index(n), 1.0)};
  if (seed == 0) return units;
  for (double& unit : units.of_x) unit = std::pow(10.0, random.real(-3.0, 3.0));
  for (double& unit : units.of_F) unit = std::pow(10.0, random.real(-3.0, 3.0));
  units.of_time = std::pow(10.0, random.real(-3.0, 3.0));
  return units;
}

NonlinearEquations in_units(const Model& model, const Units& units) {
  return equations_of(model.n, model.n, [model, units](const auto& t, const auto* y, const auto* slope, auto* F) {
    std::vector<Expression> x, xdot;
    for (int i = 0; i < model.n; ++i) {
      x.push_back(units.of_x[as_index(i)] * y[i]);
      xdot.push_back(units.of_x[as_index(i)] / units.of_time * slope[i]);
    }
    model.residual(units.of_time * t, x.data(), xdot.data(), F);
    for (int i = 0; i < model.n; ++i) F[i] = units.of_F[as_index(i)] * F[i];
  });
}

// At the end, in units of the model.
Numbers solution(const Model& model, const Units& units, const sfdae_options& wanted, const std::string& what) {
  sfdae_options options = wanted;
  const double tolerance = options.rtol;
  Numbers atol = model.sizes, guess = model.guess;
  for (int i = 0; i < model.n; ++i)
    atol[as_index(i)] *= tolerance / units.of_x[as_index(i)], guess[as_index(i)] /= units.of_x[as_index(i)];
  options.atol_vector = atol.data();
  NonlinearRun run(in_units(model, units), options);
  const int status = run.created < 0 ? run.created : run.integrate(0.0, model.end / units.of_time, guess);
  EXPECT_GE(status, SFDAE_OK) << what << ": " << status_text(run, status);
  if (status < 0) return {};
  EXPECT_EQ(run.values().mu, model.mu) << what;
  for (int i = 0; i < model.n; ++i) run.x[as_index(i)] *= units.of_x[as_index(i)];
  return run.x;
}

// Errors of the values at the end, in tolerances.
double error_of(const Model& model, const Numbers& x, const Numbers& reference, double tolerance) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    largest =
        std::max(largest, std::fabs(x[i] - reference[i]) / (tolerance * (std::fabs(reference[i]) + model.sizes[i])));
  return largest;
}

void expect_solved(const Model& model, const Numbers& reference, int structure, double most_tolerances = 10.0) {
  constexpr unsigned seeds = 20;
  ASSERT_EQ(reference.size(), as_index(model.n));
  for (unsigned seed = 0; seed < seeds; ++seed)
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      constexpr double tolerance = 1e-6;
      const std::string what = "seed " + std::to_string(seed) + ", method " + std::to_string(method);
      sfdae_options options = options_with(tolerance, method);
      options.structure = structure;
      const Numbers x = solution(model, random_units(model.n, seed), options, what);
      EXPECT_LE(error_of(model, x, reference, tolerance), most_tolerances) << what;
    }
}

}  // namespace

// The array alone says SFDAE_RANK_UNCLEAR in some of these units.
TEST(UnevenUnits, OfAHydraulicCylinder) { expect_solved(cylinder(), exact_cylinder(5.0), SFDAE_STRUCTURE_AUTOMATIC); }

// Flows that fulfil the demands change friction, and residuals of other equations, by far more than remains of the
// demands.
TEST(UnevenUnits, OfAWaterNetwork) {
  const Model model = water_network();
  const Numbers reference =
      solution(model, random_units(model.n, 0), options_with(1e-10, SFDAE_METHOD_RADAU), "reference");
  for (const int structure : {SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_AUTOMATIC})
    expect_solved(model, reference, structure);
}

namespace {

// By similarity all bars move as one of 1 m and 1 kg does.
Numbers exact_bar(const Model& model) {
  const Model metre = bar(1.0, 1.0);
  Numbers x = solution(metre, random_units(metre.n, 0), options_with(1e-10, SFDAE_METHOD_RADAU), "reference");
  for (std::size_t i = 0; i < x.size(); ++i) x[i] *= model.sizes[i] / metre.sizes[i];
  return x;
}

}  // namespace

// 10 micrometres, 1e-9 kg: a moment of inertia of 8e-21 kg m2 is no rounding error beside the 1 of x'.
TEST(UnevenUnits, OfABarOfAMicrosystem) {
  const Model model = bar(1e-5, 1e-9);
  expect_solved(model, exact_bar(model), SFDAE_STRUCTURE_AUTOMATIC, 50.0);
}

// Its array may refuse it, but does not drop the moment of inertia and solve something else, with d = 1.
TEST(UnevenUnits, OfABarAreSolvedOrRefusedByTheArray) {
  const Model model = bar(1e-5, 1e-9);
  const Numbers reference = exact_bar(model);
  int solved = 0;
  for (const unsigned seed : {0, 1, 2, 3, 85, 86, 87, 137, 138, 139}) {  // 86 and 138 were wrong
    const Units units = random_units(model.n, seed);
    sfdae_options options = options_with(1e-6, SFDAE_METHOD_RADAU);
    options.structure = SFDAE_STRUCTURE_OFF;
    Numbers atol = model.sizes, guess = model.guess;
    for (int i = 0; i < model.n; ++i)
      atol[as_index(i)] *= 1e-6 / units.of_x[as_index(i)], guess[as_index(i)] /= units.of_x[as_index(i)];
    options.atol_vector = atol.data();
    NonlinearRun run(in_units(model, units), options);
    const int status = run.created < 0 ? run.created : run.integrate(0.0, model.end / units.of_time, guess);
    if (status < 0) continue;
    ++solved;
    for (int i = 0; i < model.n; ++i) run.x[as_index(i)] *= units.of_x[as_index(i)];
    EXPECT_EQ(run.values().d, 2) << seed;
    EXPECT_LE(error_of(model, run.x, reference, 1e-6), 50.0) << seed;
  }
  EXPECT_GT(solved, 0);
}
