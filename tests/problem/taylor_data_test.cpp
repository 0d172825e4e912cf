// SPDX-License-Identifier: BSD-3-Clause
// Scaling of Taylor coefficients: rows, time, and what happens at the ends of the range of numbers.
#include "problem/taylor_data.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <utility>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"

namespace sfdae::core {

namespace {

using sfdae_test::factorial;
using sfdae_test::random_matrix;
using sfdae_test::rounding;
using sfdae_test::size;
using Numbers = std::vector<double>;

// 1 x 1: E(k) = E[k], A(k) = A[k], f(k) = f[k], plain derivatives.
TaylorData scalar(const Numbers& E, const Numbers& A, const Numbers& f = {0.0}) {
  TaylorData data;
  data.resize(1, 1, {static_cast<int>(E.size()) - 1, static_cast<int>(A.size()) - 1, static_cast<int>(f.size()) - 1});
  for (std::size_t k = 0; k < E.size(); ++k) data.E(static_cast<int>(k))(0, 0) = E[k];
  for (std::size_t k = 0; k < A.size(); ++k) data.A(static_cast<int>(k))(0, 0) = A[k];
  for (std::size_t k = 0; k < f.size(); ++k) *data.f(static_cast<int>(k)) = f[k];
  return data;
}

double time_scale_of(const Numbers& E, const Numbers& A) {
  TaylorData data = scalar(E, A);
  EXPECT_TRUE(data.scale(0.0));
  return data.time_scale;
}

// Random plain derivatives; row i of all of them times row_size[i].
TaylorData random_data(int m, int n, Orders orders, const Numbers& row_size) {
  TaylorData data;
  data.resize(m, n, orders);
  const auto write = [&](View to, std::uint64_t seed) {
    copy(random_matrix(to.rows, to.cols, seed), to);
    for (int j = 0; j < to.cols; ++j)
      for (int i = 0; i < to.rows; ++i) to(i, j) *= row_size[size(i)];
  };
  for (int k = 0; k <= orders.E; ++k) write(data.E(k), 10 + static_cast<std::uint64_t>(k));
  for (int k = 0; k <= orders.A; ++k) write(data.A(k), 30 + static_cast<std::uint64_t>(k));
  for (int k = 0; k <= orders.f; ++k) write({data.f(k), m, 1, m}, 50 + static_cast<std::uint64_t>(k));
  return data;
}

// E(k) = D E^(k) tau^k / k!,  A(k) = D A^(k) tau^(k+1) / k!,  f(k) = D f^(k) tau^(k+1) / k!
void expect_definition(const TaylorData& data, const TaylorData& plain) {
  const auto expect_entry = [&](double scaled, double derivative, int row, int k, int power) {
    const double expected = data.row_scale[size(row)] * derivative * std::pow(data.time_scale, power) / factorial(k);
    EXPECT_NEAR(scaled, expected, rounding(1) * std::fabs(expected)) << "order " << k << ", row " << row;
  };
  for (int i = 0; i < data.m; ++i) {
    for (int j = 0; j < data.n; ++j) {
      for (int k = 0; k <= data.orders.E; ++k) expect_entry(data.E(k)(i, j), plain.E(k)(i, j), i, k, k);
      for (int k = 0; k <= data.orders.A; ++k) expect_entry(data.A(k)(i, j), plain.A(k)(i, j), i, k, k + 1);
    }
    for (int k = 0; k <= data.orders.f; ++k) expect_entry(data.f(k)[i], plain.f(k)[i], i, k, k + 1);
  }
}

bool is_power_of_two(double x) {
  int exponent = 0;
  return std::frexp(x, &exponent) == 0.5;
}

}  // namespace

TEST(TaylorData, CoefficientsAreWhatTheDefinitionSays) {
  for (double tau : {0.0, 1.0, 0.25, 3.0}) {
    const Orders orders{4, 3, 5};
    const TaylorData plain = random_data(3, 2, orders, {1.0, 1e-7, 3e5});
    TaylorData data = plain;
    ASSERT_TRUE(data.scale(tau));
    expect_definition(data, plain);
  }
}

TEST(TaylorData, RowsAreScaledByPowersOfTwoToOnceOrTwiceTheLargest) {
  const Numbers sizes{1.0, 1e-7, 3e5, 1e-250, 1e250, 1.0 / 3.0};
  const TaylorData plain = random_data(6, 4, {2, 2, 1}, sizes);
  TaylorData data = plain;
  ASSERT_TRUE(data.scale(1.0));
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(is_power_of_two(data.row_scale[size(i)]));
    double row = 0.0;
    for (int j = 0; j < 4; ++j) row = std::max({row, std::fabs(data.E(0)(i, j)), std::fabs(data.A(0)(i, j))});
    EXPECT_GE(row, 1.0);
    EXPECT_LT(row, 4.0);
    // Powers of two: nothing is rounded.
    for (int j = 0; j < 4; ++j) EXPECT_EQ(data.E(0)(i, j), data.row_scale[size(i)] * plain.E(0)(i, j));
  }
}

