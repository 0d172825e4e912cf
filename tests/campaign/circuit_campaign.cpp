// Random circuits in SI units: characteristic values by topology, periodic solutions.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "circuit.h"
#include "extent.h"
#include "tally.h"

namespace campaign {
namespace {

enum Family { circuit_family = 200, divider_family, integrated_family, unit_family };

// Share of circuits that may be refused.
constexpr double refused = 0.01;

TEST(CircuitCampaign, TopologyGivesIndexAndFreedom) {
  Tally tally("circuits in SI units");
  for (int number : problem_numbers(5000)) {
    RandomNumbers random(circuit_family, static_cast<std::uint64_t>(number));
    const Circuit circuit = random_circuit(si_units, random);
    const LinearProblem problem = modified_nodal_analysis(circuit, *values_by_topology(circuit));
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(refused);
}

// The generator itself: with values of size 1 nothing is difficult.
TEST(CircuitCampaign, TopologyGivesIndexAndFreedomForValuesOfSizeOne) {
  Tally tally("circuits of unit size");
  for (int number : problem_numbers(5000)) {
    RandomNumbers random(unit_family, static_cast<std::uint64_t>(number));
    const Circuit circuit = random_circuit(unit_sizes, random);
    const LinearProblem problem = modified_nodal_analysis(circuit, *values_by_topology(circuit));
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(0.001);
}

TEST(CircuitCampaign, CapacitiveDividerHasThreeDegreesOfFreedom) {
  Tally tally("capacitive dividers");
  for (int number : problem_numbers(4000)) {
    RandomNumbers random(divider_family, static_cast<std::uint64_t>(number));
    const Circuit circuit = random_divider(random);
    const CharacteristicValues values = *values_by_topology(circuit);
    ASSERT_EQ(values.d, 3);
    ASSERT_EQ(values.mu, 0);
    const LinearProblem problem = modified_nodal_analysis(circuit, values);
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(refused);
}

// Largest error at the end, relative to the sizes of the unknowns.
struct Outcome {
  Answer answer;
  double error = 0.0;
};

constexpr double tolerance = 1e-6;

Outcome integrate(const LinearProblem& problem, const PeriodicSolution& exact, int method) {
  std::vector<double> atol = exact.sizes;
  for (double& value : atol) value *= tolerance;
  sfdae_options options = default_options();
  options.rtol = tolerance;
  options.atol_vector = atol.data();
  options.method = method;
  options.max_steps = 20000;
  LinearCallbacks callbacks(problem);
  Solver solver(callbacks, options);
  std::vector<double> x = exact.at(0.0);
  int status = sfdae_start(solver.get(), 0.0, problem.end, x.data(), nullptr);
  Outcome outcome;
  double t = 0.0;
  for (double tout : {0.4 * problem.end, problem.end}) {
    if (status >= 0) status = sfdae_advance(solver.get(), tout, &t, x.data(), nullptr);
    outcome.answer = answer_of(solver.get(), status);
    if (single_problem()) print(problem, solver.get());
    if (status < 0) return outcome;
    const std::vector<double> reference = exact.at(tout);
    for (std::size_t j = 0; j < x.size(); ++j)
      outcome.error = std::max(outcome.error, std::abs(x[j] - reference[j]) / exact.sizes[j]);
  }
  return outcome;
}

// Passive circuits do not amplify errors, but lossless parts keep them: a hundred times the tolerance of a step.
constexpr double largest_error = 100.0 * tolerance;

void integrate_circuits(int method, const std::string& name) {
  Tally tally("circuits integrated by " + name);
  for (int number : problem_numbers(1000)) {
    RandomNumbers random(integrated_family, static_cast<std::uint64_t>(number));
    Circuit circuit = random_circuit(si_units, random);
    auto exact = periodic_solution(circuit, random);
    while (!exact) {
      circuit = random_circuit(si_units, random);
      exact = periodic_solution(circuit, random);
    }
    const LinearProblem problem = modified_nodal_analysis(circuit, *values_by_topology(circuit));
    const Outcome outcome = integrate(problem, *exact, method);
    if (outcome.answer.status >= 0 && outcome.answer.values == problem.values && !(outcome.error <= largest_error)) {
      char text[80];
      std::snprintf(text, sizeof text, "error %.1e of the size", outcome.error);
      tally.add_wrong(number, text);
    } else {
      tally.add(number, problem, outcome.answer);
    }
  }
  tally.expect_at_most(refused);
}

TEST(CircuitCampaign, BdfFollowsPeriodicSolutions) { integrate_circuits(SFDAE_METHOD_BDF, "BDF"); }
TEST(CircuitCampaign, RadauFollowsPeriodicSolutions) { integrate_circuits(SFDAE_METHOD_RADAU, "Radau"); }

}  // namespace
}  // namespace campaign
