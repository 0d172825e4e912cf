// SPDX-License-Identifier: BSD-3-Clause
// Where norms mislead certificates decide, or both results are named.
#include "reduction/certificate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <vector>

#include "problem/failure.h"
#include "problem/linear_problem.h"
#include "reduction/index_analysis.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

// E x' = A x with constant coefficients, column by column.
struct Pencil {
  int n;
  std::vector<double> E, A;
  explicit Pencil(int size)
      : n(size), E(static_cast<std::size_t>(size * size), 0.0), A(static_cast<std::size_t>(size * size), 0.0) {}
  double& e(int i, int j) { return E[static_cast<std::size_t>(i + n * j)]; }
  double& a(int i, int j) { return A[static_cast<std::size_t>(i + n * j)]; }

  LinearFunctions functions() {
    LinearFunctions user;
    user.m = user.n = n;
    user.user = this;
    user.constant_E = user.constant_A = true;
    user.E = [](double, int, double* to, void* self) {
      return std::copy_n(static_cast<Pencil*>(self)->E.data(), static_cast<Pencil*>(self)->E.size(), to), 0;
    };
    user.A = [](double, int, double* to, void* self) {
      return std::copy_n(static_cast<Pencil*>(self)->A.data(), static_cast<Pencil*>(self)->A.size(), to), 0;
    };
    return user;
  }
};

struct Answer {
  int status = SFDAE_OK;
  CharacteristicValues values;
  std::string message;
};

Answer analyze(Pencil pencil, const AnalysisSettings& settings = {}) {
  LinearProblem problem(pencil.functions());
  Arena arena;
  std::vector<RankDecision> decisions;
  Answer answer;
  try {
    answer.values = analyze_index(problem, 0.0, 1.0, settings, arena, decisions).values;
  } catch (const Failure& failure) {
    answer.status = failure.status();
    answer.message = failure.what();
  }
  return answer;
}

// v0 = sin t; op-amps of gain G in a cascade, each with gate g, output o and current i:
//   i0 + v0' - g_1' = 0;  (g - p)' + g - o = 0;  g + o / G = 0;  o - g + i + (o - g_next)' = 0
// d is the number of op-amps for every finite gain, mu = 0.
Pencil cascade(int count, double gain) {
  Pencil p(2 + 3 * count);
  const auto g = [](int s) { return 2 + 3 * s; };
  p.a(0, 0) = -1.0;
  p.a(1, 1) = -1.0;
  p.e(1, 0) = 1.0;
  p.e(1, g(0)) = -1.0;
  for (int s = 0; s < count; ++s) {
    const int row = g(s), o = g(s) + 1, i = g(s) + 2, before = s == 0 ? 0 : g(s - 1) + 1;
    p.e(row, g(s)) = 1.0;
    p.e(row, before) = -1.0;
    p.a(row, g(s)) = -1.0;
    p.a(row, o) = 1.0;
    p.a(row + 1, g(s)) = -1.0;
    p.a(row + 1, o) = -1.0 / gain;
    p.a(row + 2, o) = -1.0;
    p.a(row + 2, g(s)) = 1.0;
    p.a(row + 2, i) = -1.0;
    if (s + 1 < count) {
      p.e(row + 2, o) += 1.0;
      p.e(row + 2, g(s + 1)) -= 1.0;
    }
  }
  return p;
}

// The tolerance that follows "rank_tol = " for the n-th time.
double tolerance_in(const std::string& message, int n) {
  std::size_t at = 0;
  for (int k = 0; k < n; ++k) at = message.find("rank_tol = ", at) + 11;
  return std::strtod(message.c_str() + at, nullptr);
}

}  // namespace

// Gains whose powers an integrator can use are seen; others are certain and useless: both results are named, with
// tolerances that lead to them.
TEST(Certificate, GainsOfCascadesAreSeenOrBothResultsAreNamed) {
  int seen = 0, named = 0;
  for (int count = 1; count <= 5; ++count)
    for (int decades = 2; decades <= 12; ++decades) {
      SCOPED_TRACE(std::to_string(count) + " op-amps, gain 1e" + std::to_string(decades));
      const Pencil pencil = cascade(count, std::pow(10.0, decades));
      const Answer answer = analyze(pencil);
      const CharacteristicValues right{0, count, 2 + 2 * count, 0, 0};
      if (answer.status == SFDAE_OK) {
        EXPECT_EQ(describe(answer.values), describe(right));
        EXPECT_LE(count * decades, 11);
        ++seen;
        continue;
      }
      ASSERT_EQ(answer.status, SFDAE_RANK_UNCLEAR);
      EXPECT_GE(count * decades, 8);
      ++named;
      EXPECT_NE(answer.message.find(describe(right) + " is certain"), std::string::npos) << answer.message;
      AnalysisSettings keeping, dropping;
      keeping.rank_tol = tolerance_in(answer.message, 1);
      dropping.rank_tol = tolerance_in(answer.message, 2);
      EXPECT_LT(keeping.rank_tol, dropping.rank_tol);
      EXPECT_EQ(describe(analyze(pencil, keeping).values), describe(right));
      const Answer other = analyze(pencil, dropping);
      EXPECT_NE(describe(other.values), describe(right));
      EXPECT_NE(answer.message.find(describe(other.values)), std::string::npos) << answer.message;
    }
  EXPECT_GE(seen, 10);
  EXPECT_GE(named, 20);
}