// Joint scaling of [E A]: an equation times 1e-14 is the same equation, a small E beside a large A is not.
TEST(TaylorData, AConstantRowFactorChangesNothing) {
  TaylorData one = random_data(2, 2, {2, 2, 2}, {1.0, 1.0});
  TaylorData other = random_data(2, 2, {2, 2, 2}, {1.0, std::ldexp(1.0, -47)});
  ASSERT_TRUE(one.scale(0.0));
  ASSERT_TRUE(other.scale(0.0));
  EXPECT_EQ(one.time_scale, other.time_scale);
  for (int k = 0; k <= 2; ++k) {
    EXPECT_EQ(sfdae_test::distance(std::as_const(one).E(k), std::as_const(other).E(k)), 0.0);
    EXPECT_EQ(sfdae_test::distance(std::as_const(one).A(k), std::as_const(other).A(k)), 0.0);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(one.f(k)[i], other.f(k)[i]);
  }
}

// For rows that are small by cancellation: one power of two for all of them.
TEST(TaylorData, ACommonScaleBringsTheLargestRowToOneAndKeepsRatios) {
  const TaylorData plain = random_data(3, 4, {1, 1, 1}, {1e-9, 1e20, 1.0});
  TaylorData data = plain;
  ASSERT_TRUE(data.scale(1.0, RowScaling::common));
  EXPECT_EQ(data.row_scale[0], data.row_scale[1]);
  EXPECT_EQ(data.row_scale[0], data.row_scale[2]);
  EXPECT_EQ(data.row_scale_ratio(), 1.0);
  EXPECT_GE(data.norm(0), 1.0);
  EXPECT_LT(data.norm(0), 2.0);
  expect_definition(data, plain);
}

TEST(TaylorData, RowNormsAreThoseOfTheUnscaledRows) {
  const TaylorData plain = random_data(2, 3, {1, 1, 1}, {1.0, 4096.0});
  for (RowScaling rows : {RowScaling::each, RowScaling::common}) {
    TaylorData data = plain;
    ASSERT_TRUE(data.scale(0.0, rows));
    for (int i = 0; i < 2; ++i) {
      double row = 0.0;
      for (int j = 0; j < 3; ++j) row = std::max({row, std::fabs(plain.E(0)(i, j)), std::fabs(plain.A(0)(i, j))});
      EXPECT_EQ(data.row_norm[size(i)], row);
    }
    const double ratio = data.row_scale[0] / data.row_scale[1];
    EXPECT_EQ(data.row_scale_ratio(), std::max(ratio, 1.0 / ratio));
  }
}

// Row 1 of E = diag(1, t) and A = diag(1, 0) vanishes at t = 0; its derivative is 1e-6.
TEST(TaylorData, ARowThatVanishesAtThePointIsMeasuredByItsDerivatives) {
  TaylorData data;
  data.resize(2, 2, {1, 1, 0});
  for (int k = 0; k <= 1; ++k) {
    fill(data.E(k), 0.0);
    fill(data.A(k), 0.0);
  }
  data.E(0)(0, 0) = data.A(0)(0, 0) = 1.0;
  data.E(1)(0, 0) = 1e9;  // does not count: row 0 has entries of order 0
  data.E(1)(1, 1) = 1e-6;
  data.f(0)[0] = data.f(0)[1] = 0.0;
  ASSERT_TRUE(data.scale(1.0));
  EXPECT_EQ(data.row_scale[0], 1.0);
  EXPECT_GE(data.E(1)(1, 1), 1.0);
  EXPECT_LT(data.E(1)(1, 1), 4.0);
}

