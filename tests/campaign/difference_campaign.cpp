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
constexpr double refused = 0.05;

TEST(DifferenceCampaign, MissingDerivativesAreFoundOrNamed) {
  Tally tally("missing derivatives");
  for (int number : problem_numbers(3000)) {
    RandomNumbers random(difference_family, static_cast<std::uint64_t>(number));
    const UndifferentiatedProblem drawn = random_undifferentiated_problem(random);
    const IntegrationSettings settings{drawn.tolerance, number % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU,
                                       true};
    const IntegrationOutcome outcome = integrate(drawn.problem, drawn.exact, settings);
    tally.add(number, drawn.problem, outcome, outcome.error <= 100.0 * drawn.tolerance);
  }
  tally.expect_at_most(refused);
}

}  // namespace
}  // namespace campaign