// What rounding errors become has to be less than the tolerances: at 1e-9 a pivot of 1e-6 / 3 is of no use any more.
TEST(Certificate, WhatIsOfUseDependsOnTheTolerances) {
  EXPECT_EQ(least_useful_pivot({}), 1e-10);
  EXPECT_EQ(least_useful_pivot({0.0, 1e-3}), 1e-10);
  EXPECT_NEAR(least_useful_pivot({1e-3, 1e-8, 0.0}), 1.11e-7, 1e-9);
  EXPECT_EQ(least_useful_pivot({1e-12}), 1e-6);  // as what norms decide alone
  const Pencil pencil = cascade(2, 10000.0);
  AnalysisSettings loose, tight;
  loose.least_useful_pivot = least_useful_pivot({1e-6});
  tight.least_useful_pivot = least_useful_pivot({1e-9});
  EXPECT_EQ(describe(analyze(pencil, loose).values), "mu = 0, d = 2, a = 6, u = 0, v = 0");
  const Answer answer = analyze(pencil, tight);
  EXPECT_EQ(answer.status, SFDAE_RANK_UNCLEAR);
  EXPECT_NE(answer.message.find("is certain"), std::string::npos) << answer.message;
}

// The user's unit of time does not change what is certain.
TEST(Certificate, TimeScalesOfTheUserDoNotHideValues) {
  AnalysisSettings settings;
  settings.time_scale = 1e-5;
  const Answer answer = analyze(cascade(3, 1e5), settings);
  EXPECT_EQ(answer.status, SFDAE_RANK_UNCLEAR);
  EXPECT_EQ(describe(analyze(cascade(3, 1e2), settings).values), "mu = 0, d = 3, a = 8, u = 0, v = 0");
}

// x' = -x times [1 r; 1 -r]: the second unknown in units of r.
TEST(Certificate, UnitsOfUnknownsLoseNoEquation) {
  for (int decades = 4; decades <= 40; ++decades) {
    Pencil p(2);
    const double r = std::pow(10.0, -decades);
    p.E = {1.0, 1.0, r, -r};
    p.A = {-1.0, -1.0, -r, r};
    EXPECT_EQ(describe(analyze(p).values), "mu = 0, d = 2, a = 0, u = 0, v = 0") << r;
  }
}

// One chain of three, E = P J Q T, A = P Q, in slow units of time T; condition 1 / delta.
TEST(Certificate, SlowUnitsOfTimeKeepTheIndex) {
  for (double delta : {1e-1, 1e-3, 1e-5})
    for (double T : {1.0, 1e4, 1e7, 1e9}) {
      double P[3][3], Q[3][3];
      for (int side = 0; side < 2; ++side)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            // Two rotations with a diagonal between them.
            double sum = 0.0;
            const double s = 0.7 + side, c = 1.3 - 0.4 * side;
            const double one[3][3] = {{std::cos(s), -std::sin(s), 0}, {std::sin(s), std::cos(s), 0}, {0, 0, 1}};
            const double two[3][3] = {{1, 0, 0}, {0, std::cos(c), -std::sin(c)}, {0, std::sin(c), std::cos(c)}};
            for (int k = 0; k < 3; ++k) sum += one[i][k] * std::pow(delta, k / 2.0) * two[k][j];
            (side == 0 ? P : Q)[i][j] = sum;
          }
      Pencil p(3);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int k = 0; k < 3; ++k) {
            p.a(i, j) += P[i][k] * Q[k][j];
            if (k < 2) p.e(i, j) += T * P[i][k] * Q[k + 1][j];
          }
      const Answer answer = analyze(p);
      if (answer.status == SFDAE_RANK_UNCLEAR && delta < 1e-4) continue;
      EXPECT_EQ(describe(answer.values), "mu = 2, d = 0, a = 3, u = 0, v = 0") << delta << ' ' << T << answer.message;
    }
}