TEST(TaylorData, RowsWithoutAnyEntryAreNotScaled) {
  TaylorData data = scalar({0.0, 0.0}, {0.0, 0.0}, {3.0});
  ASSERT_TRUE(data.scale(0.0));
  EXPECT_EQ(data.row_scale[0], 1.0);
  EXPECT_EQ(data.time_scale, 1.0);
  EXPECT_EQ(*data.f(0), 3.0);
}

// ---- Time scale ----

// Powers of two throughout, so that the expected value is exact. Coefficients: E_k = E^(k) / k!.

TEST(TimeScale, IsTheRatioOfEToAWhereNothingGrows) {
  EXPECT_EQ(time_scale_of({1.0}, {16.0}), 1.0 / 16.0);
  EXPECT_EQ(time_scale_of({1.0, 0.0}, {1.0 / 64.0, 0.0}), 64.0);
  EXPECT_EQ(time_scale_of({8.0}, {1.0}), 8.0);
}

TEST(TimeScale, IsTheTimeInWhichACoefficientGrowsToTheSizeOfThatOfOrderZero) {
  EXPECT_EQ(time_scale_of({1.0, 4.0}, {1.0, 0.0}), 0.25);         // (1 / 4)^(1/1)
  EXPECT_EQ(time_scale_of({1.0, 0.0, 2.0 * 16.0}, {1.0}), 0.25);  // (1 / 16)^(1/2)
  EXPECT_EQ(time_scale_of({1.0}, {1.0, 2.0}), 0.5);               // A grows
  EXPECT_EQ(time_scale_of({1.0, 2.0}, {1.0, 4.0}), 0.25);         // the smaller one counts
  EXPECT_EQ(time_scale_of({1.0, 2.0, 2.0 * 16.0}, {1.0}), 0.25);  // and the smaller order by order
  EXPECT_EQ(time_scale_of({1.0, 1.0 / 64.0}, {1.0, 0.0}), 64.0);  // slow coefficients: a long time
}

TEST(TimeScale, StaysWithinATenthAndAThousandTimesTheRatio) {
  const double fast = time_scale_of({1.0, 1e6}, {1.0});   // 1e-6, clamped to 0.1, nearest power of two
  const double slow = time_scale_of({1.0, 1e-6}, {1.0});  // 1e6, clamped to 1000
  EXPECT_EQ(fast, 0.125);
  EXPECT_EQ(slow, 1024.0);
  EXPECT_EQ(time_scale_of({1.0, 1e9}, {1.0 / 1024.0}), 128.0);  // 0.1 * 1024 = 102.4
  EXPECT_EQ(time_scale_of({1.0, 1e-9}, {1024.0}), 1.0);         // 1e3 / 1024
}

TEST(TimeScale, WithoutEIsTheGrowthOfAUnclampedElseOne) {
  EXPECT_EQ(time_scale_of({0.0}, {1.0, 4096.0}), 1.0 / 4096.0);
  EXPECT_EQ(time_scale_of({0.0, 1024.0}, {1.0, 4.0}), 0.25);  // E vanishes at the point: its growth is unknown
  EXPECT_EQ(time_scale_of({0.0}, {1.0, 0.0}), 1.0);
  EXPECT_EQ(time_scale_of({0.0}, {1.0}), 1.0);
}

TEST(TimeScale, WithoutAIsTheGrowthOfEElseOne) {
  EXPECT_EQ(time_scale_of({1.0, 8.0}, {0.0}), 0.125);
  EXPECT_EQ(time_scale_of({1.0}, {0.0, 4.0}), 1.0);
}

