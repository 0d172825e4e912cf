// SPDX-License-Identifier: BSD-3-Clause
// Exponents of units by weighted least squares: checked by what defines them.
#include "linalg/unit_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sfdae::core {

namespace {

constexpr int m = 9, n = 7;

// Entries that units make one but for `noise` bits, where pattern(i, j) holds.
template <class Pattern>
EntrySizes sizes_of(const UnitExponents& units, double noise, Pattern pattern) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(-noise, noise);
  EntrySizes sizes(m, n);
  for (EntrySizes::Block& block : sizes.blocks)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i) {
        if (!pattern(block, i, j)) continue;
        block.bits(i, j) = part(random) - units.sum_at(block, i, j);
        block.counts(i, j) = 1.0;
      }
  return sizes;
}

UnitExponents some_units() {
  UnitExponents units(m, n);
  for (int i = 0; i < m; ++i) units.rows[index(i)] = 20.0 * std::sin(i + 1.0);
  for (int j = 0; j < n; ++j) units.unknowns[index(j)] = 30.0 * std::cos(2.0 * j);
  units.time = -17.0;
  return units;
}

double largest_left(const EntrySizes& sizes, const UnitExponents& x) {
  double largest = 0.0;
  for (const EntrySizes::Block& block : sizes.blocks)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i)
        if (block.counts(i, j) > 0.0)
          largest = std::max(largest, std::fabs(block.bits(i, j) + x.sum_at(block, i, j)));
  return largest;
}

double sum_of_squares(const EntrySizes& sizes, const UnitExponents& x) {
  double sum = 0.0;
  for (const EntrySizes::Block& block : sizes.blocks)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < m; ++i)
        if (block.counts(i, j) > 0.0) sum += std::pow(block.bits(i, j) + x.sum_at(block, i, j), 2);
  return sum;
}

bool everywhere(const EntrySizes::Block&, int, int) { return true; }
bool sparsely(const EntrySizes::Block& block, int i, int j) {
  return block.time > 0.0 ? i == j || i == 8 : (i + 2 * j) % 3 != 0;
}

}  // namespace

TEST(UnitFit, FindsUnitsThatExplainAllSizes) {
  for (const EntrySizes& sizes : {sizes_of(some_units(), 0.0, everywhere), sizes_of(some_units(), 0.0, sparsely)}) {
    UnitExponents x(m, n);
    fit_squares(sizes, x);
    EXPECT_LE(largest_left(sizes, x), 0.1);
  }
}

// Half the gradient, of which 1e-3 is the square that is left at most, is that of a sum of at most 2 (m + n) entries
// for each exponent: no change by a bit makes the sum smaller.
TEST(UnitFit, LeavesNoSmallerSumOfSquaresNearby) {
  const EntrySizes sizes = sizes_of(some_units(), 12.0, sparsely);
  UnitExponents x(m, n);
  fit_squares(sizes, x);
  const double least = sum_of_squares(sizes, x);
  const auto try_changes = [&](double& exponent) {
    for (double change : {-1.0, 1.0}) {
      exponent += change;
      EXPECT_GT(sum_of_squares(sizes, x), least);
      exponent -= change;
    }
  };
  for (double& exponent : x.rows) try_changes(exponent);
  for (double& exponent : x.unknowns) try_changes(exponent);
  try_changes(x.time);
}

TEST(UnitFit, PassesByOutliers) {
  EntrySizes sizes = sizes_of(some_units(), 0.0, everywhere);
  const EntrySizes right = sizes;
  sizes.blocks[0].bits(2, 3) -= 60.0;
  sizes.blocks[1].bits(5, 1) -= 60.0;
  sizes.blocks[1].bits(6, 4) -= 60.0;
  UnitExponents x(m, n);
  fit_absolute_values(sizes, x);
  EXPECT_LE(largest_left(right, x), 2.0);
}

TEST(UnitFit, DoesNotSeeEntriesThatDoNotCount) {
  EntrySizes sizes = sizes_of(some_units(), 0.0, everywhere);
  sizes.blocks[0].bits(2, 3) -= 60.0;
  sizes.blocks[0].counts(2, 3) = 0.0;
  EXPECT_EQ(sizes.count(), static_cast<std::size_t>(2 * m * n - 1));
  UnitExponents x(m, n);
  fit_squares(sizes, x);
  EXPECT_LE(largest_left(sizes, x), 0.1);
}

}  // namespace sfdae::core