// R1 - (C1 - C2 divider) - L - R2 in picofarads and megohms: d = 3. The row of the inner node has capacitors alone.
TEST(Certificate, CapacitiveDividersKeepTheirStates) {
  for (double R : {1.0, 1e3, 1e6})
    for (double C : {1e-12, 1e-9, 1e-6})
      for (double L : {1e-9, 1e-6, 1e-3}) {
        Pencil p(6);
        const double C1 = C, C2 = 3.3 * C, R1 = R, R2 = 47.0;
        p.e(1, 1) = C1, p.e(1, 3) = -C1, p.e(3, 3) = C1 + C2, p.e(3, 1) = -C1, p.e(4, 4) = L;
        p.a(0, 0) = -1.0 / R1, p.a(0, 1) = 1.0 / R1, p.a(0, 5) = -1.0;
        p.a(1, 0) = 1.0 / R1, p.a(1, 1) = -1.0 / R1, p.a(1, 4) = -1.0;
        p.a(2, 4) = 1.0, p.a(2, 2) = -1.0 / R2;
        p.a(4, 1) = 1.0, p.a(4, 2) = -1.0;
        p.a(5, 0) = 1.0;
        const Answer answer = analyze(p);
        EXPECT_EQ(describe(answer.values), "mu = 0, d = 3, a = 3, u = 0, v = 0")
            << R << ' ' << C << ' ' << L << answer.message;
      }
}

// Zeros that were computed, cos(pi/2) = 6e-17, are none in a tame problem; a value of 1e-14 beside ones is a
// question.
TEST(Certificate, RoundingErrorsInPlaceOfZerosAreZeros) {
  Pencil p(3);
  p.e(0, 0) = p.e(1, 1) = 1.0;
  p.a(0, 0) = -1.0, p.a(1, 0) = 0.5, p.a(1, 2) = 1.0, p.a(2, 1) = 1.0;
  const std::string right = "mu = 1, d = 1, a = 2, u = 0, v = 0";
  ASSERT_EQ(describe(analyze(p).values), right);
  p.e(2, 2) = std::cos(std::acos(0.0));
  EXPECT_EQ(describe(analyze(p).values), right);
  p.e(2, 2) = 1e-14;
  EXPECT_EQ(analyze(p).status, SFDAE_RANK_UNCLEAR);
}

// x1' = -x1, x1 = s x2, x2 = s x3: d = 1 rests on E T2 = s^2 = 1e-28, which norms take for zero, in any units of the
// user. Ranks that are suggested without it are not confirmed, nor those of other decisions.
TEST(Certificate, SuggestedRanksThatLoseExactValuesAreNotConfirmed) {
  const double s = 1e-14;
  Pencil p(3);
  p.e(0, 0) = 1.0, p.a(0, 0) = -1.0;
  p.a(1, 0) = p.a(2, 1) = 1.0, p.a(1, 1) = p.a(2, 2) = -s;
  LinearProblem problem(p.functions());
  TaylorData data;
  ASSERT_EQ(problem.evaluate(0.0, {0, 0, -1}, 1.0, data).status, SFDAE_OK);
  const BalancedUnits units;
  TrialPerturbations random;
  const auto certified = [&](std::initializer_list<int> ranks) {
    RankSequence suggested;
    for (int rank : ranks) suggested.add(rank);
    CertificateSettings settings{units, random};
    settings.suggested = &suggested;
    return certified_ranks(data, 0, settings);
  };
  const CertifiedRanks right = certified({1, 2, 1});
  EXPECT_TRUE(right.significance.is_clear());
  EXPECT_EQ(right.ranks.a, 2);
  EXPECT_EQ(right.ranks.d, 1);
  for (const auto& ranks : {std::initializer_list<int>{1, 2, 0}, {1, 1, 1}, {0, 2, 1}, {1, 2}, {2, 1, 1}, {1, 2, 2}})
    EXPECT_FALSE(certified(ranks).significance.is_clear()) << *ranks.begin() << ", " << *(ranks.end() - 1);
}

// The pencil diag(lambda + 1, 0) has rank 1 for every lambda, [lambda 1; 1 0] rank 2.
TEST(Certificate, RanksOfPencilsShowWhatIsRedundant) {
  Pencil singular(2), regular(2);
  singular.e(0, 0) = 1.0, singular.a(0, 0) = -1.0;
  regular.e(0, 0) = 1.0, regular.a(0, 1) = regular.a(1, 0) = -1.0;
  for (Pencil* pencil : {&singular, &regular}) {
    LinearProblem problem(pencil->functions());
    const BalancedUnits units = balanced_units(data_in_units(problem, 0.0, {}), {});
    TaylorData data;
    ASSERT_EQ(problem.evaluate(0.0, {1, 1, -1}, 1.0, data).status, SFDAE_OK);
    EXPECT_EQ(clear_pencil_rank(data, units), pencil == &singular ? 1 : 2);
    EXPECT_EQ(has_independent_rows(data, 1, units), pencil == &regular);
  }
}

}  // namespace sfdae::core