TEST(TimeScale, GivenByTheUserIsTakenToTheNearestPowerOfTwo) {
  for (double tau : {1.0, 0.5, 1024.0, 3.0, 0.1, 1e-3}) {
    TaylorData data = scalar({1.0, 1e3}, {1.0});
    ASSERT_TRUE(data.scale(tau));
    EXPECT_TRUE(is_power_of_two(data.time_scale));
    EXPECT_LE(std::fabs(std::log2(data.time_scale / tau)), 0.5 + rounding(1));
  }
}

TEST(TimeScale, RescalingIsTheSameAsScalingWithTheProduct) {
  const Orders orders{3, 3, 3};
  const TaylorData plain = random_data(2, 3, orders, {1.0, 4.0});
  TaylorData at_once = plain, in_two = plain;
  ASSERT_TRUE(at_once.scale(0.125));
  ASSERT_TRUE(in_two.scale(1.0));
  in_two.rescale_time(0.125);
  EXPECT_EQ(in_two.time_scale, 0.125);
  for (int k = 0; k <= 3; ++k) {
    EXPECT_EQ(sfdae_test::distance(std::as_const(at_once).E(k), std::as_const(in_two).E(k)), 0.0);
    EXPECT_EQ(sfdae_test::distance(std::as_const(at_once).A(k), std::as_const(in_two).A(k)), 0.0);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(at_once.f(k)[i], in_two.f(k)[i]);
    EXPECT_EQ(at_once.norm(k), in_two.norm(k));
    EXPECT_EQ(at_once.norm_A(k), in_two.norm_A(k));
    EXPECT_EQ(at_once.norm_f(k), in_two.norm_f(k));
  }
}

// E of the first row is 2^20, A everywhere 1: the unit of time is 2^20, and both rows are of unit size in it.
TEST(TimeScale, DoesNotMakeRowsWithoutELargerThanOthers) {
  for (const double given : {0.0, std::ldexp(1.0, 20)}) {
    TaylorData data;
    data.resize(2, 2, {0, 0, 0});
    fill(data.E(0), 0.0);
    fill(data.A(0), 1.0);
    data.E(0)(0, 0) = std::ldexp(1.0, 20);
    data.f(0)[0] = data.f(0)[1] = 3.0;
    ASSERT_TRUE(data.scale(given));
    EXPECT_EQ(data.time_scale, std::ldexp(1.0, 20));
    const TaylorData& scaled = data;
    EXPECT_EQ(scaled.E(0)(0, 0), 1.0);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) EXPECT_EQ(scaled.A(0)(i, j), 1.0);
    EXPECT_EQ(scaled.f(0)[0], 3.0);
    EXPECT_EQ(scaled.f(0)[1], 3.0);
    EXPECT_EQ(scaled.row_scale[0], std::ldexp(1.0, -20));
    EXPECT_EQ(scaled.row_scale[1], std::ldexp(1.0, -20));
    EXPECT_EQ(scaled.norm_f(0), 3.0);
  }
}

// ---- Norms and noise ----

TEST(TaylorData, NormsAreMaximaUpToTheLevel) {
  TaylorData data = random_data(3, 3, {2, 3, 3}, {1.0, 1.0, 1.0});
  ASSERT_TRUE(data.scale(8.0));
  double E = 0.0, A = 0.0, f = 0.0;
  for (int k = 0; k <= 3; ++k) {
    if (k <= 2) E = std::max(E, sfdae_test::largest(std::as_const(data).E(k)));
    A = std::max(A, sfdae_test::largest(std::as_const(data).A(k)));
    f = std::max(f, sfdae_test::largest(Numbers(data.f(k), data.f(k) + 3)));
    EXPECT_EQ(data.norm(k), std::max(E, A));
    EXPECT_EQ(data.norm_E(k), E);
    EXPECT_EQ(data.norm_A(k), A);
    EXPECT_EQ(data.norm_f(k), f);
  }
  EXPECT_EQ(data.norm_E0(), sfdae_test::largest(std::as_const(data).E(0)));
}

