// Families with known solutions through DGELDA: the error stays within ten tolerances at every step and output.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "dgelda_family_run.h"
#include "family_run.h"
#include "random_family.h"

namespace {

using namespace sfdae_test;

// With SFDAE_TEST_SCALE below 1 a part of the cases, spread evenly.
bool is_skipped(int number) { return number % (100 / scaled_count(100)) != 0; }

class DgeldaFamilies : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, DgeldaFamilies, testing::Values(1, 2), method_name);

void expect_accurate(std::unique_ptr<LinearFamily> family, int method, double tol) {
  SCOPED_TRACE(family->name() + ", tol = " + std::to_string(tol * 1e9) + "e-9");
  const CharacteristicValues expected = family->values();
  DgeldaFamily<std::int32_t> functions(std::move(family));
  const DgeldaFamilyRun run = run_dgelda(functions, 0.0, 1.0, {.method = method, .tol = tol});
  ASSERT_EQ(run.ierr, 3) << "at t = " << run.t;
  EXPECT_EQ(run.values, expected);
  EXPECT_EQ(functions.wrong_arguments, 0);
  EXPECT_LE(run.step_error, 10.0);
  EXPECT_LE(run.output_error, 10.0);
}

TEST_P(DgeldaFamilies, KronIsSolvedToTenTolerances) {
  int number = 0;
  for (int n : {4, 8, 16, 32})
    for (int mu = 0; mu <= 3; ++mu)
      for (double w : {0.5, 4.0})
        for (double tol : {1e-3, 1e-5, 1e-7, 1e-9})
          if (!is_skipped(number++)) expect_accurate(kron(n, mu, w), GetParam(), tol);
}

TEST_P(DgeldaFamilies, ChainIsSolvedToTenTolerances) {
  int number = 0;
  for (int m : {4, 10})
    for (double tol : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9})
      if (!is_skipped(number++)) expect_accurate(chain(m, m / 5 + 1), GetParam(), tol);
}

// Random square systems, in both directions, with TSTOP: nothing is evaluated outside [T, TSTOP].
enum class Kind { turning, constant, rows_of_all_sizes, with_free_components };

RandomOptions random_options(Kind kind) {
  RandomOptions options;
  options.max_size = 12;
  options.max_mu = 3;
  options.max_undetermined = options.max_redundant = kind == Kind::with_free_components ? 2 : 0;
  if (kind == Kind::constant) options.w = 0.0, options.scalings = false;
  if (kind == Kind::rows_of_all_sizes) options.row_decades = 6;
  return options;
}

void expect_random_solved(int seed, Kind kind, int method) {
  const std::shared_ptr<const LinearFamily> family =
      random_family(static_cast<std::uint64_t>(seed), random_options(kind));
  if (family->m() != family->n()) return;
  SCOPED_TRACE("seed " + std::to_string(seed) + ", kind " + std::to_string(static_cast<int>(kind)));
  const double tol = seed % 3 == 0 ? 1e-3 : seed % 3 == 1 ? 1e-6 : 1e-8;
  const double start = seed % 5 == 0 ? 1.0 : 0.0, stop = 1.0 - start;
  double smallest = start, largest = start;
  DgeldaFamily<std::int32_t> functions(family);
  functions.problem.hooks.status = [&](const Call& call) {
    smallest = std::min(smallest, call.t);
    largest = std::max(largest, call.t);
    return 0;
  };
  Dgelda<std::int32_t> call = functions.arguments(method, start);
  call.set_tolerance(tol);
  call.info(4) = 1;
  call.rwork(1) = stop;
  call.info(5) = kind == Kind::constant && seed % 2 == 0 ? 1 : 0;
  for (int k = 1; k <= 4; ++k) {
    ASSERT_EQ(call.call(start + (stop - start) * k / 4.0), 3);
    if (family->values().u == 0) {
      EXPECT_LE(weighted_error(*family, tol, call.t, call.x.data()), 10.0);
    }
  }
  const auto value = [&](int i) { return static_cast<int>(call.cval(i)); };
  EXPECT_EQ((CharacteristicValues{value(1), value(2), value(3), value(4), value(4)}), family->values());
  EXPECT_GE(smallest, 0.0);
  EXPECT_LE(largest, 1.0);
  EXPECT_TRUE(call.guards_intact());
  EXPECT_EQ(functions.wrong_arguments, 0);
}

TEST_P(DgeldaFamilies, RandomProblemsAreSolved) {
  for (int seed = 1; seed <= scaled_count(1000); ++seed)
    for (Kind kind : {Kind::turning, Kind::constant, Kind::rows_of_all_sizes, Kind::with_free_components})
      expect_random_solved(seed, kind, GetParam());
}

// Steps of the original's Radau method for t in [0, 1] on kron(32, 2), published measurements of GELDA 1.1.1 without
// the steps that failed. Its errors are 0.09 ... 0.002 tolerances, so fewer steps can do.
struct Mark {
  double tol;
  long steps;
};
TEST(DgeldaRadau, NeedsNoMoreStepsThanTheOriginal) {
  for (const Mark& mark : {Mark{1e-3, 7}, Mark{1e-5, 15}, Mark{1e-7, 36}, Mark{1e-9, 99}}) {
    DgeldaFamily<std::int32_t> functions(kron(32, 2, 0.5));
    Dgelda<std::int32_t> call = functions.arguments(2);
    call.set_tolerance(mark.tol);
    ASSERT_EQ(call.call(1.0), 3);
    EXPECT_LE(call.steps(), mark.steps) << mark.tol;
  }
}

}  // namespace
