// The generators themselves.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "extent.h"
#include "kronecker_problem.h"
#include "undifferentiated_problem.h"

namespace campaign {
namespace {

enum Family { derivatives_family = 600, f_family };

void expect_derivatives(const LinearProblem& problem, int number) {
  LinearCallbacks callbacks(problem);
  Solver solver(callbacks, default_options());
  sfdae_derivative_check check;
  sfdae_derivative_check_init(&check, sizeof check);
  ASSERT_EQ(sfdae_check_derivatives(solver.get(), problem.begin + 0.0123, 3, &check), SFDAE_OK) << number;
  EXPECT_EQ(check.suspicious, 0) << "number " << number << ": " << sfdae_message(solver.get());
}

// Differences of each order are the next one.
TEST(Generators, DerivativesOfKroneckerProblemsAreExact) {
  for (int number : problem_numbers(500, 10)) {
    RandomNumbers random(derivatives_family, static_cast<std::uint64_t>(number));
    expect_derivatives(random_kronecker_problem(tame, random).problem, number);
  }
}

TEST(Generators, DerivativesOfGroupsAreExact) {
  for (int number : problem_numbers(500, 10)) {
    RandomNumbers random(f_family, static_cast<std::uint64_t>(number));
    LinearProblem problem = random_undifferentiated_problem(random).problem;
    problem.available_order = LinearProblem().available_order;
    expect_derivatives(problem, number);
  }
}

}  // namespace
}  // namespace campaign