TEST(TaylorData, KnowsWhichCoefficientsVanishAndMeasuresAnew) {
  TaylorData data = scalar({1.0, 0.0, 1.0}, {1.0, 1.0, 0.0});
  ASSERT_TRUE(data.scale(1.0));
  EXPECT_FALSE(data.is_zero_E(0));
  EXPECT_TRUE(data.is_zero_E(1));
  EXPECT_TRUE(data.is_zero_A(2));
  EXPECT_FALSE(data.is_zero_A(1));
  data.E(1)(0, 0) = -7.0;
  data.measure();
  EXPECT_FALSE(data.is_zero_E(1));
  EXPECT_EQ(data.norm(0), 1.0);
  EXPECT_EQ(data.norm(1), 7.0);
}

// Level l uses derivatives up to order l; their errors count, exact data have rounding errors only. Errors are those of
// plain derivatives: of a coefficient of order k they are tau^k / k! times that, of A and f once more times tau.
TEST(TaylorData, NoiseIsThatOfTheDerivativesInUse) {
  TaylorData data = scalar({1.0, 1.0, 1.0}, {1.0, 1.0, 1.0});
  ASSERT_TRUE(data.scale(0.5));  // E: 1, 1/2, 1/8; A: 1/2, 1/4, 1/16
  EXPECT_EQ(data.noise(2), sfdae_test::unit_roundoff);
  data.errors('E', 1)[0] = 1e-10;
  data.errors('A', 2)[0] = 1e-7;
  data.errors('E', 0)[0] = 1.0;  // order 0 is never computed by differences
  EXPECT_EQ(data.noise(0), sfdae_test::unit_roundoff);
  EXPECT_DOUBLE_EQ(data.noise(1), 0.5 * 1e-10);
  EXPECT_DOUBLE_EQ(data.noise(2), 0.125 * 0.5 * 1e-7);
}

// Rows of sizes 1 and 2^30: an error counts relative to its own row, in E and A, and relative to the largest f after
// scaling; one of a column that is scaled grows with the column.
TEST(TaylorData, ErrorsAreScaledWithTheirRowsAndColumns) {
  TaylorData data;
  data.resize(2, 2, {1, 1, 1});
  for (View block : {data.E(0), data.E(1), data.A(0), data.A(1)}) fill(block, 0.0);
  std::fill_n(data.f(0), 4, 0.0);
  const double large = 0x1p30, tau = 0.25, error = 1e-9;
  data.E(0)(0, 0) = data.A(0)(0, 1) = data.f(0)[0] = 1.0;
  data.E(0)(1, 1) = data.A(0)(1, 0) = data.f(0)[1] = large;
  EXPECT_FALSE(data.has_errors());
  data.errors('E', 1)[2] = data.errors('f', 1)[0] = error;                   // row 0; of E in column 1
  data.errors('E', 1)[3] = data.errors('f', 1)[1] = 0x1p-6 * error * large;  // row 1
  EXPECT_TRUE(data.has_errors());
  ASSERT_TRUE(data.scale(tau));
  EXPECT_EQ(data.error_of_row('E', 1, 0), error);
  EXPECT_EQ(data.error_of_row('A', 1, 0), 0.0);
  EXPECT_EQ(data.error_of_row('E', 0, 0), 0.0);
  EXPECT_DOUBLE_EQ(data.scaled_error_of_row('E', 1, 0), error * tau);
  EXPECT_DOUBLE_EQ(data.scaled_error_of_row('E', 1, 1), 0x1p-6 * error * tau);
  EXPECT_DOUBLE_EQ(data.scaled_error_of_row('f', 1, 0), error * tau * tau);
  EXPECT_DOUBLE_EQ(data.noise(1), error * tau / data.norm(1));
  EXPECT_DOUBLE_EQ(data.noise_f(1), error * tau * tau / data.norm_f(1));
  data.rescale_time(0.5);
  EXPECT_DOUBLE_EQ(data.scaled_error_of_row('E', 1, 0), error * 0.5 * tau);

  TaylorData scaled;
  scaled.resize(2, 2, {1, 1, 1});
  scaled.errors('E', 1)[2] = error;
  scaled.scale_columns(Units(std::vector<double>{1.0, 8.0}));
  EXPECT_EQ(scaled.error_of_row('E', 1, 0), 8.0 * error);
  scaled.resize(2, 2, {1, 1, 1});
  EXPECT_FALSE(scaled.has_errors());
}

