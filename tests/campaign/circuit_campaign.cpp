// Random circuits in SI units: characteristic values by topology, periodic solutions.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "circuit.h"
#include "extent.h"
#include "nodal_equations.h"
#include "periodic_solution.h"
#include "tally.h"

namespace campaign {
namespace {

enum Family { circuit_family = 200, divider_family, integrated_family, unit_family };

// Shares of circuits that may be refused by the analysis, and by analysis or integration.
constexpr double refused = 0.01, not_integrated = 0.03;

TEST(CircuitCampaign, TopologyGivesIndexAndFreedom) {
  Tally tally("circuits in SI units");
  for (int number : problem_numbers(5000)) {
    RandomNumbers random(circuit_family, static_cast<std::uint64_t>(number));
    const Circuit circuit = random_circuit(si_units, random);
    LinearProblem problem = nodal_problem(circuit, *values_by_topology(circuit));
    problem.constant = random.chance(0.7);  // declared so
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
    const LinearProblem problem = nodal_problem(circuit, *values_by_topology(circuit));
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
    const LinearProblem problem = nodal_problem(circuit, values);
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(refused);
}

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
    const LinearProblem problem = nodal_problem(circuit, *values_by_topology(circuit));
    const IntegrationSettings settings{1e-6, method};
    const IntegrationOutcome outcome = integrate(problem, *exact, settings);
    const bool fits = outcome.answer.status >= 0 && error_fits(*exact, settings.tolerance, outcome);
    tally.add(number, problem, outcome, fits);
  }
  tally.expect_at_most(not_integrated);
}

TEST(CircuitCampaign, BdfFollowsPeriodicSolutions) { integrate_circuits(SFDAE_METHOD_BDF, "BDF"); }
TEST(CircuitCampaign, RadauFollowsPeriodicSolutions) { integrate_circuits(SFDAE_METHOD_RADAU, "Radau"); }

}  // namespace
}  // namespace campaign
