// 10,000 random problems of known structure, by both reductions.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "family_problem.h"
#include "family_run.h"
#include "random_family.h"

namespace {

using namespace sfdae_test;

struct Tally {
  int right = 0, named_errors = 0, wrong = 0;
};

Tally classify(std::shared_ptr<const LinearFamily> family, int seed, int reduction) {
  Tally tally;
  FamilyProblem problem(family);
  sfdae_options options = options_with_tolerance(1e-6);
  options.reduction = reduction;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem.problem, &options), SFDAE_OK);
  sfdae_characteristics found;
  sfdae_characteristics_init(&found, sizeof found);
  const int status = sfdae_analyze(solver, 0.3, 1.0, &found);
  const CharacteristicValues expected = family->values();
  const bool same = found.strangeness_index == expected.mu && found.differential == expected.d &&
                    found.algebraic == expected.a && found.undetermined == expected.u &&
                    found.redundant == expected.v;
  if (status < 0) {
    ++tally.named_errors;
    EXPECT_EQ(status, SFDAE_RANK_UNCLEAR) << "seed " << seed << ": " << sfdae_message(solver);
  } else if (same) {
    ++tally.right;
  } else {
    ++tally.wrong;
    ADD_FAILURE() << "seed " << seed << ": " << family->name();
  }
  sfdae_destroy(&solver);
  return tally;
}

Tally classify(int first, int count, const RandomOptions& random, int reduction) {
  Tally sum;
  for (int seed = first; seed < first + count; ++seed) {
    const Tally one = classify(random_family(static_cast<std::uint64_t>(seed), random), seed, reduction);
    sum.right += one.right;
    sum.named_errors += one.named_errors;
    sum.wrong += one.wrong;
  }
  return sum;
}

class RandomProblems : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Reductions, RandomProblems, testing::Values(SFDAE_REDUCTION_STAGED, SFDAE_REDUCTION_SVD),
                         [](const auto& instance) {
                           return instance.param == SFDAE_REDUCTION_SVD ? "svd" : "staged";
                         });

TEST_P(RandomProblems, AllHaveTheRightCharacteristicValues) {
  const int count = scaled_count(5000);
  RandomOptions random;
  random.w = 1.0;
  const Tally tally = classify(1, count / 2 + 1, random, GetParam());
  EXPECT_EQ(tally.named_errors, 0);
  // Rows times 1e-10 ... 1e10: where such a row is small by cancellation besides, its rounding errors cannot be told
  // from entries, and the answer may be a named error.
  random.row_decades = 10;
  EXPECT_LE(classify(100001, count / 2, random, GetParam()).named_errors, 1 + count / 2000);
}

// Fast rotations at mu = 4 make Taylor coefficients grow until some decisions are unclear: these are named, none is
// wrong.
TEST_P(RandomProblems, FastRotationsGiveTheRightValuesOrANamedError) {
  const int count = scaled_count(1000);
  RandomOptions random;
  random.w = 4.0;
  const Tally tally = classify(200001, count, random, GetParam());
  EXPECT_LE(tally.named_errors, 1 + count / 100);
}

// Slow rotations make tau large, stiff dynamics |E^-1 A|: errors grow from stage to stage. Rows may be scaled besides.
TEST_P(RandomProblems, SlowAndStiffOnesGiveTheRightValuesOrANamedError) {
  const int count = scaled_count(5000);
  Tally tally;
  for (int seed = 300001; seed <= 300000 + count; ++seed) {
    RandomNumbers numbers(static_cast<std::uint64_t>(seed));
    RandomOptions random;
    random.max_size = numbers.integer(2, 12);
    random.max_mu = std::min(numbers.integer(0, 4), random.max_size - 1);
    random.w = std::pow(10.0, numbers.uniform(-3.0, 0.6));
    random.sigma = std::pow(10.0, numbers.uniform(0.0, 2.3));
    random.row_decades = std::max(0, numbers.integer(-10, 10));
    tally.named_errors += classify(seed, 1, random, GetParam()).named_errors;
  }
  EXPECT_LE(tally.named_errors, 5 + count / 50);
}

// The same for Kronecker forms with u = v up to 2, half of them in one piece without a redundant equation.
TEST_P(RandomProblems, SlowAndStiffKroneckerFormsGiveTheRightValuesOrANamedError) {
  const int count = scaled_count(2000);
  int named_errors = 0;
  for (int seed = 1; seed <= count; ++seed) {
    RandomNumbers numbers(static_cast<std::uint64_t>(seed));
    const int mu = numbers.integer(0, 4), u = std::max(0, numbers.integer(-2, 2));
    const int n = mu + 1 + u + numbers.integer(0, 6);
    const double w = std::pow(10.0, numbers.uniform(-3.0, 0.6)), sigma = std::pow(10.0, numbers.uniform(0.0, 2.3));
    named_errors += classify(kron(n, mu, w, u, seed, sigma), seed, GetParam()).named_errors;
  }
  EXPECT_LE(named_errors, 5 + count / 12);
}

// Start, steps and outputs: consistent redundant equations pass, and what is determined is solved to ten tolerances.
TEST(RandomIntegrations, AreSolved) {
  const int count = scaled_count(400);
  int failures = 0;
  for (int decades : {0, 10})
    for (int seed = 1; seed <= count; ++seed) {
      RandomOptions random;
      random.w = 1.0;
      random.row_decades = decades;
      const std::shared_ptr<const LinearFamily> family = random_family(static_cast<std::uint64_t>(seed), random);
      FamilyProblem problem(family);
      const FamilyRun run = run_family(problem, 0.0, 1.0, options_with_tolerance(1e-6), 4);
      if (run.status < 0) {
        ++failures;
        EXPECT_EQ(decades, 10) << "seed " << seed << ": " << run.message;
        continue;
      }
      if (family->values().u > 0) continue;
      EXPECT_LE(run.step_error, 10.0) << "seed " << seed;
      EXPECT_LE(run.output_error, 10.0) << "seed " << seed;
    }
  // Rows that are small by cancellation and scaled by 1e-10 ... 1e10 besides may become undecidable along the way.
  EXPECT_LE(failures, 1 + count / 200);
}

}  // namespace