TEST(TaylorData, TheStackOfFIsContiguous) {
  TaylorData data = random_data(3, 2, {1, 1, 2}, {1.0, 1.0, 1.0});
  const ConstView f = data.f_stack(2);
  ASSERT_EQ(f.rows, 9);
  ASSERT_EQ(f.cols, 1);
  for (int k = 0; k <= 2; ++k)
    for (int i = 0; i < 3; ++i) EXPECT_EQ(f(3 * k + i, 0), data.f(k)[i]);
}

TEST(TaylorData, ResizingKeepsNoOldEntriesInTheWay) {
  TaylorData data = random_data(4, 4, {3, 3, 3}, Numbers(4, 1.0));
  ASSERT_TRUE(data.scale(0.0));
  const TaylorData plain = random_data(2, 3, {1, 2, 0}, Numbers(2, 1.0));
  data.resize(2, 3, {1, 2, 0});
  for (int k = 0; k <= 1; ++k) copy(plain.E(k), data.E(k));
  for (int k = 0; k <= 2; ++k) copy(plain.A(k), data.A(k));
  std::copy_n(plain.f(0), 2, data.f(0));
  ASSERT_TRUE(data.scale(0.0));
  expect_definition(data, plain);
  EXPECT_EQ(data.row_scale.size(), 2u);
}

// ---- Ends of the range ----

// Units so large or small that squares overflow or underflow: the scaled problem is the one of unit size.
TEST(TaylorData, TinyAndHugeEquationsAreScaledToUnitSize) {
  for (double unit : {1e-250, 1e250, 1e-300, 1e300}) {
    TaylorData data = random_data(2, 2, {1, 1, 1}, {unit, unit});
    ASSERT_TRUE(data.scale(0.0)) << unit;
    EXPECT_GE(data.norm(0), 0.125);
    EXPECT_LT(data.norm(0), 1e4);
    EXPECT_LT(data.norm_f(1), 1e4);
  }
}

// eps x' = -x + 1 with eps = 1e-250: tau = eps, and a common factor keeps E and A at unit size.
TEST(TaylorData, ATinyEIsScaledTogetherWithItsTimeScale) {
  const TaylorData plain = scalar({1e-250}, {-1.0}, {1.0});
  TaylorData data = plain;
  ASSERT_TRUE(data.scale(0.0));
  for (double entry : {std::as_const(data).E(0)(0, 0), -std::as_const(data).A(0)(0, 0), *std::as_const(data).f(0)}) {
    EXPECT_GE(entry, 0.5);
    EXPECT_LE(entry, 2.0);
  }
  expect_definition(data, plain);
}

TEST(TaylorData, RefusesCoefficientsWhoseProductsWouldOverflow) {
  TaylorData large_f = scalar({1.0}, {1.0}, {1e70});
  EXPECT_FALSE(large_f.scale(0.0));
  TaylorData large_derivative = scalar({1.0, 1e70}, {1.0});
  EXPECT_FALSE(large_derivative.scale(0.0));
  TaylorData long_time = scalar({1.0, 0.0, 1e40}, {1.0});  // 1e40 / 2! * 2^150 / 2^75 = 2e62
  EXPECT_FALSE(long_time.scale(std::ldexp(1.0, 75)));
  TaylorData fine = scalar({1.0, 1e10}, {1.0}, {1e40});
  EXPECT_TRUE(fine.scale(0.0));
}

// Powers of the time scale beyond the orders held would overflow, 2^(100 * 13) here.
TEST(TaylorData, ALongTimeScaleRaisesNoOverflow) {
  TaylorData data = scalar({1.0}, {1e-30});
  std::feclearexcept(FE_ALL_EXCEPT);
  EXPECT_TRUE(data.scale(0.0));
  EXPECT_EQ(std::fetestexcept(FE_OVERFLOW | FE_INVALID | FE_DIVBYZERO), 0);
}

}  // namespace sfdae::core
