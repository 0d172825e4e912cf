// Characteristic values of random linear problems, made of Kronecker forms.
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "extent.h"
#include "kronecker_problem.h"
#include "tally.h"

namespace campaign {
namespace {

// One number for each family: the first argument of RandomNumbers.
enum Family { tame_family = 100, units_family, slow_family, hard_family, stiff_family, same_answer_family };

// Shares of named errors that are allowed. Data that are dense, rounded and stiff do not determine their values.
constexpr double named_tame = 0.001, named_hard = 0.03, named_dense_rounded_stiff = 0.3;
constexpr double stiff_from = 1e5;

bool is_dense_rounded_stiff(const KroneckerProblem& problem) {
  return problem.dense && !problem.exact && problem.stiffness >= stiff_from;
}

// The first problem of the stream that is of the wanted kind.
KroneckerProblem draw(const Difficulty& difficulty, bool dense_rounded_stiff, RandomNumbers& random) {
  for (;;) {
    KroneckerProblem drawn = random_kronecker_problem(difficulty, random);
    if (is_dense_rounded_stiff(drawn) == dense_rounded_stiff) return drawn;
  }
}

TEST(LinearCampaign, TameProblemsAreRight) {
  Tally tally("tame");
  for (int number : problem_numbers(30000)) {
    RandomNumbers random(tame_family, static_cast<std::uint64_t>(number));
    const LinearProblem problem = draw(tame, false, random).problem;
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(named_tame);
}

TEST(LinearCampaign, TameProblemsAreRightInAnyUnits) {
  Tally tally("tame in random units");
  for (int number : problem_numbers(20000)) {
    RandomNumbers random(units_family, static_cast<std::uint64_t>(number));
    LinearProblem problem = draw(tame, false, random).problem;
    problem.units = random_units(problem.m, problem.n, random);
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(named_hard);
}

TEST(LinearCampaign, TameProblemsAreRightInSlowUnitsOfTime) {
  Tally tally("tame, slow units of time");
  for (int number : problem_numbers(10000)) {
    RandomNumbers random(slow_family, static_cast<std::uint64_t>(number));
    LinearProblem problem = draw(tame, false, random).problem;
    problem.units.time = random.log_uniform(1e3, 1e8);
    tally.add(number, problem, analyze(problem));
  }
  tally.expect_at_most(named_hard);
}

// Problems whose data determine their values, and others: there any number of errors may be named, but nothing wrong.
class HardTally {
 public:
  explicit HardTally(const std::string& family)
      : determined_(family), undetermined_(family + ", not determined by rounded data") {}
  void add(int number, const KroneckerProblem& drawn) {
    Tally& tally = determined(drawn) ? determined_ : undetermined_;
    tally.add(number, drawn.problem, analyze(drawn.problem));
  }
  void expect_at_most(double share) const {
    determined_.expect_at_most(share);
    undetermined_.expect_at_most(1.0);
  }

 private:
  Tally determined_, undetermined_;
};

TEST(LinearCampaign, HardProblemsAreRightOrNamed) {
  HardTally tally("hard");
  for (int number : problem_numbers(30000)) {
    RandomNumbers random(hard_family, static_cast<std::uint64_t>(number));
    KroneckerProblem drawn = draw(hard, false, random);
    if (random.chance(0.7)) drawn.problem.units = random_units(drawn.problem.m, drawn.problem.n, random);
    tally.add(number, drawn);
  }
  tally.expect_at_most(named_hard);
}

TEST(LinearCampaign, DenseRoundedStiffProblemsAreRightOrNamed) {
  HardTally tally("dense, rounded and stiff");
  for (int number : problem_numbers(10000)) {
    RandomNumbers random(stiff_family, static_cast<std::uint64_t>(number));
    KroneckerProblem drawn = draw(hard, true, random);
    if (random.chance(0.7)) drawn.problem.units = random_units(drawn.problem.m, drawn.problem.n, random);
    tally.add(number, drawn);
  }
  tally.expect_at_most(named_dense_rounded_stiff);
}

TEST(LinearCampaign, AnswersDoNotDependOnUnits) {
  HardTally tally("the same problem in 20 systems of units");
  for (int number : problem_numbers(2000)) {
    RandomNumbers random(same_answer_family, static_cast<std::uint64_t>(number));
    KroneckerProblem drawn = draw(number % 2 == 0 ? tame : hard, false, random);
    for (int system = 0; system < 20; ++system) {
      drawn.problem.units = random_units(drawn.problem.m, drawn.problem.n, random);
      tally.add(number, drawn);
    }
  }
  tally.expect_at_most(named_hard);
}

}  // namespace
}  // namespace campaign
