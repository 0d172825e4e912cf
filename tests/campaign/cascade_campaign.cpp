// Cascades of operational amplifiers: values that are small and exact.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "extent.h"
#include "op_amp_cascade.h"
#include "tally.h"

namespace campaign {
namespace {

enum Family { cascade_family = 300, time_scale_family };

// k = 1, ..., 5 and G = 1e2, ..., 1e12 in all combinations, then other gains.
constexpr int decades = 11, most_stages = 5, combinations = decades * most_stages;

OpAmpCascade cascade_of(int number, RandomNumbers& random) {
  OpAmpCascade cascade;
  cascade.stages = 1 + number % most_stages;
  cascade.gain =
      number < combinations ? std::pow(10.0, 2 + number / most_stages % decades) : random.log_uniform(1e2, 1e12);
  return cascade;
}

// The numbers that follow "d = " in a message.
std::set<int> freedoms_named(const std::string& message) {
  std::set<int> result;
  for (std::size_t at = message.find("d = "); at != std::string::npos; at = message.find("d = ", at + 1))
    result.insert(std::atoi(message.c_str() + at + 4));
  return result;
}

// An unclear rank is a good answer if the right reading and another one are named.
bool names_both(const Answer& answer, int d) {
  const std::set<int> named = freedoms_named(answer.message);
  return named.size() >= 2 && named.count(d) == 1;
}

void add(Tally& tally, int number, const LinearProblem& problem, const Answer& answer) {
  if (answer.status == SFDAE_RANK_UNCLEAR && !names_both(answer, problem.values.d)) {
    tally.add_wrong(number, "the message does not name both results: " + answer.message);
  } else if (answer.status < 0 && answer.status != SFDAE_RANK_UNCLEAR) {
    tally.add_wrong(number, "another error: " + answer.message);
  } else {
    tally.add(number, problem, answer);
  }
}

// All may be refused.
constexpr double any_share = 1.0;

TEST(CascadeCampaign, GainIsSeenOrBothResultsAreNamed) {
  Tally tally("op-amp cascades");
  for (int number : problem_numbers(500, combinations)) {
    RandomNumbers random(cascade_family, static_cast<std::uint64_t>(number));
    const LinearProblem problem = op_amp_problem(cascade_of(number, random));
    add(tally, number, problem, analyze(problem));
  }
  tally.expect_at_most(any_share);
}

TEST(CascadeCampaign, TimeScaleOfTheUserChangesNoAnswer) {
  Tally tally("op-amp cascades, time_scale given");
  for (int number : problem_numbers(500, combinations)) {
    RandomNumbers random(time_scale_family, static_cast<std::uint64_t>(number));
    const LinearProblem problem = op_amp_problem(cascade_of(number, random));
    sfdae_options options = default_options();
    options.time_scale = std::pow(10.0, random.integer(-8, 3));
    add(tally, number, problem, analyze(problem, options));
  }
  tally.expect_at_most(any_share);
}

// The smallest pivot is about G^-k: where that is well above what an integrator can use, the problem is solved.
constexpr double usable = 1e8;

void integrate_cascades(int method, const std::string& name) {
  Tally tally("op-amp cascades by " + name);
  for (int number : problem_numbers(500, combinations)) {
    RandomNumbers random(cascade_family, static_cast<std::uint64_t>(number));
    const OpAmpCascade cascade = cascade_of(number, random);
    const LinearProblem problem = op_amp_problem(cascade);
    ExactSolution exact;
    exact.x = [cascade](double t) { return op_amp_solution(cascade, t); };
    exact.sizes.assign(static_cast<std::size_t>(problem.n), 1.0);
    const IntegrationSettings settings{1e-6, method};
    const IntegrationOutcome outcome = integrate(problem, exact, settings);
    const bool fits = outcome.answer.status >= 0 && error_fits(exact, settings.tolerance, outcome);
    if (outcome.answer.status < 0 && std::pow(cascade.gain, cascade.stages) <= usable) {
      tally.add_wrong(number, "not solved: " + outcome.answer.message);
    } else {
      tally.add(number, problem, outcome, fits);
    }
  }
  tally.expect_at_most(any_share);
}

TEST(CascadeCampaign, BdfFollowsThePeriodicSolution) { integrate_cascades(SFDAE_METHOD_BDF, "BDF"); }
TEST(CascadeCampaign, RadauFollowsThePeriodicSolution) { integrate_cascades(SFDAE_METHOD_RADAU, "Radau"); }

TEST(CascadeCampaign, IdealAmplifiersAreDifferentiators) {
  Tally tally("ideal op-amps");
  for (int number = 0; number < most_stages; ++number) {
    const OpAmpCascade cascade{1 + number, 0.0, true};
    const LinearProblem problem = op_amp_problem(cascade);
    ExactSolution exact;
    exact.x = [cascade](double t) { return op_amp_solution(cascade, t); };
    exact.sizes.assign(static_cast<std::size_t>(problem.n), 1.0);
    const IntegrationSettings settings;
    const IntegrationOutcome outcome = integrate(problem, exact, settings);
    tally.add(number, problem, outcome, error_fits(exact, settings.tolerance, outcome));
  }
  tally.expect_at_most(0.0);
}

}  // namespace
}  // namespace campaign
