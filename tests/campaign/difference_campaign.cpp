// Problems whose derivatives the library has to find by differences.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "extent.h"
#include "tally.h"
#include "undifferentiated_problem.h"

namespace campaign {
namespace {

enum Family { difference_family = 500 };

// Share of problems that may be refused.
constexpr double refused = 0.13;

void solve_all(Tally& tally, bool differences, int full) {
  for (int number : problem_numbers(full)) {
    RandomNumbers random(difference_family, static_cast<std::uint64_t>(number));
    UndifferentiatedProblem drawn = random_undifferentiated_problem(random);
    if (!differences) drawn.problem.available_order = LinearProblem().available_order;
    const IntegrationSettings settings{drawn.tolerance, number % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU,
                                       differences};
    const IntegrationOutcome outcome = integrate(drawn.problem, drawn.exact, settings);
    tally.add(number, drawn.problem, outcome, error_fits(drawn.exact, drawn.tolerance, outcome));
  }
}

TEST(DifferenceCampaign, MissingDerivativesAreFoundOrNamed) {
  Tally tally("missing derivatives");
  solve_all(tally, true, 3000);
  tally.expect_at_most(refused);
}

// The generator itself: with derivatives nothing is difficult.
TEST(DifferenceCampaign, SameProblemsWithDerivativesAreRight) {
  Tally tally("the same with derivatives");
  solve_all(tally, false, 3000);
  tally.expect_at_most(refused);
}

}  // namespace
}  // namespace campaign
